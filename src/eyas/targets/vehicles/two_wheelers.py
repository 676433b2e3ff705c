"""The scooter and the motorbike, each with a rider who wears a helmet."""

from collections.abc import Sequence
from dataclasses import dataclass

from eyas.mesh.shell import Shell
from eyas.state.mesh import Mesh
from eyas.targets.vehicles.finishes import (
    BRIGHT,
    CLOTH,
    GLASS,
    HEAD_LAMP,
    PAINT,
    PLATE,
    SKIN_WHITE,
    STEEL,
    TAIL_LAMP,
    TRIM,
    plain,
)
from eyas.targets.vehicles.models import VehicleModel

__all__ = ["two_wheeler_levels"]

_TROUSERS = plain(0.20, 0.20, 0.22)
_SEAT = plain(0.14, 0.12, 0.11)

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class _Posture:
    """Positions of the rider's joints [m]; those of the limbs are for the left side."""

    hip: Point
    chest: Point
    head: Point
    hand: Point
    elbow: Point
    knee: Point
    foot: Point
    head_radius: float


_UPRIGHT = _Posture(
    hip=(-0.34, 0.0, 0.86),
    chest=(-0.22, 0.0, 1.24),
    head=(-0.15, 0.0, 1.545),
    hand=(0.36, 0.27, 1.02),
    elbow=(0.02, 0.265, 1.06),
    knee=(0.16, 0.17, 0.80),
    foot=(0.22, 0.16, 0.34),
    head_radius=0.155,
)

_CROUCHED = _Posture(
    hip=(-0.42, 0.0, 0.90),
    chest=(0.0, 0.0, 1.16),
    head=(0.20, 0.0, 1.405),
    hand=(0.50, 0.33, 0.97),
    elbow=(0.24, 0.36, 0.98),
    knee=(0.08, 0.24, 0.74),
    foot=(-0.30, 0.22, 0.34),
    head_radius=0.145,
)


def two_wheeler_levels(vehicle: VehicleModel) -> tuple[Mesh, Mesh, Mesh]:
    """Return the levels of detail of two-wheeler and rider without wheels, the finest first."""
    scooter = vehicle.name == "ScooterSimple"
    levels = []
    for detail in (2, 1, 0):
        shell = Shell()
        (_scooter if scooter else _motorbike)(shell, vehicle, detail)
        _rider(shell, _UPRIGHT if scooter else _CROUCHED, detail)
        levels.append(shell.mesh())
    return levels[0], levels[1], levels[2]


def _rider(shell: Shell, posture: _Posture, detail: int) -> None:
    sides, rows = ((4, 3), (5, 4), (7, 6))[detail]
    hip, chest, head = posture.hip, posture.chest, posture.head
    neck = tuple(0.55 * h + 0.45 * c for h, c in zip(head, chest, strict=True))
    shell.tube([hip, chest, neck], (0.17, 0.2, 0.09), CLOTH, sides=sides + 1)
    size = posture.head_radius
    shell.ball(head, (size, 0.85 * size, size), SKIN_WHITE, rows=rows, sides=sides + 1)
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
    shell.tube(arm, (0.08, 0.065, 0.045), CLOTH, sides=sides - 1, both_sides=True)
    shell.tube(leg, (0.105, 0.085, 0.06), _TROUSERS, sides=sides - 1, both_sides=True)
    if detail == 2:
        x, y, z = posture.foot
        shell.box(
            (x - 0.07, y - 0.05, z - 0.09), (x + 0.2, y + 0.05, z + 0.02), TRIM, both_sides=True
        )


def _lamp(shell: Shell, centre: Sequence[float], size: Sequence[float], *, front: bool) -> None:
    """Add a lamp: a box with its middle at `centre`."""
    low = [p - s / 2 for p, s in zip(centre, size, strict=True)]
    high = [p + s / 2 for p, s in zip(centre, size, strict=True)]
    shell.box(low, high, HEAD_LAMP if front else TAIL_LAMP)


def _scooter(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    shield = [(0.34, 0.34), (0.46, 0.32), (0.60, 0.62), (0.44, 1.0), (0.33, 0.96)]
    shell.prism(shield, (-0.2, 0.2), PAINT)
    shell.box((-0.25, -0.17, 0.24), (0.44, 0.17, 0.33), TRIM)
    body = [(-0.92, 0.52), (-0.66, 0.36), (-0.2, 0.26), (-0.12, 0.66), (-0.88, 0.72)]
    shell.prism(body, (-0.2, 0.2), PAINT)
    seat = [(-0.9, 0.72), (-0.12, 0.66), (-0.08, 0.76), (-0.6, 0.78), (-0.9, 0.82)]
    shell.prism(seat, (-0.15, 0.15), _SEAT)
    fender = [(0.5, 0.38), (0.975, 0.36), (0.9, 0.48), (0.7, 0.54)]
    shell.prism(fender, (-0.085, 0.085), PAINT)
    _lamp(shell, (0.54, 0.0, 0.86), (0.1, 0.2, 0.14), front=True)
    _lamp(shell, (-0.925, 0.0, 0.64), (0.05, 0.26, 0.1), front=False)
    if detail == 0:
        return
    shell.tube(
        [(0.38, 0.0, 1.0), (0.36, 0.31, 1.04)], (0.035, 0.03), TRIM, sides=4, both_sides=True
    )
    shell.box((0.38, 0.27, 1.12), (0.42, 0.33, 1.22), TRIM, both_sides=True)
    glass = [(0.47, 0.96), (0.50, 0.96), (0.36, 1.3), (0.33, 1.3)]
    shell.prism(glass, (-0.17, 0.17), GLASS)
    front, rear = vehicle.axles[0].x, vehicle.axles[1].x
    radius = vehicle.wheel_radius
    shell.tube(
        [(front, 0.09, radius), (0.45, 0.06, 0.8)], (0.03, 0.03), STEEL, sides=4, both_sides=True
    )
    shell.box((rear, 0.08, radius - 0.05), (-0.3, 0.16, radius + 0.12), STEEL)
    if detail == 2:
        exhaust = [(-0.3, -0.17, 0.22), (-0.62, -0.18, 0.25), (-0.9, -0.18, 0.32)]
        shell.tube(exhaust, (0.03, 0.06, 0.055), BRIGHT)
        shell.box((-0.975, -0.09, 0.36), (-0.94, 0.09, 0.48), PLATE)
        shell.box((-0.97, -0.17, 0.83), (-0.6, 0.17, 0.86), STEEL)


def _motorbike(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    front, rear, radius = vehicle.axles[0].x, vehicle.axles[1].x, vehicle.wheel_radius
    tank = [(-0.12, 0.66), (0.42, 0.64), (0.46, 0.86), (0.22, 0.97), (-0.12, 0.82)]
    shell.prism(tank, (-0.16, 0.16), PAINT)
    fairing = [(0.40, 0.62), (0.62, 0.60), (0.86, 0.80), (0.74, 0.98), (0.46, 1.0)]
    shell.prism(fairing, (-0.2, 0.2), PAINT)
    cowl = [(0.0, 0.30), (0.52, 0.32), (0.60, 0.60), (-0.1, 0.66)]
    shell.prism(cowl, (-0.17, 0.17), TRIM)
    tail = [(-1.1, 0.84), (-0.6, 0.66), (-0.12, 0.66), (-0.12, 0.74), (-0.7, 0.84), (-1.14, 0.94)]
    shell.prism(tail, (-0.13, 0.13), PAINT)
    seat = [(-0.85, 0.85), (-0.12, 0.72), (-0.1, 0.82), (-0.5, 0.86), (-0.85, 0.92)]
    shell.prism(seat, (-0.14, 0.14), _SEAT)
    _lamp(shell, (0.82, 0.0, 0.82), (0.12, 0.26, 0.12), front=True)
    _lamp(shell, (-1.13, 0.0, 0.89), (0.06, 0.22, 0.08), front=False)
    fender = [(front - 0.2, 0.46), (front + 0.3, 0.42), (front + 0.16, 0.52), (front - 0.02, 0.55)]
    shell.prism(fender, (-0.08, 0.08), PAINT)
    if detail == 0:
        return
    shell.tube(
        [(0.50, 0.0, 0.98), (0.48, 0.38, 0.97)], (0.03, 0.03), TRIM, sides=4, both_sides=True
    )
    shell.box((0.52, 0.43, 1.04), (0.56, 0.55, 1.13), TRIM, both_sides=True)
    glass = [(0.60, 0.97), (0.76, 0.95), (0.5, 1.2), (0.44, 1.2)]
    shell.prism(glass, (-0.15, 0.15), GLASS)
    shell.tube(
        [(front, 0.1, radius), (0.56, 0.08, 0.95)], (0.035, 0.04), BRIGHT, sides=5, both_sides=True
    )
    shell.box((rear, 0.09, radius - 0.05), (-0.05, 0.14, radius + 0.12), STEEL, both_sides=True)
    shell.box((-1.24, -0.1, 0.55), (-1.2, 0.1, 0.75), PLATE)
    shell.prism([(-1.24, 0.55), (-1.08, 0.84), (-1.12, 0.88), (-1.26, 0.62)], (-0.06, 0.06), TRIM)
    if detail == 2:
        exhaust = [(0.1, -0.2, 0.26), (-0.5, -0.22, 0.3), (-0.95, -0.22, 0.5)]
        shell.tube(exhaust, (0.04, 0.06, 0.075), BRIGHT)
        shell.tube(
            [(0.48, 0.36, 0.98), (0.54, 0.47, 1.08)], (0.012, 0.012), TRIM, sides=3, both_sides=True
        )
