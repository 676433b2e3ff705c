"""Meshes packed one after the other, wherever in a `Geometry` they come to lie."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.visibility.clusters import (
    BOUNDS_ROWS,
    CLUSTER,
    CLUSTER_ROWS,
    UV_ROWS,
)
from eyas.engine.render.pack.boxes import box_of, silhouette, sphere_of
from eyas.engine.render.pack.clusters import (
    bounds_of,
    by_clusters,
    cluster_order,
    clusters_of,
    filled_up,
)
from eyas.engine.render.pack.triangles import gradients, solid_triangles
from eyas.engine.state.mesh import Material, Mesh, Surface

_Palette = tuple[tuple[Material, ...], NDArray[np.int32], NDArray[np.bool_]]
"""Materials, their indices in the palette of the pool, and whether they are of leaves."""


@dataclass(frozen=True, slots=True)
class PackedMeshes:
    """Triangles of several meshes; for most arrays see the fields of `Geometry`."""

    clusters: NDArray[np.float32]
    bounds: NDArray[np.float32]
    corner_uvs: NDArray[np.float32]
    slopes: NDArray[np.float32]  # From `gradients`
    material: NDArray[np.int32]
    """Of each triangle, an index into the palette; -1 of what fills clusters up."""
    objects: NDArray[np.int32]
    ranges: NDArray[np.int32]  # Of each mesh as in `Geometry.mesh_range`, shape (M, 3).
    palette: tuple[Material, ...]


@dataclass(frozen=True, slots=True)
class Prototypes:
    """Meshes of which there are copies, with all their levels of detail."""

    meshes: PackedMeshes
    levels: NDArray[np.int32]  # Number of levels of each
    box: NDArray[np.float32]
    """Around all levels of each, shape (P, 6): what is culled must not stick out."""
    sphere: NDArray[np.float32]  # Shape (P, 4)
    silhouette: NDArray[np.float32]  # Of the finest level, shape (P, 7)


def packed_prototypes(prototypes: Iterable[tuple[Mesh, ...]]) -> Prototypes:
    """Pack meshes with their levels of detail."""
    all_levels = tuple(prototypes)
    pool = Pool()
    ranges = [pool.add(mesh, None) for levels in all_levels for mesh in levels]
    points = [np.concatenate([mesh.positions for mesh in levels]) for levels in all_levels]
    return Prototypes(
        meshes=pool.packed(ranges),
        levels=np.array([len(levels) for levels in all_levels], np.int32),
        box=np.array([box_of(each) for each in points], np.float32).reshape(-1, 6),
        sphere=np.array([sphere_of(each) for each in points], np.float32).reshape(-1, 4),
        silhouette=np.array([silhouette(m[0]) for m in all_levels], np.float32).reshape(-1, 7),
    )


def joined(packs: Iterable[PackedMeshes]) -> PackedMeshes:
    """Return packs one after the other, with one palette; what fills clusters up has its first."""
    every = tuple(packs)
    palette: dict[Material, int] = {}
    material, ranges, triangles, bounds = [], [], 0, 0
    for pack in every:
        index = [palette.setdefault(one, len(palette)) for one in pack.palette]
        material.append(np.array([*index, 0], np.int32)[pack.material])
        ranges.append(pack.ranges + np.array([triangles, triangles, bounds], np.int32))
        triangles += len(pack.material)
        bounds += len(pack.bounds)
    return PackedMeshes(
        clusters=np.concatenate([pack.clusters for pack in every]),
        bounds=np.concatenate([pack.bounds for pack in every]),
        corner_uvs=np.concatenate([pack.corner_uvs for pack in every]),
        slopes=np.concatenate([pack.slopes for pack in every]),
        material=np.concatenate(material),
        objects=np.concatenate([pack.objects for pack in every]),
        ranges=np.concatenate(ranges),
        palette=tuple(palette),
    )


class Pool:
    """All triangles, one mesh after the other, with one palette."""

    def __init__(self) -> None:
        self.palette: dict[Material, int] = {}
        self.clusters: list[NDArray[np.float32]] = []
        self.bounds: list[NDArray[np.float32]] = []
        self.corner_uvs: list[NDArray[np.float32]] = []
        self.gradients: list[NDArray[np.float32]] = []
        self.materials: list[NDArray[np.int32]] = []
        self.objects: list[NDArray[np.int32]] = []
        self._cluster_count = 0
        self._bounds_count = 0
        self._last: _Palette = ((), np.zeros(0, np.int32), np.zeros(0, np.bool_))

    def add(
        self,
        mesh: Mesh,
        objects: NDArray[np.int32] | None,
        sizes: NDArray[np.float32] | None = None,
    ) -> tuple[int, int, int]:
        """Append a mesh; return its ranges as in `Geometry.mesh_range`."""
        keep = np.flatnonzero(solid_triangles(mesh))
        if len(keep) == 0:  # the level of detail of what is too small to be seen
            first = CLUSTER * self._cluster_count
            return first, first, self._bounds_count
        lookup, leafy = self._looked_up(mesh.palette)
        size = np.full(len(keep), np.inf, np.float32) if sizes is None else sizes[keep]
        order = cluster_order(
            mesh.positions[mesh.triangles[keep]], size, leafy[mesh.materials[keep]]
        )
        keep, size = keep[order], size[order]
        triangles, material = mesh.triangles[keep], mesh.materials[keep]
        slopes = gradients(mesh.positions, mesh.normals, mesh.uvs, triangles)
        clusters = clusters_of(
            mesh.positions[triangles],
            size,
            np.where(leafy[material], np.abs(slopes[:, 23]), -1.0),
        )
        bounds = bounds_of(clusters)
        self.clusters.append(clusters)
        self.bounds.append(bounds)
        self.corner_uvs.append(by_clusters(mesh.uvs[triangles].reshape(-1, UV_ROWS)))
        self.gradients.append(filled_up(slopes))
        self.materials.append(filled_up(lookup[material] + 1) - 1)
        none = np.full(len(keep), -1, np.int32)
        self.objects.append(filled_up(none if objects is None else objects[keep]))
        first, row = CLUSTER * self._cluster_count, self._bounds_count
        self._cluster_count += len(clusters)
        self._bounds_count += len(bounds)
        return first, first + len(keep), row

    def _looked_up(
        self, palette: tuple[Material, ...]
    ) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Return the index in the pool's palette of each material, and whether it is of leaves."""
        if self._last[0] is not palette:  # all chunks have the same
            index = [self.palette.setdefault(m, len(self.palette)) for m in palette]
            leafy = [material.surface == Surface.FOLIAGE for material in palette]
            self._last = palette, np.array(index, np.int32), np.array(leafy, np.bool_)
        return self._last[1:]

    def packed(self, ranges: list[tuple[int, int, int]]) -> PackedMeshes:
        """Return all meshes, with what `add` has returned of each."""
        clusters = [np.zeros((0, CLUSTER_ROWS, CLUSTER), np.float32), *self.clusters]
        corner_uvs = [np.zeros((0, UV_ROWS, CLUSTER), np.float32), *self.corner_uvs]
        return PackedMeshes(
            clusters=np.concatenate(clusters),
            bounds=np.concatenate([np.zeros((0, BOUNDS_ROWS, CLUSTER), np.float32), *self.bounds]),
            corner_uvs=np.concatenate(corner_uvs),
            slopes=np.concatenate([np.zeros((0, 24), np.float32), *self.gradients]),
            material=np.concatenate([np.zeros(0, np.int32), *self.materials]),
            objects=np.concatenate([np.zeros(0, np.int32), *self.objects]),
            ranges=np.array(ranges, np.int32).reshape(-1, 3),
            palette=tuple(self.palette),
        )
