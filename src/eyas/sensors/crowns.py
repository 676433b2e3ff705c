"""The solid shape of a tree's crown: a stack of upright cylinders that follows what is drawn."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.state.mesh import Mesh, Surface

__all__ = ["crown_slices", "leaves_of"]

Row = NDArray[np.float64]

_SLICES = 5
"""Cylinders in the stack."""

_SHARE = 0.85
"""Radius of a cylinder over that of the leaves at its height: the outermost stand alone."""

_CUTS = 4
"""Parts into which each edge of a triangle is cut to find points on it."""


def crown_slices(mesh: Mesh, low: Row, high: Row) -> list[tuple[float, float, float]]:
    """Return bottom, top and radius of the cylinders of a crown, in the mesh's frame [m].

    Args:
        mesh: The tree, or a stand of trees.
        low: Lowest x, y, z of its leaves [m], shape (3,).
        high: Highest x, y, z of its leaves [m], shape (3,).
    """
    middle = 0.5 * (low + high)[:2]
    most = 0.25 * float((high - low)[:2].sum())  # the corners of a square stand are further away
    points = _points_on(mesh)
    away = np.linalg.norm(points[:, :2] - middle, axis=1)
    ends = np.linspace(low[2], high[2], _SLICES + 1)
    slices = []
    for bottom, top in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        inside = (points[:, 2] >= bottom) & (points[:, 2] <= top)
        if inside.any():
            slices.append((bottom, top, _SHARE * min(float(away[inside].max()), most)))
    return slices


def leaves_of(mesh: Mesh) -> NDArray[np.bool_]:
    """Return which triangles are leaves; all if none is."""
    foliage = [m.surface in (Surface.FOLIAGE, Surface.CROWN) for m in mesh.palette]
    chosen = np.array(foliage, np.bool_)[mesh.materials]
    return chosen if chosen.any() else np.ones_like(chosen)


def _points_on(mesh: Mesh) -> NDArray[np.float64]:
    """Return points all over the leaves of a mesh, shape (K, 3)."""
    corners = mesh.positions[mesh.triangles[leaves_of(mesh)]].astype(np.float64)
    share = np.array(
        [(a, b, _CUTS - a - b) for a in range(_CUTS + 1) for b in range(_CUTS + 1 - a)]
    )
    points: NDArray[np.float64] = exact.product(share / _CUTS, corners).reshape(-1, 3)
    return points
