"""Outlines of masks as polygons, along the edges of pixels, so that a polygon fills its mask
exactly.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["least_rectangle", "outline"]


def outline(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return one polygon around all parts and holes of a mask, joined by lines of no width: the
    corners of pixels that it passes, column and row, shape (K, 2).

    Args:
        mask: Shape (H, W), with at least one pixel.
    """
    loops = _loops(mask)
    path = [point for loop in loops for point in (*loop, loop[0])]
    path += [loop[0] for loop in reversed(loops[:-1])]
    return np.array(path[:-1] if len(loops) == 1 else path, np.int64)


def _loops(mask: NDArray[np.bool_]) -> list[list[tuple[int, int]]]:
    """Return closed paths along the mask's edges. Pixels that touch at a corner are connected.

    An edge ends where an odd number of the four pixels around a corner is in the mask, or two that
    touch there only. In the order of rows, each two of these ends are joined by a level edge; in
    the order of columns, by an upright one. A path takes both in turn.
    """
    padded = np.pad(mask, 1)
    a, b, c, d = padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]
    touching = (a == d) & (b == c) & (a != b)
    rows, columns = np.nonzero((a ^ b ^ c ^ d) | touching)
    twice = touching[rows, columns]
    falling = twice & a[rows, columns]
    ends = np.repeat(np.arange(len(rows)), 1 + twice)
    first = np.ones(len(ends), bool)
    first[1:] = ends[1:] != ends[:-1]
    rows, columns, falling = rows[ends], columns[ends], falling[ends]
    # Of two ends at one corner the first has the level edge to its left. It takes the upright one
    # below where the pixels lie like \\, and the one above where they lie like /: so both pixels
    # are on the same path.
    level = np.arange(len(ends)) ^ 1
    order = np.lexsort((first ^ ~falling, rows, columns))
    upright = np.empty_like(order)
    upright[order] = order.reshape(-1, 2)[:, ::-1].ravel()
    return _paths(columns.tolist(), rows.tolist(), level.tolist(), upright.tolist())


def _paths(
    columns: list[int], rows: list[int], level: list[int], upright: list[int]
) -> list[list[tuple[int, int]]]:
    loops = []
    left = set(range(len(columns)))
    for start in range(len(columns)):
        if start not in left:
            continue
        loop, at = [], start
        while at in left:
            over = level[at]
            left -= {at, over}
            loop += [(columns[at], rows[at]), (columns[over], rows[over])]
            at = upright[over]
        loops.append(loop)
    return loops


def least_rectangle(mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the corners of the rectangle of the least area around a mask's pixels, clockwise in
    the picture: column and row, shape (4, 2).

    Args:
        mask: Shape (H, W), with at least one pixel.
    """
    rows = np.flatnonzero(mask.any(axis=1))
    mask = mask[rows]
    left, right = mask.argmax(axis=1), mask.shape[1] - mask[:, ::-1].argmax(axis=1)
    x, y = np.concatenate([left, left, right, right]), np.concatenate([rows, rows + 1] * 2)
    hull = shapely.get_coordinates(shapely.convex_hull(shapely.linestrings(x, y)))
    x, y = hull[:, 0], hull[:, 1]
    # One of its sides lies along one of the hull's. Of the four directions of a rectangle the one
    # to the right, or down to the right, stands for it.
    dx, dy = x[1:] - x[:-1], y[1:] - y[:-1]
    keep = (dx * dy > 0) | (dy == 0)
    dx, dy = np.abs(dx), np.abs(dy)
    ahead, down = np.where(keep, dx, dy), np.where(keep, dy, dx)
    along, aside = (np.outer(ahead, x) + np.outer(down, y), np.outer(ahead, y) - np.outer(down, x))
    squares = ahead * ahead + down * down
    areas = np.ptp(along, axis=1) * np.ptp(aside, axis=1) / squares
    best = np.lexsort((down, ahead, areas))[0]
    u0, u1 = along[best].min(), along[best].max()
    v0, v1 = aside[best].min(), aside[best].max()
    u, v = np.array([u0, u1, u1, u0]), np.array([v0, v0, v1, v1])
    ahead, down, square = ahead[best], down[best], squares[best]
    corners = [(u * ahead - v * down) / square, (u * down + v * ahead) / square]
    return np.stack(corners, axis=1)
