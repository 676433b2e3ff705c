"""Corners of panels in space, before they have a material. Counter-clockwise seen from outside."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["box_panels", "cells", "closed", "fan", "halves", "mirrored"]

Points = NDArray[np.float64]


def cells(grid: ArrayLike) -> Points:
    """Return the quadrilaterals between neighbours of a grid, row after row.

    Args:
        grid: Points in space or of a texture, shape (R, K, D). Seen from outside, rows lie above
            each other and their points run from left to right.

    Returns:
        Shape ((R - 1) (K - 1), 4, D).
    """
    g = np.asarray(grid, np.float64)
    corners = np.stack([g[:-1, :-1], g[:-1, 1:], g[1:, 1:], g[1:, :-1]], axis=2)
    return corners.reshape(-1, 4, g.shape[2])


def closed(rings: ArrayLike) -> Points:
    """Return rings that end with the point they begin with, shape (R, K + 1, D)."""
    r = np.asarray(rings, np.float64)
    return np.concatenate([r, r[:, :1]], axis=1)


def halves(quads: ArrayLike) -> Points:
    """Return the triangles of quadrilaterals, shape (2 Q, 3, D): all first halves, then the others.

    Args:
        quads: Shape (Q, 4, D).
    """
    corners = np.asarray(quads, np.float64)
    return np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])


def fan(ring: ArrayLike, middle: Sequence[float] | None = None) -> Points:
    """Return triangles that fill a convex ring.

    Args:
        ring: Corners, shape (K, 3).
        middle: Point where they all meet; None: the ring's first corner.

    Returns:
        Shape (K, 3, 3), or (K - 2, 3, 3) without a middle.
    """
    r = np.asarray(ring, np.float64)
    if middle is None:
        return np.stack([np.broadcast_to(r[0], r[2:].shape), r[1:-1], r[2:]], axis=1)
    return np.stack([np.tile(middle, (len(r), 1)), r, np.roll(r, -1, axis=0)], axis=1)


def box_panels(low: Sequence[float], high: Sequence[float], taper: float = 0.0) -> Points:
    """Return the faces of a box between two corners, shape (6, 4, 3).

    Args:
        low: Least x, y and z.
        high: Largest x, y and z.
        taper: How far the top is drawn in on all four sides.
    """
    (x0, y0, z0), (x1, y1, z1), t = low, high, taper
    bottom = np.array([(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)])
    top = np.array(
        [
            (x0 + t, y0 + t, z1),
            (x1 - t, y0 + t, z1),
            (x1 - t, y1 - t, z1),
            (x0 + t, y1 - t, z1),
        ]
    )
    return np.concatenate([[bottom[::-1]], [top], cells(closed([bottom, top]))])


def mirrored(triangles: ArrayLike) -> Points:
    """Return triangles mirrored left for right, still counter-clockwise, shape (T, 3, 3)."""
    return np.asarray(triangles, np.float64)[:, ::-1] * [1.0, -1.0, 1.0]
