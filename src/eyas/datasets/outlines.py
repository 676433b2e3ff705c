"""Outlines of masks as polygons, along the edges of pixels, so that a polygon fills its mask
exactly; and rectangles around masks.

Functions take the masks of a whole frame, as most of their time is that of calling numpy.
"""

from bisect import bisect_right
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
Point = tuple[int, int]


def outlines(
    masks: Sequence[Mask],  # Each of shape (H, W), with at least one pixel
) -> list[NDArray[np.int64]]:
    """Return for each mask one polygon around all its parts and holes, joined by lines of no width:
    the corners of pixels that it passes, column and row, shape (K, 2).
    """
    # All side by side, with an empty column between them.
    lefts = np.concatenate([[1], np.cumsum([mask.shape[1] + 1 for mask in masks]) + 1]).tolist()
    canvas = np.zeros((2 + max(len(mask) for mask in masks), lefts[-1]), bool)
    for mask, left in zip(masks, lefts, strict=False):
        canvas[1 : 1 + len(mask), left : left + mask.shape[1]] = mask
    loops: list[list[list[Point]]] = [[] for _ in masks]
    for loop in _loops(canvas):
        loops[bisect_right(lefts, loop[0][0] + 1) - 1].append(loop)
    return [
        np.array(_joined(own), np.int64) - (left - 1, 0)
        for own, left in zip(loops, lefts, strict=False)
    ]


def _joined(loops: list[list[Point]]) -> list[Point]:
    """Return one closed path along all loops, and back along their first points."""
    if len(loops) == 1:
        return loops[0]
    path = [point for loop in loops for point in (*loop, loop[0])]
    return path + [loop[0] for loop in reversed(loops[:-1])]


def _loops(padded: Mask) -> list[list[Point]]:
    """Return closed paths along a mask's edges; a corner has column and row of the pixel to its
    upper left. Pixels that touch at a corner are connected.

    An edge ends where an odd number of the four pixels around a corner is in the mask, or two that
    touch there only. In the order of rows, each two of these ends are joined by a level edge; in
    the order of columns, by an upright one. A path takes both in turn.
    """
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
    order = np.lexsort((first ^ ~falling, rows, columns))
    upright = np.empty_like(order)
    upright[order] = order.reshape(-1, 2)[:, ::-1].ravel()
    return _paths(list(zip(columns.tolist(), rows.tolist(), strict=True)), upright.tolist())


def _paths(points: list[Point], upright: list[int]) -> list[list[Point]]:
    """Return the paths through ends of edges: level edges join the ends 0 and 1, 2 and 3, ...;
    upright ones are given.
    """
    loops = []
    seen = [False] * len(points)
    for start in range(0, len(points), 2):
        loop, at = [], start
        while not seen[at]:
            over = at ^ 1
            seen[at] = seen[over] = True
            loop += [points[at], points[over]]
            at = upright[over]
        if loop:
            loops.append(loop)
    return loops


def least_rectangles(
    masks: Sequence[Mask],  # Each of shape (H, W), with at least one pixel
) -> list[NDArray[np.float64]]:
    """Return the corners of the rectangle of the least area around the pixels of each mask,
    clockwise in the picture: column and row, shape (4, 2).
    """
    points = [_ends_of_rows(mask) for mask in masks]
    owners = np.repeat(np.arange(len(masks)), [len(each) for each in points])
    hulls = shapely.convex_hull(shapely.linestrings(np.concatenate(points), indices=owners))
    return [_least_around(shapely.get_coordinates(hull)) for hull in hulls]


def _ends_of_rows(mask: Mask) -> NDArray[np.int64]:
    """Return the corners of the first and the last pixel of each row, shape (K, 2)."""
    rows = np.flatnonzero(mask.any(axis=1))
    mask = mask[rows]
    left, right = mask.argmax(axis=1), mask.shape[1] - mask[:, ::-1].argmax(axis=1)
    ends = np.empty((4, len(rows), 2), np.int64)
    ends[:2, :, 0], ends[2:, :, 0] = left, right
    ends[::2, :, 1], ends[1::2, :, 1] = rows, rows + 1
    return ends.reshape(-1, 2)


def _least_around(hull: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rectangle around a convex polygon, the last of whose points is the first."""
    x, y = hull.T
    # One of its sides lies along one of the hull's. Of the four directions of a rectangle the one
    # to the right, or down to the right, stands for it.
    dx, dy = x[1:] - x[:-1], y[1:] - y[:-1]
    keep = (dx * dy > 0) | (dy == 0)
    dx, dy = np.abs(dx), np.abs(dy)
    ahead, down = np.where(keep, dx, dy), np.where(keep, dy, dx)
    along, aside = ahead[:, None] * x + down[:, None] * y, ahead[:, None] * y - down[:, None] * x
    squares = ahead * ahead + down * down
    lengths, widths = (part.max(axis=1) - part.min(axis=1) for part in (along, aside))
    best = np.lexsort((down, ahead, lengths * widths / squares))[0]
    u0, u1, v0, v1 = (
        float(each) for part in (along[best], aside[best]) for each in (part.min(), part.max())
    )
    a, b, square = float(ahead[best]), float(down[best]), float(squares[best])
    places = ((u0, v0), (u1, v0), (u1, v1), (u0, v1))
    return np.array([((u * a - v * b) / square, (u * b + v * a) / square) for u, v in places])
