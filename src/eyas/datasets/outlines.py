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
    left = mask[rows].argmax(axis=1)
    right = mask.shape[1] - mask[rows, ::-1].argmax(axis=1)
    points = np.concatenate([
        np.column_stack([side, rows + below]) for side in (left, right) for below in (0, 1)
    ])  # fmt: skip
    hull = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(points)))
    edges = np.diff(hull, axis=0)
    # The same rectangle belongs to four directions; the one down to the right stands for them.
    along = np.where((edges[:, 0] > 0)[:, None] == (edges[:, 1] >= 0)[:, None], edges,
                     np.column_stack([-edges[:, 1], edges[:, 0]]))  # fmt: skip
    along = np.unique(along * np.where(along[:, :1] < 0, -1.0, 1.0), axis=0)
    along /= np.sqrt(np.square(along).sum(axis=1))[:, None]
    aside = np.column_stack([-along[:, 1], along[:, 0]])
    u = along[:, :1] * hull[:, 0] + along[:, 1:] * hull[:, 1]
    v = aside[:, :1] * hull[:, 0] + aside[:, 1:] * hull[:, 1]
    low, high = np.stack([u.min(1), v.min(1)], 1), np.stack([u.max(1), v.max(1)], 1)
    best = int(np.prod(high - low, axis=1).argmin())
    (u0, v0), (u1, v1) = low[best], high[best]
    places = np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])
    corners: NDArray[np.float64] = places[:, :1] * along[best] + places[:, 1:] * aside[best]
    return corners
