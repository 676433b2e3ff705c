"""Rasterisation of triangles, eight rows and then eight pixels at once.

Corners are rounded to sixteenths of a pixel, so coverage is decided in whole numbers, which float64
holds exactly: the same pixels on every machine. Depths come from the corners as they were: paint
two centimetres above the road would otherwise fight with it.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.core.lanes import (
    any_of,
    bits_of,
    ceiling,
    first_bit,
    greater,
    lane,
    lane_numbers,
    lesser,
    load,
    select,
    store,
    to_f4,
    to_f8,
    to_i4,
    to_u4,
    whole,
)
from eyas.render.kernels.scalars import f4, i4, u4
from eyas.render.kernels.visibility.holes import Holes, has_leaf
from eyas.render.kernels.visibility.key import key_of

__all__ = ["BOTH_SIDES", "FRONT", "SIXTEENTHS", "rasterise"]

FRONT = 0
"""Draw only triangles seen from their front."""

BOTH_SIDES = 1
"""Draw all triangles."""

SIXTEENTHS = 16.0
"""Steps in a pixel to which corners are rounded."""

EIGHT = 8
"""Rows, or pixels of a row, that are handled at once."""


class Edges(NamedTuple):
    """The three edges of a triangle, each walked from its upper end; in sixteenths of a pixel."""

    x0: float
    """The uppermost corner."""
    y0: float
    x1: float
    """The middle one."""
    y1: float
    long_run: float
    """How far the long edge, from the uppermost to the lowest corner, runs to the right."""
    long_fall: float
    """One over how far it runs down."""
    upper_run: float
    """The same of the two others."""
    upper_fall: float
    lower_run: float
    lower_fall: float


class Plane(NamedTuple):
    """A quantity that is linear on the screen: its value at a corner, and slopes [1/sample]."""

    start: float
    slope_x: float
    slope_y: float


@inlined_kernel
def _snapped(place: float) -> float:
    """Return a place [samples] in whole sixteenths of a sample."""
    return whole(place * SIXTEENTHS + 0.5)


@inlined_kernel
def _first_at(place: float) -> int:
    """Return the first row whose centre is at a place or after it."""
    return math.ceil((place - 0.5 * SIXTEENTHS) * (1.0 / SIXTEENTHS))


@inlined_kernel
def _crossing(down: float, x: float, run: float, fall: float) -> float:
    """Return the first column at or after an edge, as far `down` as given from its upper end.

    A column's centre lies at or right of the edge if it does so of a place half a step of the
    (whole) product to the left, and never exactly at that place: so the rounding of the division
    changes nothing. Both triangles at an edge call this with the same numbers, so no pixel is left
    out or drawn twice even where corners lie millions of pixels outside and products are rounded.
    """
    return ((down * run - 0.5) * fall + (x - 0.5 * SIXTEENTHS)) * (1.0 / SIXTEENTHS)


@inlined_kernel
def _ends(edges: Edges, y: float, width: float) -> tuple[int, int]:
    """Return the first and the last column + 1 of the triangle in eight rows, centres at `y`."""
    e = edges
    long = _crossing(y - e.y0, e.x0, e.long_run, e.long_fall)
    upper = _crossing(y - e.y0, e.x0, e.upper_run, e.upper_fall)
    lower = _crossing(y - e.y1, e.x1, e.lower_run, e.lower_fall)
    short = select(y < e.y1, upper, lower)
    # Clamped before the conversion: larger values would overflow an integer.
    first = lesser(greater(lesser(long, short), 0.0), width)
    last = lesser(greater(greater(long, short), 0.0), width)
    return to_i4(ceiling(first)), to_i4(ceiling(last))


@inlined_kernel
def rasterise(
    polygon: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    top: int,
    width: int,
    key: NDArray[np.int64],
    tag: int,
    sides: int,
    aside: float,
    holes: Holes,
) -> None:
    """Draw a triangle wherever it is nearer than what was drawn before.

    A pixel belongs to a triangle if its centre does, by the top-left rule.

    Args:
        polygon: Column, row, 1/distance, and if there are holes u and v, of the corners.
        a: First corner, a row of `polygon`; they go clockwise on the screen (row 0 on top).
        b: Second corner.
        c: Third corner.
        top: Row of the picture that is row 0 of `key`.
        width: Width of the picture [samples].
        key: See `Scratch`, shape (rows, columns).
        tag: Lower half of the key, see `eyas.render.kernels.visibility.key`.
        sides: `FRONT` or `BOTH_SIDES`.
        aside: Share by which 1/distance may be more, or less, than at all corners. By the rounding
            of corners, a pixel of a sliver may lie beside it, where its plane is anywhere.
        holes: The texture whose alpha cuts holes.
    """
    x0, y0 = _snapped(polygon[a, 0]), _snapped(polygon[a, 1])
    x1, y1 = _snapped(polygon[b, 0]), _snapped(polygon[b, 1])
    x2, y2 = _snapped(polygon[c, 0]), _snapped(polygon[c, 1])
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    if area == 0.0 or (area > 0.0 and sides == FRONT):
        return
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if y1 > y2:
        x1, y1, x2, y2 = x2, y2, x1, y1
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    # Clamped before the conversion here, too.
    first_row = _first_at(max(y0, SIXTEENTHS * top))
    last_row = _first_at(min(y2, SIXTEENTHS * (top + key.shape[0])))
    if first_row >= last_row:
        return
    edges = Edges(
        x0, y0, x1, y1, x2 - x0, 1.0 / (y2 - y0), x1 - x0, 1.0 / (y1 - y0), x2 - x1,
        1.0 / (y2 - y1),
    )  # fmt: skip
    _fill(polygon, a, b, c, edges, first_row, last_row, top, width, key, tag, aside, holes)


@inlined_kernel
def _plane(
    polygon: NDArray[np.float64], a: int, b: int, c: int, va: float, vb: float, vc: float
) -> Plane:
    """Return the plane of a quantity, from its values at the corners."""
    bx, by = polygon[b, 0] - polygon[a, 0], polygon[b, 1] - polygon[a, 1]
    cx, cy = polygon[c, 0] - polygon[a, 0], polygon[c, 1] - polygon[a, 1]
    scale = 1.0 / (bx * cy - cx * by)
    db, dc = (vb - va) * scale, (vc - va) * scale
    return Plane(va, db * cy - dc * by, dc * bx - db * cx)


@inlined_kernel
def _values(plane: Plane, x: float, y: float) -> float:
    """Return a quantity in eight rows, as far from its corner as given."""
    return to_f4(plane.start + y * plane.slope_y + x * plane.slope_x)


@inlined_kernel
def _fill(
    polygon: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    edges: Edges,
    first_row: int,
    last_row: int,
    top: int,
    width: int,
    key: NDArray[np.int64],
    tag: int,
    aside: float,
    holes: Holes,
) -> None:
    """Draw rows of a triangle."""
    ax, ay, ai = polygon[a, 0], polygon[a, 1], polygon[a, 2]
    bi, ci = polygon[b, 2], polygon[c, 2]
    plane = _plane(polygon, a, b, c, ai, bi, ci)
    step = f4(plane.slope_x)
    least = f4(min(ai, bi, ci) * (1.0 - aside))
    most = f4(max(ai, bi, ci) * (1.0 + aside))
    u_plane = v_plane = plane
    if holes.level >= 0:  # u/w and v/w are linear, like 1/w
        au, bu, cu = polygon[a, 3] * ai, polygon[b, 3] * bi, polygon[c, 3] * ci
        av, bv, cv = polygon[a, 4] * ai, polygon[b, 4] * bi, polygon[c, 4] * ci
        u_plane = _plane(polygon, a, b, c, au, bu, cu)
        v_plane = _plane(polygon, a, b, c, av, bv, cv)
    u_step, v_step = f4(u_plane.slope_x), f4(v_plane.slope_x)
    numbers = lane_numbers()
    for group in range(first_row, last_row, EIGHT):
        rows = to_f8(numbers + i4(group)) + 0.5
        firsts, lasts = _ends(edges, rows * SIXTEENTHS, float(width))
        live = bits_of(firsts < lasts)
        if last_row - group < EIGHT:
            live &= (1 << (last_row - group)) - 1
        x, y = to_f8(firsts) + (0.5 - ax), rows - ay
        values, us, vs = _values(plane, x, y), _values(u_plane, x, y), _values(v_plane, x, y)
        while live != 0:
            number = first_bit(live)
            live &= live - 1
            first, last = lane(firsts, number), lane(lasts, number)
            value = lane(values, number)
            line = (group + number - top) * key.shape[1]
            for start in range(first & -EIGHT, last, EIGHT):
                columns = numbers + i4(start - first)
                steps = to_f4(columns)
                inverse = lesser(greater(value + step * steps, least), most)
                wanted = to_u4(columns) < u4(last - first)
                at = line + start
                old = load(key, at)
                if holes.level >= 0:
                    wanted &= key_of(inverse, tag) > old
                    if not any_of(wanted):
                        continue
                    w = f4(1.0) / inverse
                    u = (lane(us, number) + u_step * steps) * w
                    v = (lane(vs, number) + v_step * steps) * w
                    wanted &= has_leaf(holes, u, v)
                # A key below 0 is smaller than all others.
                new = key_of(select(wanted, inverse, f4(-1.0)), tag)
                store(key, at, greater(new, old))
