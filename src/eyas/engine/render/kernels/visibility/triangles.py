"""Triangles on the screen, eight at once: which are seen, their edges, how their depth changes.

Corners are rounded to sixteenths of a sample, so coverage is decided in whole numbers, which
float64 holds exactly: the same samples on every machine. Depths come from the corners as they were:
paint two centimetres above the road would otherwise fight with it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    ceiling,
    greater,
    lesser,
    load,
    select,
    store,
    to_f8,
    whole,
)

SIXTEENTHS = 16.0  # Steps in a sample to which corners are rounded

TRIANGLE_ROWS = 28  # Rows of `Scratch.triangle`, see the following; a column for each triangle.

LONG, UPPER, LOWER = 0, 4, 8
"""First of the rows of an edge: from the uppermost corner to the lowest; from the uppermost to the
middle one; from there to the lowest."""

X, Y = 0, 1
"""Rows of an edge: its upper end. The column is so shifted that a sample with its centre right of
the edge, or on it, has this number or more; the row is in sixteenths."""

RUN = 2  # How far the edge runs to the right [sixteenths]

FALL = 3  # One over how far it runs down [samples / sixteenths^2]

FIRST_ROW, LAST_ROW = 12, 13  # First row of samples, and last + 1

START, ACROSS, DOWN = 14, 15, 16
"""1/distance at the centre of sample (0, 0), and how it changes from column to column, and from row
to row."""

LEAST, MOST = 17, 18  # Limits of 1/distance

INVERSE = 19  # 1/distance at corner a

U, V = 20, 24
"""First of the three rows, like `START`, of u/distance and v/distance, for triangles of leaves."""


class Corners(NamedTuple):
    """Column and row [samples] and 1/distance of the three corners of eight triangles."""

    ax: float
    ay: float
    ai: float
    bx: float
    by: float
    bi: float
    cx: float
    cy: float
    ci: float


@kernel(inline=True)
def load_corners(rows: NDArray[np.float64]) -> Corners:
    """Return corners from an array with a row for each field."""
    return Corners(
        load(rows, 0), load(rows, WIDTH), load(rows, 2 * WIDTH), load(rows, 3 * WIDTH),
        load(rows, 4 * WIDTH), load(rows, 5 * WIDTH), load(rows, 6 * WIDTH),
        load(rows, 7 * WIDTH), load(rows, 8 * WIDTH),
    )  # fmt: skip


@kernel(inline=True)
def _snapped(place: float) -> float:
    """Return places [samples] in whole sixteenths of a sample."""
    return whole(place * SIXTEENTHS + 0.5)


@kernel(inline=True)
def _first_at(place: float) -> float:
    """Return the first row or column whose centre is at a place [sixteenths] or after it."""
    return ceiling((place - 0.5 * SIXTEENTHS) * (1.0 / SIXTEENTHS))


@kernel(inline=True)
def set_up(
    corners: Corners,
    wanted: bool,
    both_sides: bool,
    top: float,
    bottom: float,
    width: float,
    aside: float,
    triangle: NDArray[np.float64],
) -> bool:
    """Prepare eight triangles for `fill`; return which of them hold a centre of a sample.

    Args:
        corners: The corners; they go clockwise on the screen (row 0 on top).
        wanted: Which triangles to draw.
        both_sides: Which to draw even if they go the other way round.
        top: First row of samples of the band.
        bottom: Last row + 1.
        width: Width of the picture [samples].
        aside: Share by which 1/distance may be more, or less, than at all corners. By the rounding
            of corners, a sample of a sliver may lie beside it, where its plane is anywhere.
        triangle: Filled, see `Scratch`, shape (TRIANGLE_ROWS, 8).
    """
    c = corners
    x0, y0, x1, y1 = _snapped(c.ax), _snapped(c.ay), _snapped(c.bx), _snapped(c.by)
    x2, y2 = _snapped(c.cx), _snapped(c.cy)
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    seen = wanted & ((area < 0.0) | (both_sides & (area > 0.0)))
    first = greater(_first_at(lesser(lesser(y0, y1), y2)), top)
    last = lesser(_first_at(greater(greater(y0, y1), y2)), bottom)
    left, right = lesser(lesser(x0, x1), x2), greater(greater(x0, x1), x2)
    seen &= (first < last) & (greater(_first_at(left), 0.0) < lesser(_first_at(right), width))
    if any_of(seen):
        store(triangle, FIRST_ROW * WIDTH, first)
        store(triangle, LAST_ROW * WIDTH, last)
        swap = y0 > y1
        x0, x1 = select(swap, x1, x0), select(swap, x0, x1)
        y0, y1 = lesser(y0, y1), greater(y1, y0)
        swap = y1 > y2
        x1, x2 = select(swap, x2, x1), select(swap, x1, x2)
        y1, y2 = lesser(y1, y2), greater(y2, y1)
        swap = y0 > y1
        x0, x1 = select(swap, x1, x0), select(swap, x0, x1)
        y0, y1 = lesser(y0, y1), greater(y1, y0)
        _set_edge(triangle, LONG, x0, y0, x2, y2)
        _set_edge(triangle, UPPER, x0, y0, x1, y1)
        _set_edge(triangle, LOWER, x1, y1, x2, y2)
        _set_plane(triangle, START, c, c.ai, c.bi, c.ci)
        store(triangle, LEAST * WIDTH, lesser(lesser(c.ai, c.bi), c.ci) * (1.0 - aside))
        store(triangle, MOST * WIDTH, greater(greater(c.ai, c.bi), c.ci) * (1.0 + aside))
        store(triangle, INVERSE * WIDTH, c.ai)
    return seen


@kernel(inline=True)
def set_up_leaves(
    corners: Corners,  # See `set_up`
    uv: NDArray[np.floating],  # Holds rows of eight: u and v of corner a, of b and of c [tiles]
    first: int,  # Index of the first number of the first row
    triangle: NDArray[np.float64],  # See `set_up`
) -> None:
    """Prepare the texture coordinates of eight triangles; u/w and v/w are linear, like 1/w."""
    c = corners
    for k in range(2):
        at = first + k * WIDTH
        a, b = to_f8(load(uv, at)) * c.ai, to_f8(load(uv, at + 2 * WIDTH)) * c.bi
        _set_plane(triangle, U + (V - U) * k, c, a, b, to_f8(load(uv, at + 4 * WIDTH)) * c.ci)


@kernel(inline=True)
def _set_edge(
    triangle: NDArray[np.float64], row: int, x0: float, y0: float, x1: float, y1: float
) -> None:
    store(triangle, (row + X) * WIDTH, (x0 - 0.5 * SIXTEENTHS) * (1.0 / SIXTEENTHS))
    store(triangle, (row + Y) * WIDTH, y0)
    store(triangle, (row + RUN) * WIDTH, x1 - x0)
    store(triangle, (row + FALL) * WIDTH, (1.0 / SIXTEENTHS) / (y1 - y0))


@kernel(inline=True)
def _set_plane(
    triangle: NDArray[np.float64], row: int, c: Corners, a: float, b: float, value: float
) -> None:
    """Write how a quantity changes, from its values at the corners."""
    bx, by, cx, cy = c.bx - c.ax, c.by - c.ay, c.cx - c.ax, c.cy - c.ay
    scale = 1.0 / (bx * cy - cx * by)
    to_b, to_c = (b - a) * scale, (value - a) * scale
    across, down = to_b * cy - to_c * by, to_c * bx - to_b * cx
    store(triangle, row * WIDTH, a + (0.5 - c.ax) * across + (0.5 - c.ay) * down)
    store(triangle, (row + 1) * WIDTH, across)
    store(triangle, (row + 2) * WIDTH, down)
