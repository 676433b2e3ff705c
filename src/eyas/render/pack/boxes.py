"""Boxes around what is drawn, by which it is culled. Lengths in metres, types of the kernels."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.render.kernels.bundles import GROUP
from eyas.render.pack.clusters import NOWHERE

__all__ = ["box_of", "columns_of", "group_boxes", "posed_boxes", "sphere_of"]


def box_of(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the least and the largest coordinates of points, shape (6,); 0 if there are none."""
    if len(positions) == 0:
        return np.zeros(6, np.float32)
    return np.concatenate([positions.min(axis=0), positions.max(axis=0)])


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
