"""Outline of a part as two boxes, one on the other, which cast its shadow."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.state.mesh import Mesh

__all__ = ["silhouette"]

WAIST = 0.6
"""Upper end of the lower box, as a share of the height."""

CHEST = 0.75
"""Height above which the upper box is measured, as a share: cabins grow narrower upwards."""

_GRID = 6
"""Number of points along the edge of a triangle."""


def silhouette(mesh: Mesh) -> NDArray[np.float32]:
    """Return the two boxes of a mesh, see `Geometry.silhouette`, shape (7,)."""
    points, weight = _points(mesh)
    if len(points) == 0:
        return np.zeros(7, np.float32)
    z = points[:, 2]
    rise = (z - z.min()) / max(float(np.ptp(z)), 1e-9)
    low, high = rise <= WAIST, rise >= CHEST
    ends = [
        *_ends(points[high, 0], weight[high]),
        *_ends(points[high, 1], weight[high]),
        *_ends(points[low, 1], weight[low]),
    ]
    return np.array([z.min() + WAIST * np.ptp(z), *ends], np.float32)


def _points(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points spread over all triangles, and the area that each represents."""
    first, second = (a.ravel() for a in np.mgrid[: _GRID + 1, : _GRID + 1])
    inside = first + second <= _GRID
    share = np.stack([first, second, _GRID - first - second], axis=1)[inside] / _GRID
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    points = exact.product(share, corners).reshape(-1, 3)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    return points, np.repeat(area, len(share))


def _ends(positions: NDArray[np.float64], weight: NDArray[np.float64]) -> tuple[float, float]:
    """Return the ends of the box whose surface has the same spread as the positions.

    The standard deviation of a uniform range is half its length over the root of 3. That of a
    box's surface is larger; clipped to the outermost points, it gives the box itself. Mirrors and
    handlebars, of little area, have little effect.
    """
    if not weight.sum() > 0.0:
        return 0.0, 0.0
    middle = float(np.average(positions, weights=weight))
    half = float(np.sqrt(3.0 * np.average(np.square(positions - middle), weights=weight)))
    return max(float(positions.min()), middle - half), min(float(positions.max()), middle + half)
