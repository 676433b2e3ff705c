"""Rasterisation of triangles."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.surface.texture import coverage

__all__ = ["BOTH_SIDES", "FRONT", "rasterise"]

FRONT = 0
"""Draw only triangles seen from their front."""

BOTH_SIDES = 1
"""Draw all triangles."""


@inlined_kernel
def _misses(
    corners: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    top: int,
    rows: int,
    width: int,
    sides: int,
) -> bool:
    """Return whether a triangle is seen from behind, or its bounds hold no centre of a pixel."""
    ax, ay, bx, by = corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
    cx, cy = corners[c, 0], corners[c, 1]
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    if area == 0.0 or (area > 0.0 and sides == FRONT):
        return True
    low, high = min(ay, by, cy), max(ay, by, cy)
    if not (high >= top and low <= top + rows):
        return True
    if math.ceil(max(low, float(top)) - 0.5) >= math.ceil(min(high, float(top + rows)) - 0.5):
        return True
    left, right = min(ax, bx, cx), max(ax, bx, cx)
    if right < 0.5 or left > width - 0.5:
        return True
    return bool(math.ceil(max(left, 0.0) - 0.5) > right - 0.5)


@inlined_kernel
def rasterise(
    corners: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    top: int,
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    tag: int,
    sides: int,
    textures: NDArray[np.uint32],
    layer: int,
    level: int,
) -> None:
    """Draw a triangle wherever it is nearer than what was drawn before.

    A pixel belongs to a triangle if its centre does. On each row the crossing of an edge is
    computed from the edge's upper end, so the two triangles at an edge get the same number: no
    pixel between them is missed, and none is drawn twice. 1/w is linear on the screen.
    Edges are walked in float64: near the near plane corners lie millions of pixels outside.

    Args:
        corners: Column, row, 1/w, and if `level` >= 0 u and v, of the corners.
        a: First corner, a row of `corners`; they go clockwise on the screen (row 0 on top).
        b: Second corner.
        c: Third corner.
        top: Row of the picture that is row 0 of `depth`.
        depth: Largest 1/w so far, shape (rows, columns).
        owner: Owner of each sample.
        tag: Value to write into `owner`.
        sides: `FRONT` or `BOTH_SIDES`.
        textures: Texels of all layers, see `Geometry`.
        layer: Texture whose alpha cuts holes.
        level: Its mip level, -1 for no holes.
    """
    # Most triangles end here: before a call, whose arguments cost more than the test.
    if _misses(corners, a, b, c, top, depth.shape[0], depth.shape[1], sides):
        return
    _fill(corners, a, b, c, top, depth, owner, tag, textures, layer, level)


@inner_kernel
def _fill(
    corners: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    top: int,
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    tag: int,
    textures: NDArray[np.uint32],
    layer: int,
    level: int,
) -> None:
    """Draw a triangle that is not missed; for the arguments see `rasterise`."""
    ax, ay, bx, by = corners[a, 0], corners[a, 1], corners[b, 0], corners[b, 1]
    cx, cy = corners[c, 0], corners[c, 1]
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    rows, width = depth.shape
    low, high = min(ay, by, cy), max(ay, by, cy)
    first_row = math.ceil(max(low, float(top)) - 0.5)
    last_row = math.ceil(min(high, float(top + rows)) - 0.5)

    ai = corners[a, 2]
    scale = 1.0 / area
    bi, ci = (corners[b, 2] - ai) * scale, (corners[c, 2] - ai) * scale
    slope_x = bi * (cy - ay) - ci * (by - ay)
    slope_y = ci * (bx - ax) - bi * (cx - ax)
    step = f4(slope_x)

    x0, y0, x1, y1, x2, y2 = ax, ay, bx, by, cx, cy
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    if y1 > y2:
        x1, y1, x2, y2 = x2, y2, x1, y1
    if y0 > y1:
        x0, y0, x1, y1 = x1, y1, x0, y0
    long_is_left = (x1 - x0) * (y2 - y0) > (x2 - x0) * (y1 - y0)
    long_slope = (x2 - x0) / (y2 - y0)
    upper_slope = (x1 - x0) / (y1 - y0) if y1 > y0 else 0.0
    lower_slope = (x2 - x1) / (y2 - y1) if y2 > y1 else 0.0

    for row in range(first_row, last_row):
        y = row + 0.5
        start = x0 + (y - y0) * long_slope
        end = x0 + (y - y0) * upper_slope if y < y1 else x1 + (y - y1) * lower_slope
        if not long_is_left:
            start, end = end, start
        # Clamped before the conversion: larger values would overflow an integer.
        first = math.ceil(max(start, 0.0) - 0.5)
        last = math.ceil(min(end, float(width)) - 0.5)
        if first >= last:
            continue
        value = f4(ai + (y - ay) * slope_y + (first + 0.5 - ax) * slope_x)
        line = row - top
        if level < 0:
            for column in range(first, last):
                if value > depth[line, column]:
                    depth[line, column] = value
                    owner[line, column] = tag
                value += step
        else:
            _leaves(
                corners, a, b, c, scale, row, first, last, value, step, line,
                depth, owner, tag, textures, layer, level,
            )  # fmt: skip


@inner_kernel
def _leaves(
    corners: NDArray[np.float64],
    a: int,
    b: int,
    c: int,
    scale: float,
    row: int,
    first: int,
    last: int,
    value: float,
    step: float,
    line: int,
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    tag: int,
    textures: NDArray[np.uint32],
    layer: int,
    level: int,
) -> None:
    """Draw the span of one row where the texture has leaves. u/w and v/w are linear, like 1/w."""
    ax, ay, ai = corners[a, 0], corners[a, 1], corners[a, 2]
    bx, by, bi = corners[b, 0] - ax, corners[b, 1] - ay, corners[b, 2]
    cx, cy, ci = corners[c, 0] - ax, corners[c, 1] - ay, corners[c, 2]
    x, y = first + 0.5 - ax, row + 0.5 - ay
    au = corners[a, 3] * ai
    bu, cu = (corners[b, 3] * bi - au) * scale, (corners[c, 3] * ci - au) * scale
    u_step = bu * cy - cu * by
    u = f4(au + x * u_step + y * (cu * bx - bu * cx))
    av = corners[a, 4] * ai
    bv, cv = (corners[b, 4] * bi - av) * scale, (corners[c, 4] * ci - av) * scale
    v_step = bv * cy - cv * by
    v = f4(av + x * v_step + y * (cv * bx - bv * cx))
    du, dv = f4(u_step), f4(v_step)
    for column in range(first, last):
        if value > depth[line, column]:
            w = f4(1.0) / value
            if coverage(textures, layer, level, u * w, v * w) > 127:
                depth[line, column] = value
                owner[line, column] = tag
        value += step
        u += du
        v += dv
