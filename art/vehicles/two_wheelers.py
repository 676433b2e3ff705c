"""Two-wheelers, each with a rider who wears a helmet."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from art.cars.finishes import CLOTH, GLASS, HEAD_LAMP, SKIN_WHITE, TAIL_LAMP, TRIM, plain
from art.cars.frame import Axle
from art.parts import levels_of
from art.vehicles.vehicle import VehicleModel, vehicle
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.traffic.config import VehicleType

LEAN_LIMIT = 0.2
"""Largest lean of two-wheelers in a curve [rad]; the original's limit of the yaw rate [rad/s]."""

_TROUSERS = plain(0.36, 0.40, 0.48)
SEAT = plain(0.14, 0.12, 0.11)

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Posture:
    """Positions of the rider's joints [m]; those of the limbs are for the left side."""

    hip: Point
    chest: Point
    head: Point
    hand: Point
    elbow: Point
    knee: Point
    foot: Point
    head_radius: float
    helmet: Material = SKIN_WHITE


def two_wheeler(
    name: str,
    *,
    size: tuple[float, float, float],
    wheels: tuple[float, float, float],
    mass: float,
    words: tuple[str, ...],
    shape: Callable[[Shell, VehicleModel, int], None],
    posture: Posture,
) -> VehicleModel:
    """Return a two-wheeler; `wheels` are wheelbase, wheel radius and x of the front axle [m]."""
    wheelbase, radius, front = wheels

    def add(model: VehicleModel, shell: Shell, detail: int) -> None:
        shape(shell, model, detail)
        _rider(shell, posture, detail)

    return vehicle(
        name,
        VehicleType.MOTORCYCLE,
        size=size,
        wheelbase=wheelbase,
        wheel_radius=radius,
        axles=(Axle(front, 0.0, 0.12, steered=True), Axle(front - wheelbase, 0.0, 0.19)),
        lean=LEAN_LIMIT,
        mass=mass,
        words=words,
        body=lambda model: levels_of(partial(add, model)),
    )


def _rider(shell: Shell, posture: Posture, detail: int) -> None:
    sides, rows = ((4, 3), (5, 4), (7, 6))[detail]
    hip, chest, head = posture.hip, posture.chest, posture.head
    neck = tuple(0.55 * h + 0.45 * c for h, c in zip(head, chest, strict=True))
    shell.tube([hip, chest, neck], (0.16, 0.17, 0.08), CLOTH, sides=sides + 1)
    across = (chest[0] + 0.01, 0.0, chest[2] + 0.04)
    shell.ball(across, (0.14, 0.25, 0.1), CLOTH, rows=rows, sides=sides + 2)
    size = posture.head_radius
    shell.ball(head, (size, 0.85 * size, size), posture.helmet, rows=rows, sides=sides + 1)
    visor = (head[0] + 0.42 * size, 0.0, head[2] + 0.05 * size)
    if detail:
        shell.ball(visor, (0.68 * size, 0.66 * size, 0.42 * size), GLASS, rows=3, sides=sides)
    shoulder = (chest[0] + 0.03, 0.17, chest[2] + 0.07)
    arm = [shoulder, posture.elbow, posture.hand]
    leg = [(hip[0] + 0.02, 0.1, hip[2] - 0.03), posture.knee, posture.foot]
    if detail == 0:
        shell.tube(arm[::2], (0.08, 0.05), CLOTH, sides=3, both_sides=True)
        shell.tube(leg[1:], (0.1, 0.07), _TROUSERS, sides=3, both_sides=True)
        return
    shell.tube(arm, (0.08, 0.07, 0.05), CLOTH, sides=sides - 1, both_sides=True)
    shell.tube(leg, (0.105, 0.085, 0.06), _TROUSERS, sides=sides - 1, both_sides=True)
    if detail == 2:
        x, y, z = posture.foot
        shell.box(
            (x - 0.07, y - 0.038, z - 0.09), (x + 0.2, y + 0.038, z + 0.02), TRIM, both_sides=True
        )


def lamp(shell: Shell, centre: Sequence[float], size: Sequence[float], *, front: bool) -> None:
    """Add a lamp: a box with its middle at `centre`."""
    low = [p - s / 2 for p, s in zip(centre, size, strict=True)]
    high = [p + s / 2 for p, s in zip(centre, size, strict=True)]
    shell.box(low, high, HEAD_LAMP if front else TAIL_LAMP)
