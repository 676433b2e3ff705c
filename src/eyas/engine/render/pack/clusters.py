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


def slots_of(counts: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return which row each place of whole clusters holds, and whether it is one of its own.

    Rows lie one mesh after the other, so many of each; what fills a mesh's last cluster up holds
    the mesh's last row once more.
    """
    places = counts + -counts % CLUSTER
    mesh = np.repeat(np.arange(len(counts)), places)
    rank = np.arange(len(mesh)) - (np.cumsum(places) - places)[mesh]
    last = counts[mesh] - 1
    return (np.cumsum(counts) - counts)[mesh] + np.minimum(rank, last), rank <= last


def ends_of(corners: NDArray[Number]) -> tuple[NDArray[Number], NDArray[Number]]:
    """Return the least and the largest coordinates of triangles, shape (T, 3) each."""
    a, b, c = np.moveaxis(corners, 1, 0)  # numpy's own take ten times as long for so few
    return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)


def cluster_order(
    corners: NDArray[np.float32],  # [m], shape (T, 3, 3)
    sizes: NDArray[np.float32],  # See `SIZE`, shape (T,)
    leafy: NDArray[np.bool_],  # Whether they are leaves, shape (T,)
    mesh: NDArray[np.intp],  # Numbers of their meshes, never falling, shape (T,)
) -> NDArray[np.intp]:
    """Return an order in which each eight triangles of a mesh lie together and face alike.

    Leaves come last in each mesh, in the order in which they are given.
    """
    solid = np.flatnonzero(~leafy)
    points = corners[solid].astype(np.float64)
    normals = exact.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= exact.lengths(normals)[:, None]
    least, most = ends_of(points)
    first = np.flatnonzero(np.diff(mesh[solid], prepend=-1))
    small = np.where(np.isfinite(sizes[solid]), exact.log2(np.maximum(sizes[solid], 1e-3)), 8.0)
    found = solid
    if len(solid):
        span = np.maximum.reduceat(most, first) - np.minimum.reduceat(least, first)
        count = np.diff(first, append=len(solid))
        reach = np.repeat(np.maximum(span.max(axis=1), 1e-6), count)[:, None]
        places = [(least + most) / 2 / reach, TURN * normals, 0.1 * small[:, None]]
        found = solid[_together(np.concatenate(places, axis=1), first, count)]
    order = np.concatenate([found, np.flatnonzero(leafy)])
    return order[np.argsort(mesh[order], kind="stable")]


def _together(
    places: NDArray[np.float64],  # Shape (T, n)
    first: NDArray[np.intp],  # Of each mesh
    count: NDArray[np.intp],  # The same, at least 1
) -> NDArray[np.intp]:
    """Return an order of places: each mesh cut in two across its longest side, again and again.

    All parts of all meshes are cut at once. What is sorted are whole numbers: of the part, of the
    place along its longest side, equal ones of which count as one, and of the order until then.
    """
    bits = len(places).bit_length()
    assert 3 * bits - 3 < 63, f"{len(places)} triangles in a mesh"  # of parts are an eighth as many
    rank = np.empty(places.T.shape, np.int64)
    for along, side in zip(rank, places.T, strict=True):
        sort = np.argsort(side, kind="stable")
        along[sort] = np.cumsum(np.diff(side[sort], prepend=-np.inf) != 0.0) - 1
    order = np.arange(len(places))
    while (large := count > CLUSTER).any():
        first, count = first[large], count[large]
        start = np.cumsum(count) - count
        part = np.repeat(np.arange(len(count)), count)
        at = np.arange(len(part)) + (first - start)[part]
        who = order[at]
        sides = places[who]
        longest = np.argmax(
            np.maximum.reduceat(sides, start) - np.minimum.reduceat(sides, start), axis=1
        )
        key = (((part << bits) | rank[longest[part], who]) << bits) | np.arange(len(part))
        order[at] = who[np.sort(key) & ((1 << bits) - 1)]
        half = CLUSTER * ((count // CLUSTER + 1) // 2)
        first = np.concatenate([first, first + half])
        count = np.concatenate([half, count - half])
    return order


def by_clusters(rows: NDArray[Number]) -> NDArray[Number]:
    """Return rows of whole clusters, shape (T, n), as columns, shape (T / 8, n, 8)."""
    return np.ascontiguousarray(rows.reshape(-1, CLUSTER, rows.shape[1]).swapaxes(1, 2))


def clusters_of(
    corners: NDArray[np.float32],  # [m], shape (T, 3, 3)
    sizes: NDArray[np.float32],  # Row `SIZE`, shape (T,)
    tiles: NDArray[np.float32],  # Row `LEAVES`, shape (T,)
    counts: NDArray[np.intp],  # Number of triangles of each mesh, which sum up to T
) -> NDArray[np.float32]:
    """Return clusters of the triangles of meshes in their order, see `Geometry.cluster`."""
    source, own = slots_of(counts)
    rows = np.empty((len(source), CLUSTER_ROWS), np.float32)
    rows[:, :SIZE] = np.where(own[:, None, None], corners[source], corners[source, :1]).reshape(
        -1, SIZE
    )
    rows[:, SIZE] = np.where(own, sizes[source], -1.0)
    rows[:, LEAVES] = np.where(own, tiles[source], -1.0)
    return by_clusters(rows)


def corners_of(clusters: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the corners of all triangles [m], and of what fills clusters up, shape (T, 3, 3)."""
    return clusters[:, :9].swapaxes(1, 2).reshape(-1, 3, 3)


def bounds_of(
    clusters: NDArray[np.float32],
    counts: NDArray[np.intp],  # Number of clusters of each mesh
) -> NDArray[np.float32]:
    """Return the bounds of the clusters of meshes, see `Geometry.bounds`."""
    placed = clusters[:, :9].reshape(-1, 3, 3, CLUSTER)
    corners = placed.transpose(0, 3, 1, 2).astype(np.float64)
    bounds = np.zeros((len(clusters), BOUNDS_ROWS), np.float32)
    bounds[:, 0:3], bounds[:, 3:6] = placed.min(axis=1).min(axis=2), placed.max(axis=1).max(axis=2)
    bounds[:, APEX : CUT_OFF + 1] = _cones(corners, clusters)
    bounds[:, LARGEST] = clusters[:, SIZE].max(axis=1)
    source, own = slots_of(counts)
    nothing = np.zeros(BOUNDS_ROWS, np.float32)
    nothing[0:3], nothing[3:6] = NOWHERE, -NOWHERE
    return by_clusters(np.where(own[:, None], bounds[source], nothing))


def _cones(corners: NDArray[np.float64], clusters: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return apex, axis and cut-off of cones from which all triangles are seen from behind.

    All normals are within an angle of the axis; the apex lies behind the planes of all triangles;
    the cone opens away from them, by a right angle less that angle (Z. Hajdu, meshoptimizer, 2017).
    """
    normals = exact.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    length = exact.lengths(normals)[:, :, None]
    real = (clusters[:, SIZE] >= 0.0) & (length[:, :, 0] > 0.0)
    normals = np.where(real[:, :, None], normals / np.where(length > 0.0, length, 1.0), 0.0)
    axis = normals.sum(axis=1)
    axis /= np.maximum(exact.lengths(axis), 1e-9)[:, None]
    cosine = np.where(real, exact.dot(normals, axis[:, None]), 1.0)
    middle = corners.reshape(len(corners), 3 * CLUSTER, 3).mean(axis=1)
    height = exact.dot(middle[:, None] - corners[:, :, 0], normals)
    behind = np.where(real, height / np.maximum(cosine, 1e-9), 0.0).max(axis=1)
    narrow = (cosine.min(axis=1) > _WIDEST) & ~(clusters[:, LEAVES] >= 0.0).any(axis=1)
    cone = np.empty((len(corners), 7))
    cone[:, 0:3] = middle - behind[:, None] * axis
    cone[:, 3:6] = axis
    cone[:, 6] = np.sqrt(np.maximum(1.0 - np.square(cosine.min(axis=1)), 0.0)) + 1e-3
    cone[~narrow, :6], cone[~narrow, 6] = 0.0, NO_CONE
    return cone
