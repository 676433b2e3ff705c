"""Clusters of eight triangles, and the bounds by which they are culled."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.visibility.clusters import (
    APEX,
    BOUNDS_ROWS,
    CLUSTER,
    CLUSTER_ROWS,
    CUT_OFF,
    LARGEST,
    LEAVES,
    NO_CONE,
    SIZE,
)
from eyas.lanes import exact

NOWHERE = 1e9  # Boxes from this to minus this in all directions [m] are inside no plane

_WIDEST = 0.2  # Cosine of the largest angle between the axis of a cone and a normal


TURN = 0.5
"""How much triangles must be apart, as a share of their mesh, to count as much as normals at right
angles."""

Number = TypeVar("Number", bound=np.generic)


def filled_up(values: NDArray[Number]) -> NDArray[Number]:
    """Return rows filled up with zeros to whole clusters."""
    missing = -len(values) % CLUSTER
    return np.concatenate([values, np.zeros((missing, *values.shape[1:]), values.dtype)])


def cluster_order(
    corners: NDArray[np.float32],  # [m], shape (T, 3, 3)
    sizes: NDArray[np.float32],  # See `SIZE`, shape (T,)
    leafy: NDArray[np.bool_],  # Whether they are leaves, shape (T,)
) -> NDArray[np.intp]:
    """Return an order in which each eight triangles in a row lie together and face alike.

    Leaves come last, in the order in which they are given.
    """
    solid = np.flatnonzero(~leafy)
    points = corners[solid].astype(np.float64)
    normals = exact.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    middle = (points.min(axis=1) + points.max(axis=1)) / 2
    reach = max(float(np.ptp(points.reshape(-1, 3), axis=0).max()) if len(points) else 0.0, 1e-6)
    small = np.where(np.isfinite(sizes[solid]), exact.log2(np.maximum(sizes[solid], 1e-3)), 8.0)
    places = np.concatenate([middle / reach, TURN * normals, 0.1 * small[:, None]], axis=1)
    return np.concatenate([solid[_together(places)], np.flatnonzero(leafy)])


def _together(places: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return an order of places: cut in two across their longest side, again and again."""
    done, left = [], [np.arange(len(places))]
    while left:
        part = left.pop()
        if len(part) <= CLUSTER:
            done.append(part)
            continue
        side = places[part]
        axis = int(np.argmax(np.ptp(side, axis=0)))
        half = CLUSTER * ((len(part) // CLUSTER + 1) // 2)
        order = np.argsort(side[:, axis], kind="stable")
        left += [part[order[half:]], part[order[:half]]]
    return np.concatenate([np.zeros(0, np.intp), *done])


def by_clusters(values: NDArray[Number]) -> NDArray[Number]:
    """Return rows of triangles, shape (T, n), as columns of clusters, shape (T / 8, n, 8)."""
    rows = filled_up(values)
    return np.ascontiguousarray(rows.reshape(-1, CLUSTER, rows.shape[1]).swapaxes(1, 2))


def clusters_of(
    corners: NDArray[np.float32],  # [m], shape (T, 3, 3)
    sizes: NDArray[np.float32],  # Row `SIZE`, shape (T,)
    tiles: NDArray[np.float32],  # Row `LEAVES`, shape (T,)
) -> NDArray[np.float32]:
    """Return clusters of T triangles in their order, see `Geometry.cluster`."""
    missing = -len(corners) % CLUSTER
    rows = np.empty((len(corners) + missing, CLUSTER_ROWS), np.float32)
    rows[: len(corners), :SIZE] = corners.reshape(-1, 9)
    rows[len(corners) :, :SIZE] = np.tile(corners[-1:, 0], (missing, 3))
    rows[:, SIZE], rows[:, LEAVES] = -1.0, -1.0
    rows[: len(corners), SIZE], rows[: len(corners), LEAVES] = sizes, tiles
    return by_clusters(rows)


def corners_of(clusters: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the corners of all triangles [m], and of what fills clusters up, shape (T, 3, 3)."""
    return clusters[:, :9].swapaxes(1, 2).reshape(-1, 3, 3)


def bounds_of(clusters: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the bounds of the clusters of a mesh, see `Geometry.bounds`."""
    corners = clusters[:, :9].reshape(-1, 3, 3, CLUSTER).transpose(0, 3, 1, 2).astype(np.float64)
    points = corners.reshape(len(clusters), -1, 3)
    bounds = np.zeros((len(clusters), BOUNDS_ROWS), np.float32)
    bounds[:, 0:3], bounds[:, 3:6] = points.min(axis=1), points.max(axis=1)
    bounds[:, APEX : CUT_OFF + 1] = _cones(corners, clusters)
    bounds[:, LARGEST] = clusters[:, SIZE].max(axis=1)
    missing = -len(bounds) % CLUSTER
    nothing = np.zeros((missing, BOUNDS_ROWS), np.float32)
    nothing[:, 0:3], nothing[:, 3:6] = NOWHERE, -NOWHERE
    groups = np.concatenate([bounds, nothing]).reshape(-1, CLUSTER, BOUNDS_ROWS)
    return np.ascontiguousarray(groups.swapaxes(1, 2))


def _cones(corners: NDArray[np.float64], clusters: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return apex, axis and cut-off of cones from which all triangles are seen from behind.

    All normals are within an angle of the axis; the apex lies behind the planes of all triangles;
    the cone opens away from them, by a right angle less that angle (Z. Hajdu, meshoptimizer, 2017).
    """
    normals = exact.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    real = (clusters[:, SIZE] >= 0.0) & (length[:, :, 0] > 0.0)
    normals = np.where(real[:, :, None], normals / np.where(length > 0.0, length, 1.0), 0.0)
    axis = normals.sum(axis=1)
    axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-9)
    cosine = np.where(real, exact.dot(normals, axis[:, None]), 1.0)
    middle = corners.reshape(len(corners), -1, 3).mean(axis=1)
    height = exact.dot(middle[:, None] - corners[:, :, 0], normals)
    behind = np.where(real, height / np.maximum(cosine, 1e-9), 0.0).max(axis=1)
    narrow = (cosine.min(axis=1) > _WIDEST) & ~(clusters[:, LEAVES] >= 0.0).any(axis=1)
    cone = np.empty((len(corners), 7))
    cone[:, 0:3] = middle - behind[:, None] * axis
    cone[:, 3:6] = axis
    cone[:, 6] = np.sqrt(np.maximum(1.0 - np.square(cosine.min(axis=1)), 0.0)) + 1e-3
    cone[~narrow, :6], cone[~narrow, 6] = 0.0, NO_CONE
    return cone
