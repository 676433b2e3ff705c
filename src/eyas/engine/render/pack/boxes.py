"""Boxes around what is drawn, by which it is culled, and the two that cast a part's shadow.

Lengths in metres, types of the kernels.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import GROUP
from eyas.engine.render.pack.clusters import NOWHERE
from eyas.engine.state.mesh import Mesh
from eyas.lanes import exact

WAIST = 0.6  # Upper end of the lower box, as a share of the height

CHEST = 0.75
"""Height above which the upper box is measured, as a share: cabins grow narrower upwards."""

_GRID = 6  # Number of points along the edge of a triangle


def box_of(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the least and the largest coordinates of points, shape (6,); 0 if there are none."""
    if len(positions) == 0:
        return np.zeros(6, np.float32)
    columns = np.ascontiguousarray(positions.T)  # several times as fast
    return np.concatenate([columns.min(axis=1), columns.max(axis=1)])


def sphere_of(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return centre and radius of a sphere around all points, shape (4,)."""
    box = box_of(positions)
    centre = (box[:3] + box[3:]) / 2
    radius = np.linalg.norm(positions - centre, axis=1).max(initial=0.0)
    return np.append(centre, np.float32(radius * 1.0001))


def posed_boxes(boxes: NDArray[np.float32], poses: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return boxes around boxes that were moved by poses, shape (F, 6)."""
    centre, half = (boxes[:, :3] + boxes[:, 3:]) / 2, (boxes[:, 3:] - boxes[:, :3]) / 2
    middle = exact.dot(poses[:, :, :3], centre[:, None]) + poses[:, :, 3]
    reach = exact.dot(np.abs(poses[:, :, :3]), half[:, None])
    return np.concatenate([middle - reach, middle + reach], axis=1)


def group_boxes(boxes: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the box around each `GROUP` boxes in a row."""
    starts = np.arange(0, len(boxes), GROUP)
    if len(starts) == 0:
        return np.zeros((0, 6), np.float32)
    low = np.minimum.reduceat(boxes[:, :3], starts, axis=0)
    high = np.maximum.reduceat(boxes[:, 3:], starts, axis=0)
    return np.ascontiguousarray(np.concatenate([low, high], axis=1), np.float32)


def columns_of(boxes: NDArray[np.float32], group: int) -> NDArray[np.float32]:
    """Return boxes as columns, filled up to a multiple of `group`, see `Geometry.chunk_box`."""
    columns = np.empty((6, len(boxes) + -len(boxes) % group), np.float32)
    columns[:3], columns[3:] = NOWHERE, -NOWHERE
    columns[:, : len(boxes)] = boxes.T
    return columns


def silhouette(mesh: Mesh) -> NDArray[np.float32]:
    """Return the two boxes of a mesh, see `Geometry.silhouette`, shape (7,)."""
    (x, y, z), weight = _points(mesh)
    if len(z) == 0:
        return np.zeros(7, np.float32)
    rise = (z - z.min()) / max(float(np.ptp(z)), 1e-9)
    low, high = rise <= WAIST, rise >= CHEST
    ends = [
        *_ends(x[high], weight[high]),
        *_ends(y[high], weight[high]),
        *_ends(y[low], weight[low]),
    ]
    return np.array([z.min() + WAIST * np.ptp(z), *ends], np.float32)


def _points(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return points spread over all triangles, shape (3, N), and the area that each represents."""
    first, second = (a.ravel() for a in np.mgrid[: _GRID + 1, : _GRID + 1])
    inside = first + second <= _GRID
    share = np.stack([first, second, _GRID - first - second], axis=1)[inside] / _GRID
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    points = exact.product(np.moveaxis(corners, 2, 0), share.T)
    across = exact.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = exact.lengths(across)
    return points.reshape(3, -1), np.repeat(area, len(share))


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
