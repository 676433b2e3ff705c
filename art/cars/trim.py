"""Parts that stand out from a car's body: bumpers with dark lower lips at both ends, mirrors,
plates, the third brake lamp, rails, walls of the arches.
"""

import numpy as np
from numpy.typing import NDArray

from art.cars.finishes import GLASS, HIGH_BRAKE_LAMP, PAINT, PLATE, STEEL, TRIM
from art.cars.frame import Frame
from art.cars.regions import COOLER, PLAIN, body_paint
from art.cars.shape import CarShape, arch_radius, half_widths, height_at, sections
from art.cars.wrap import Wrap
from eyas.engine.mesh.panels import box_panels, cells
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.lanes import exact

AHEAD = 0.04  # Depth of a bumper beyond the end of the body [m]
_ASIDE = 0.025  # Depth of a bumper beyond the sides [m]
_TOP = 0.565  # Height of its upper edge, as a share of that of the belt line above the floor
_TALLEST = 0.5  # Height of a bumper at most [m]: those of vans are no taller than those of cars


def add_bumpers(shell: Shell, frame: Frame, shape: CarShape, wrap: Wrap, paint: Material) -> None:
    """Add both bumpers.

    Args:
        shell: Shell to add them to.
        frame: The car without its body.
        shape: Its lines; its ends are where the bumpers end.
        wrap: Its texture coordinates.
        paint: Its paint.
    """
    reach = arch_radius(frame.wheel_radius) + 0.01
    for front in (False, True):
        end, belt = (shape.top[-1 if front else 0][0], shape.belt[-1 if front else 0][1])
        axle = frame.axles[0 if front else 1].x
        start = axle + reach if front else axle - reach
        top = shape.clearance + min(_TOP * (belt - shape.clearance), _TALLEST)
        rows = _rows(shape.clearance, top)
        grid = np.array([_ring(frame, shape, (start, end), row) for row in rows])
        if front:
            grid = grid[:, ::-1]
        half = float(half_widths(frame, shape, np.array([end]))[0])
        uvs = cells(wrap.end(grid, half, front=front))
        count = grid.shape[1] - 1
        lip = 2 * count
        panels = cells(grid)
        shell.quads(panels[:lip], TRIM)
        if shape.dark_bumpers:
            shell.quads(panels[lip:], TRIM)
        else:
            shell.quads(panels[lip:], paint, uvs=uvs[lip:])


def _rows(low: float, top: float) -> list[tuple[float, float]]:
    """Return distance inwards and height of the edges of a bumper from below [m]."""
    lip = low + 0.3 * (top - low)
    return [
        (0.08, low), (0.006, low + 0.01), (0.006, lip),
        (0.0, lip + 0.015), (0.0, top - 0.03), (0.05, top),
    ]  # fmt: skip


def _ring(
    frame: Frame, shape: CarShape, ends: tuple[float, float], row: tuple[float, float]
) -> NDArray[np.float64]:
    """Return an edge of a bumper, from the left wheel arch round the end to the right one."""
    start, end = ends
    inwards, z = row
    way = 1.0 if end > start else -1.0
    kinks = [
        x for x, _ in shape.plan if way * start < way * x - 0.03 and way * x < way * end - 0.02
    ]
    along = np.array([start, start + 0.04 * way, *kinks[:: int(way)], end])
    y = half_widths(frame, shape, along) + _ASIDE - inwards
    y[0] -= _ASIDE + 0.02  # ends inside the body
    along[-1] = end - way * inwards
    left = np.column_stack([along, y, np.full(len(y), z)])
    return np.concatenate([left, left[::-1] * [1.0, -1.0, 1.0]])


def add_trimmings(shell: Shell, frame: Frame, shape: CarShape) -> None:
    """Add what is fixed to a body of the finest level."""
    _mirrors(shell, frame, shape)
    for start, end, top in shape.pods:
        under, over, *sides = box_panels((start, -0.8, top - 0.5), (end, 0.8, top), 0.06)
        corners = COOLER.at([0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0])
        shell.quads(over, body_paint("freight"), uvs=corners)
        shell.quads([under, *sides], body_paint("freight"), uvs=[PLAIN] * 5)
    _plates(shell, shape)
    x = shape.rear_window[1]
    z = height_at(shape.top, x)
    shell.box((x - 0.03, -0.11, z - 0.07), (x + 0.1, 0.11, z - 0.002), HIGH_BRAKE_LAMP)
    if shape.rack:
        _rack(shell, frame, shape)
    _arches(shell, frame, shape)


def _mirrors(shell: Shell, frame: Frame, shape: CarShape) -> None:
    half = frame.width / 2
    x = shape.windscreen[1] - 0.42
    z = height_at(shape.belt, x)
    low, high = (x - 0.06, half - 0.2, z + 0.01), (x + 0.13, half + 0.035, z + 0.19)
    shell.box(low, high, PAINT, taper=0.015, both_sides=True)
    y = half + 0.01, half - 0.17
    glass = [(x - 0.072, y[0], z + 0.035), (x - 0.072, y[1], z + 0.035),
             (x - 0.06, y[1], z + 0.17), (x - 0.06, y[0], z + 0.17)]  # fmt: skip
    shell.quads(glass, GLASS, both_sides=True)


def _plates(shell: Shell, shape: CarShape) -> None:
    """Add number plates: in front on the bumper, behind above it."""
    tail, nose = shape.top[0][0], shape.top[-1][0]
    low, high = shape.clearance, (shape.belt[0][1], shape.belt[-1][1])
    z = low + 0.26 * (high[1] - low)
    shell.box((nose - 0.02, -0.26, z), (nose + 0.014, 0.26, z + 0.1), PLATE)
    z = low + 0.64 * (high[0] - low)
    shell.box((tail, -0.26, z), (tail + AHEAD + 0.02, 0.26, z + 0.12), PLATE)


def _rack(shell: Shell, frame: Frame, shape: CarShape) -> None:
    """Add rails along both edges of the roof."""
    start, end = shape.rear_window[1] + 0.25, shape.windscreen[0] - 0.2
    x = np.array([start, start + 0.12, 0.5 * (start + end), end - 0.12, end])
    edge = sections(frame, shape, x, arches=True)[:, 6]
    lift = np.array([-0.02, 0.045, 0.045, 0.045, -0.02])
    path = edge + np.column_stack([0 * lift, 0 * lift + 0.015, lift])
    shell.tube(path, (0.022,) * 5, STEEL, sides=4, both_sides=True)


def _arches(shell: Shell, frame: Frame, shape: CarShape) -> None:
    """Add the walls inside the wheel arches."""
    for axle in frame.axles:
        y = (axle.track - axle.width) / 2 - 0.02
        reach = 1.1 * arch_radius(frame.wheel_radius)
        angle = np.linspace(-0.3, np.pi + 0.3, 7)
        rise = np.maximum(frame.wheel_radius + reach * exact.sin(angle), shape.clearance)
        wall = np.column_stack([axle.x - reach * exact.cos(angle), np.full(7, y), rise])
        fan = [[wall[0], wall[i], wall[i + 1]] for i in range(1, 6)]
        shell.triangles(fan, TRIM)
        shell.triangles(np.array(fan)[:, ::-1] * [1.0, -1.0, 1.0], TRIM)
