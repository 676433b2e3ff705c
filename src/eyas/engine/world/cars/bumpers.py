"""Bumpers: parts of their own that stand out from both ends of a car, with dark lower lips."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.panels import cells
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.engine.world.cars.finishes import TRIM
from eyas.engine.world.cars.frame import Frame
from eyas.engine.world.cars.shape import CarShape, arch_radius, half_widths
from eyas.engine.world.cars.wrap import Wrap

__all__ = ["AHEAD", "add_bumpers"]

AHEAD = 0.04  # How far a bumper stands out from the end of the body [m]

_ASIDE = 0.025  # How far it stands out from the sides [m]

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
