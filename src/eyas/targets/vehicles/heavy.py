"""Trucks: a cab on a bare chassis, with a box trailer or with a tank trailer."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.core import exact
from eyas.mesh.shell import Shell
from eyas.state.mesh import Material, Mesh
from eyas.targets.vehicles.finishes import (
    BRIGHT,
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
from eyas.targets.vehicles.models import CAB, CHASSIS_BEHIND, VehicleModel

__all__ = ["trailer_levels", "truck_levels"]

_HALF = 1.25
"""Half the width of cab and trailer [m]."""

_ROOF_WHITE = plain(0.74, 0.75, 0.76)
_STRIPE = plain(0.62, 0.08, 0.08)
_SEAM = plain(0.52, 0.53, 0.54)


def truck_levels(vehicle: VehicleModel) -> tuple[Mesh, Mesh, Mesh]:
    """Return the levels of detail of a truck without its trailer, the finest first."""
    levels = []
    for detail in (2, 1, 0):
        shell = Shell()
        _cab(shell, vehicle.length / 2, detail)
        _chassis(shell, vehicle, detail)
        levels.append(shell.mesh())
    return levels[0], levels[1], levels[2]


def trailer_levels(vehicle: VehicleModel) -> tuple[Mesh, Mesh, Mesh]:
    """Return the same of its trailer, where it is behind a truck that drives straight on."""
    add = _tank_trailer if vehicle.name == "TruckTankSimple" else _box_trailer
    levels = []
    for detail in (2, 1, 0):
        shell = Shell()
        add(shell, vehicle, detail)
        levels.append(shell.mesh())
    return levels[0], levels[1], levels[2]


def _slice(back: float, front: float, half: float, z: float) -> NDArray[np.float64]:
    """Return a horizontal section of the cab: a rectangle with the front corners cut off."""
    cut = min(0.22, 0.3 * (front - back))
    return np.array([
        (back, -half, z), (front - cut, -half, z), (front, cut - half, z),
        (front, half - cut, z), (front - cut, half, z), (back, half, z),
    ])  # fmt: skip


def _pane(
    shell: Shell, corners: ArrayLike, material: Material, *, margin: float, both_sides: bool = False
) -> None:
    """Add a panel 1.5 cm above a face, inset by `margin` as a share of its size."""
    face = np.asarray(corners, np.float64)
    normal = np.cross(face[2] - face[0], face[3] - face[1])
    lift = 0.015 * normal / exact.length(normal)
    middle = face.mean(axis=0)
    shell.quads(middle + (1.0 - margin) * (face - middle) + lift, material, both_sides=both_sides)


def _cab(shell: Shell, front: float, detail: int) -> None:
    back = front - CAB
    low = _slice(back, front, _HALF, 1.06)
    waist = _slice(back, front, _HALF, 2.02)
    brow = _slice(back, front - 0.16, 1.2, 3.02)
    top = _slice(back, front - 0.36, 1.12, 3.62)
    shell.rings([low, waist, brow, top], PAINT)
    # The deflector on the roof, up to the height of the trailer.
    profile = [
        (back, 3.6),
        (front - 0.55, 3.6),
        (front - 1.5, 4.38),
        (back + 0.5, 4.5),
        (back, 4.5),
    ]
    shell.prism(profile, (-1.08, 1.08), PAINT)
    for i, j in ((1, 2), (2, 3), (3, 4)):
        _pane(shell, [waist[i], waist[j], brow[j], brow[i]], GLASS, margin=0.0)
    door = [waist[5], waist[4], brow[4], brow[5]]
    door = [
        door[1] + 0.42 * (door[0] - door[1]),
        door[1],
        door[2],
        door[2] + 0.42 * (door[3] - door[2]),
    ]
    _pane(shell, door[::-1], GLASS, margin=0.06, both_sides=True)
    shell.box((front - 0.78, -_HALF, 0.32), (front, _HALF, 1.06), TRIM)
    shell.box((back, -_HALF, 0.36), (front - 1.92, _HALF, 1.06), PAINT)
    shell.quads(_facing(front + 0.012, (0.74, 1.16), (0.62, 0.88)), HEAD_LAMP, both_sides=True)
    if detail == 0:
        return
    shell.quads(_facing(front + 0.012, (-0.8, 0.8), (1.16, 1.86)), TRIM)
    shell.quads(_facing(front + 0.012, (-0.27, 0.27), (0.46, 0.58)), PLATE)
    shell.box((front - 0.5, _HALF - 0.05, 2.1), (front - 0.34, 1.4, 2.75), TRIM, both_sides=True)
    if detail == 2:
        visor = [(front - 0.2, 2.98), (front + 0.01, 2.94), (front + 0.01, 3.0), (front - 0.2, 3.1)]
        shell.prism(visor, (-0.95, 0.95), TRIM)
        stack = [(back - 0.14, 1.0, 1.0), (back - 0.14, 1.0, 3.9)]
        shell.tube(stack, (0.09, 0.09), BRIGHT, both_sides=True)


def _facing(x: float, y: tuple[float, float], z: tuple[float, float]) -> list[tuple[float, ...]]:
    """Return an upright rectangle that faces forward."""
    return [(x, y[0], z[0]), (x, y[1], z[0]), (x, y[1], z[1]), (x, y[0], z[1])]


def _chassis(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    front, rear = vehicle.axles[0].x, vehicle.axles[1].x
    end = -vehicle.length / 2 if len(vehicle.axles) == 2 else rear - CHASSIS_BEHIND
    if len(vehicle.axles) == 2:
        shell.box((end, -1.2, 0.62), (end + 0.12, 1.2, 0.84), TRIM)
        _tail_lamps(shell, end, 0.73)
    if detail == 0:
        shell.box((end, -0.52, 0.86), (front - 0.4, 0.52, 1.1), STEEL)
        return
    shell.box((end, 0.3, 0.86), (front - 0.4, 0.52, 1.1), STEEL, both_sides=True)
    shell.box((rear + 0.75, 0.62, 0.45), (front - 1.4, 1.18, 1.0), STEEL, both_sides=True)
    shell.box((rear - 0.62, 0.68, 1.05), (rear + 0.62, 1.24, 1.14), TRIM, both_sides=True)
    shell.box((rear - 0.45, -0.55, 1.1), (rear + 0.45, 0.55, 1.25), TRIM)
    for x in (end, rear + 0.8, front - 1.6):
        shell.box((x, -0.3, 0.88), (x + 0.16, 0.3, 1.06), STEEL)


def _tail_lamps(shell: Shell, x: float, z: float) -> None:
    """Add the rear lamps and a plate to a beam."""
    lamp = _facing(x - 0.012, (0.72, 1.12), (z - 0.09, z + 0.09))
    shell.quads(lamp[::-1], TAIL_LAMP, both_sides=True)
    shell.quads(_facing(x - 0.012, (-0.26, 0.26), (z - 0.06, z + 0.06))[::-1], PLATE)


def _trailer_frame(shell: Shell, vehicle: VehicleModel, z: float, detail: int) -> None:
    """Add the frame of a trailer, with guards, legs and rear beam."""
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    shell.box((end, -0.6, z - 0.22), (front - 0.3, 0.6, z), STEEL)
    shell.box((end, -1.2, 0.62), (end + 0.14, 1.2, 0.86), TRIM)
    _tail_lamps(shell, end, 0.74)
    if detail == 0:
        return
    axles = [axle.x for axle in vehicle.axles[2:]]
    shell.box((min(axles) - 0.6, 0.85, 1.05), (max(axles) + 0.6, 1.24, 1.1), TRIM, both_sides=True)
    ahead = vehicle.axles[1].x - 1.6  # clear of the truck when it turns
    shell.box((max(axles) + 0.75, 1.16, 0.5), (ahead, 1.2, 1.0), STEEL, both_sides=True)
    shell.box((ahead - 0.3, 0.7, 0.3), (ahead - 0.15, 0.85, z - 0.1), TRIM, both_sides=True)


def _box_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    floor, roof = 1.22, 4.2
    _trailer_frame(shell, vehicle, floor, detail)
    shell.box((end, -_HALF, floor), (front, _HALF, roof), SKIN_WHITE)
    lid = [(end + 0.06, -1.19), (front - 0.06, -1.19), (front - 0.06, 1.19), (end + 0.06, 1.19)]
    shell.quads([(x, y, roof + 0.006) for x, y in lid], _ROOF_WHITE)
    side = _HALF + 0.008
    band = [(front, side, 1.7), (end, side, 1.7), (end, side, 2.2), (front, side, 2.2)]
    shell.quads(band, _STRIPE, both_sides=True)
    if detail == 0:
        return
    door = _facing(end - 0.01, (-0.03, 0.03), (floor + 0.1, roof - 0.1))
    shell.quads(door[::-1], _SEAM)
    for x in np.arange(end + 1.6, front - 0.5, 1.6) if detail == 2 else ():
        rib = [(x - 0.03, 1.19), (x - 0.03, -1.19), (x + 0.03, -1.19), (x + 0.03, 1.19)]
        shell.quads([(u, v, roof + 0.012) for u, v in rib], _SEAM)
        seam = [
            (x + 0.02, side, 2.2),
            (x - 0.02, side, 2.2),
            (x - 0.02, side, roof),
            (x + 0.02, side, roof),
        ]
        shell.quads(seam, _SEAM, both_sides=True)
    shell.box((front, -0.85, 2.9), (front + 0.32, 0.85, 4.0), SKIN_WHITE, taper=0.03)


def _tank_trailer(shell: Shell, vehicle: VehicleModel, detail: int) -> None:
    end, front = -vehicle.length / 2, vehicle.length / 2 - 3.15
    sides = (8, 12, 18)[detail]
    angle = (np.arange(sides) + 0.5) * (2 * np.pi / sides)

    def ring(x: float, size: float) -> NDArray[np.float64]:
        y, z = 1.24 * size * exact.sin(angle), 2.7 - 1.3 * size * exact.cos(angle)
        return np.column_stack([np.full(sides, x), y, z])

    _trailer_frame(shell, vehicle, 1.5, detail)
    sections = [(0.05, 0.5), (0.18, 0.82), (0.45, 1.0)] if detail else [(0.05, 0.7), (0.45, 1.0)]
    rings = [ring(end + x, size) for x, size in sections]
    rings += [ring(front - x, size) for x, size in sections[::-1]]
    shell.rings(rings, BRIGHT)
    for x in np.linspace(end + 1.3, front - 1.3, 5) if detail else ():
        shell.rings([ring(x - 0.05, 1.012), ring(x + 0.05, 1.012)], STEEL, caps=False)
    walk = [(front - 0.9, 0.3), (end + 0.9, 0.3), (end + 0.9, -0.3), (front - 0.9, -0.3)]
    shell.quads([(x, y, 4.03) for x, y in walk], STEEL)
    for x in np.linspace(end + 2.0, front - 2.0, 4) if detail == 2 else ():
        shell.tube([(x, 0.0, 4.0), (x, 0.0, 4.2)], (0.24, 0.24), TRIM, sides=8)
