"""Trucks: a cab, a chassis with a box or for a trailer, and the frame of a trailer."""

from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from art.cars.finishes import (
    BRIGHT,
    FREIGHT,
    HEAD_LAMP,
    INDICATOR_LEFT,
    INDICATOR_RIGHT,
    PAINT,
    PANE,
    PLATE,
    STEEL,
    TAIL_LAMP,
    TRIM,
)
from art.cars.frame import Axle
from art.cars.regions import (
    BOX_DOORS,
    BOX_ROOF,
    BOX_SIDE,
    CAB_SIDE,
    PLAIN,
    REAR_WINDOW,
    SIDE_PANE,
    WINDSCREEN,
    body_paint,
)
from art.parts import levels_of
from art.vehicles.vehicle import CAB, CHASSIS_BEHIND, Trailer, VehicleModel, vehicle
from eyas.engine.mesh.panels import fan
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.traffic.config import VehicleType
from eyas.engine.traffic.trailer import BUMPER_AHEAD, REAR_AXLE, TAIL_BEHIND
from eyas.lanes import exact

HALF = 1.25  # Half the width of cab and trailer [m]
_OVERHANG = 1.35  # From the front axle of a truck to its bumper [m]
_TRAILER_AXLES = (-3.4, -4.7, -6.0)
TRACTOR_BASE = BUMPER_AHEAD + REAR_AXLE - _OVERHANG  # Wheelbase of a truck that pulls a trailer [m]


def truck(
    name: str,
    *,
    wheelbase: float,
    mass: float,
    words: tuple[str, ...],
    trailer: Trailer | None = None,
) -> VehicleModel:
    """Return a truck, 4.5 m high."""
    length = BUMPER_AHEAD + TAIL_BEHIND if trailer else 7.7
    front = length / 2 - _OVERHANG
    return vehicle(
        name,
        VehicleType.TRAILER if trailer else VehicleType.TRUCK,
        size=(length, 2.8, 4.5),
        wheelbase=wheelbase,
        wheel_radius=0.5,
        axles=(
            Axle(front, 2.14, 0.32, steered=True),
            Axle(front - wheelbase, 1.9, 0.56),
            *(Axle(x, 2.1, 0.38, towed=True) for x in (_TRAILER_AXLES if trailer else ())),
        ),
        mass=mass,
        words=words,
        body=lambda model: levels_of(partial(_truck, model)),
        trailer=trailer,
    )


def _truck(model: VehicleModel, shell: Shell, detail: int) -> None:
    _cab(shell, model.length / 2, detail)
    _chassis(shell, model, detail)
    if not model.articulated:
        ends = 0.02 - model.length / 2, model.length / 2 - CAB - 0.28
        freight_box(shell, ends, (1.16, 4.0), PAINT, detail)


def freight_box(
    shell: Shell,
    ends: tuple[float, float],  # x of its rear and its front [m]
    heights: tuple[float, float],  # z of its floor and its roof [m]
    stripe: Material,  # Along its sides
    detail: int,
) -> None:
    """Add a box with doors behind, and the lamps at their corners."""
    (end, front), (floor, roof) = ends, heights
    rows = ((floor, 1.7, FREIGHT), (1.7, 2.2, stripe), (2.2, roof, FREIGHT))
    for low, high, material in rows:
        side = [(front, HALF, low), (end, HALF, low), (end, HALF, high), (front, HALF, high)]
        up = (np.array([low, low, high, high]) - floor) / (roof - floor)
        shell.quads(side, material, uvs=BOX_SIDE.at([1.0, 0.0, 0.0, 1.0], up), both_sides=True)
    lid = [(end, 0.0, roof), (front, 0.0, roof), (front, HALF, roof), (end, HALF, roof)]
    over = BOX_ROOF.at([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0])
    shell.quads(lid, FREIGHT, uvs=over, both_sides=True)
    doors = facing(end, (-HALF, HALF), (floor, roof))
    shell.quads(doors[::-1], FREIGHT, uvs=BOX_DOORS.at([0.0, 1.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0]))
    shell.quads(facing(front, (-HALF, HALF), (floor, roof)), FREIGHT, uvs=PLAIN)
    below = [(end, HALF, floor), (front, HALF, floor), (front, -HALF, floor), (end, -HALF, floor)]
    shell.quads(below, TRIM)
    if detail:
        marker = facing(end - 0.012, (0.86, 1.16), (roof - 0.13, roof - 0.05))[::-1]
        shell.quads(marker, TAIL_LAMP, both_sides=True)


def _slice(back: float, front: float, half: float, z: float) -> NDArray[np.float64]:
    """Return a horizontal section of the cab: a rectangle with the front corners cut off."""
    cut = min(0.22, 0.3 * (front - back))
    return np.array([
        (back, -half, z), (front - cut, -half, z), (front, cut - half, z),
        (front, half - cut, z), (front - cut, half, z), (back, half, z),
    ])  # fmt: skip


def _pane(
    shell: Shell, corners: ArrayLike, uvs: ArrayLike, *, margin: float, both_sides: bool = False
) -> None:
    """Add a pane 1.5 cm above a face, inset by `margin` as a share of its size."""
    face = np.asarray(corners, np.float64)
    normal = np.cross(face[2] - face[0], face[3] - face[1])
    lift = 0.015 * normal / exact.length(normal)
    middle = face.mean(axis=0)
    pane = middle + (1.0 - margin) * (face - middle) + lift
    shell.quads(pane, PANE, uvs=uvs, both_sides=both_sides)


def _cab_walls(shell: Shell, rings: list[NDArray[np.float64]], back: float) -> None:
    """Add the walls of a cab through its sections, and its roof and floor."""
    paint = body_paint("freight")
    for low, high in pairwise(rings):
        for i in range(6):
            k = (i + 1) % 6
            quad = np.array([low[i], low[k], high[k], high[i]])
            up = (quad[:, 2] - rings[0][0, 2]) / (rings[-1][0, 2] - rings[0][0, 2])
            side = i in (0, 4)
            uvs = CAB_SIDE.at((quad[:, 0] - back) / CAB, up) if side else PLAIN
            shell.quads(quad, paint, uvs=uvs)
    for ring in (rings[0][::-1], rings[-1]):
        shell.triangles(fan(ring), paint, uvs=np.broadcast_to(PLAIN[0], (4, 3, 2)))


def _cab(shell: Shell, front: float, detail: int) -> None:
    back = front - CAB
    low = _slice(back, front, HALF, 1.06)
    waist = _slice(back, front, HALF, 2.02)
    brow = _slice(back, front - 0.16, 1.2, 3.02)
    top = _slice(back, front - 0.36, 1.12, 3.62)
    _cab_walls(shell, [low, waist, brow, top], back)
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
        face = np.array([waist[i], waist[j], brow[j], brow[i]])
        uvs = WINDSCREEN.at(0.5 + 0.5 * face[:, 1] / HALF, [0.0, 0.0, 1.0, 1.0])
        _pane(shell, face, uvs, margin=0.0)
    door = [waist[5], waist[4], brow[4], brow[5]]
    door = [
        door[1] + 0.42 * (door[0] - door[1]),
        door[1],
        door[2],
        door[2] + 0.42 * (door[3] - door[2]),
    ]
    uvs = SIDE_PANE.at([0.0, 1.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0])
    _pane(shell, door[::-1], uvs, margin=0.06, both_sides=True)
    shell.box((front - 0.78, -HALF, 0.32), (front, HALF, 1.06), TRIM)
    shell.box((back, -HALF, 0.36), (front - 1.92, HALF, 1.06), PAINT)
    shell.quads(facing(front + 0.012, (0.74, 1.16), (0.62, 0.88)), HEAD_LAMP, both_sides=True)
    for lamp, y in ((INDICATOR_LEFT, (1.17, 1.24)), (INDICATOR_RIGHT, (-1.24, -1.17))):
        shell.quads(facing(front + 0.012, y, (0.62, 0.88)), lamp)
    if detail == 0:
        return
    shell.quads(facing(front + 0.012, (-0.8, 0.8), (1.16, 1.86)), TRIM)
    behind = facing(back - 0.012, (-0.8, 0.8), (2.1, 2.85))[::-1]
    shell.quads(behind, PANE, uvs=REAR_WINDOW.at([0.0, 1.0, 1.0, 0.0], [1.0, 1.0, 0.0, 0.0]))
    shell.quads(facing(front + 0.012, (-0.27, 0.27), (0.46, 0.58)), PLATE)
    shell.box((front - 0.5, HALF - 0.05, 2.1), (front - 0.34, 1.4, 2.75), TRIM, both_sides=True)
    if detail == 2:
        visor = [(front - 0.2, 2.98), (front + 0.01, 2.94), (front + 0.01, 3.0), (front - 0.2, 3.1)]
        shell.prism(visor, (-0.95, 0.95), TRIM)
        stack = [(back - 0.14, 1.0, 1.0), (back - 0.14, 1.0, 3.9)]
        shell.tube(stack, (0.09, 0.09), BRIGHT, both_sides=True)


def facing(x: float, y: tuple[float, float], z: tuple[float, float]) -> list[tuple[float, ...]]:
    """Return an upright rectangle that faces forward."""
    return [(x, y[0], z[0]), (x, y[1], z[0]), (x, y[1], z[1]), (x, y[0], z[1])]


def _chassis(shell: Shell, model: VehicleModel, detail: int) -> None:
    front, rear = model.axles[0].x, model.axles[1].x
    end = -model.length / 2 if len(model.axles) == 2 else rear - CHASSIS_BEHIND
    if len(model.axles) == 2:
        shell.box((end, -1.2, 0.62), (end + 0.12, 1.2, 0.84), TRIM)
        _tail_lamps(shell, end, 0.73)
    if detail == 0:
        shell.box((end, -0.52, 0.86), (front - 0.4, 0.52, 1.1), STEEL)
        return
    shell.box((end, 0.3, 0.86), (front - 0.4, 0.52, 1.1), STEEL, both_sides=True)
    shell.box((rear + 0.75, 0.62, 0.45), (front - 1.4, 1.18, 1.0), STEEL, both_sides=True)
    # Mudguards ahead of the wheels only: tyres say what it is, from behind and above too.
    shell.box((rear + 0.4, 0.68, 0.9), (rear + 0.66, 1.24, 1.08), TRIM, both_sides=True)
    shell.box((rear - 0.45, -0.55, 1.1), (rear + 0.45, 0.55, 1.25), TRIM)
    for x in (end, rear + 0.8, front - 1.6):
        shell.box((x, -0.3, 0.88), (x + 0.16, 0.3, 1.06), STEEL)


def _tail_lamps(shell: Shell, x: float, z: float) -> None:
    """Add the rear lamps and a plate to a beam."""
    lamp = facing(x - 0.012, (0.72, 1.12), (z - 0.09, z + 0.09))
    shell.quads(lamp[::-1], TAIL_LAMP, both_sides=True)
    for side, y in ((INDICATOR_LEFT, (0.59, 0.71)), (INDICATOR_RIGHT, (-0.71, -0.59))):
        shell.quads(facing(x - 0.012, y, (z - 0.09, z + 0.09))[::-1], side)
    shell.quads(facing(x - 0.012, (-0.26, 0.26), (z - 0.06, z + 0.06))[::-1], PLATE)


def trailer_frame(shell: Shell, model: VehicleModel, z: float, detail: int) -> None:
    """Add the frame of a trailer, with guards, legs and rear beam."""
    end, front = -model.length / 2, model.length / 2 - 3.15
    shell.box((end, -0.6, z - 0.22), (front - 0.3, 0.6, z), STEEL)
    shell.box((end, -1.2, 0.62), (end + 0.14, 1.2, 0.86), TRIM)
    _tail_lamps(shell, end, 0.74)
    if detail == 0:
        return
    axles = [axle.x for axle in model.axles[2:]]
    shell.box((min(axles) - 0.6, 0.85, 1.05), (max(axles) + 0.6, 1.24, 1.1), TRIM, both_sides=True)
    ahead = model.axles[1].x - 1.6  # clear of the truck when it turns
    shell.box((max(axles) + 0.75, 1.16, 0.5), (ahead, 1.2, 1.0), STEEL, both_sides=True)
    shell.box((ahead - 0.3, 0.7, 0.3), (ahead - 0.15, 0.85, z - 0.1), TRIM, both_sides=True)
    if detail == 2:  # mud flaps
        x = min(axles) - 0.66
        shell.box((x, 0.87, 0.25), (x + 0.03, 1.22, 0.98), TRIM, both_sides=True)
