"""Corners of panels in space, without materials. Counter-clockwise as seen from outside."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]

_HALVES = np.array([[0, 1, 2], [0, 2, 3]])  # Corners of the two triangles of a quadrilateral


def cells(grid: ArrayLike) -> Points:
    """Return the quadrilaterals between neighbouring points of a grid, row by row.

    Args:
        grid: Points in space or in a texture, shape (R, K, D). As seen from outside, each row lies
            above the one before it, and its points run from left to right.

    Returns:
        Shape ((R - 1) (K - 1), 4, D).
    """
    g = np.asarray(grid, np.float64)
    corners = np.stack([g[:-1, :-1], g[:-1, 1:], g[1:, 1:], g[1:, :-1]], axis=2)
    return corners.reshape(-1, 4, g.shape[2])


def closed(rings: ArrayLike) -> Points:
    """Return rings with their first point repeated at the end, shape (R, K + 1, D)."""
    r = np.asarray(rings, np.float64)
    return np.concatenate([r, r[:, :1]], axis=1)


def halves(
    quads: ArrayLike,  # Shape (Q, 4, D)
) -> Points:
    """Return triangles of quadrilaterals, shape (2 Q, 3, D): all first halves, then all second."""
    corners = np.asarray(quads, np.float64)
    return corners[:, _HALVES].swapaxes(0, 1).reshape(-1, 3, corners.shape[2])


def fan(ring: ArrayLike, middle: Sequence[float] | None = None) -> Points:
    """Return triangles that fill a convex ring.

    Args:
        ring: Corners, shape (K, 3).
        middle: Common corner of all triangles; None: the ring's first corner.

    Returns:
        Shape (K, 3, 3), or (K - 2, 3, 3) without a middle.
    """
    r = np.asarray(ring, np.float64)
    if middle is None:
        return np.stack([np.broadcast_to(r[0], r[2:].shape), r[1:-1], r[2:]], axis=1)
    return np.stack([np.tile(middle, (len(r), 1)), r, np.roll(r, -1, axis=0)], axis=1)


def box_panels(
    low: Sequence[float],  # Smallest x, y and z
    high: Sequence[float],  # Largest x, y and z
    taper: float = 0.0,  # Distance by which the top is inset on all four sides
) -> Points:
    """Return the faces of a box between two corners, shape (6, 4, 3)."""
    (x0, y0, z0), (x1, y1, z1), t = low, high, taper
    bottom = np.array([(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)])
    top = np.array(
        [(x0 + t, y0 + t, z1), (x1 - t, y0 + t, z1), (x1 - t, y1 - t, z1), (x0 + t, y1 - t, z1)]
    )
    return np.concatenate([[bottom[::-1]], [top], cells(closed([bottom, top]))])


def mirrored(triangles: ArrayLike) -> Points:
    """Return triangles mirrored left to right, still counter-clockwise, shape (T, 3, 3)."""
    return np.asarray(triangles, np.float64)[:, ::-1] * [1.0, -1.0, 1.0]
