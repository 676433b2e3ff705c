"""Meshes packed one after the other, many at once."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.visibility.clusters import (
    BOUNDS_ROWS,
    CLUSTER,
    CLUSTER_ROWS,
    UV_ROWS,
)
from eyas.engine.render.pack.clusters import (
    bounds_of,
    by_clusters,
    cluster_order,
    clusters_of,
    slots_of,
)
from eyas.engine.render.pack.triangles import gradients, solid_triangles
from eyas.engine.state.mesh import Material, Mesh, Surface

_AT_ONCE = 16_384
"""Triangles that are packed together: many, as most meshes are tiny; not all, as that takes memory.
"""

_Palette = tuple[tuple[Material, ...], NDArray[np.int32], NDArray[np.bool_]]
"""Materials, their indices in the palette of the pool, and whether they are of leaves."""


class PackedMeshes(NamedTuple):
    """Triangles of several meshes; for most arrays see the fields of `Geometry`."""

    clusters: NDArray[np.float32]
    bounds: NDArray[np.float32]
    corner_uvs: NDArray[np.float32]
    slopes: NDArray[np.float32]  # From `gradients`
    material: NDArray[np.int32]
    """Of each triangle, an index into the palette; 0 of what fills clusters up."""
    objects: NDArray[np.int32]
    ranges: NDArray[np.int32]  # Of each mesh as in `Geometry.mesh_range`, shape (M, 3).
    palette: tuple[Material, ...]


class Pool:
    """All triangles, one mesh after the other, with one palette."""

    def __init__(self) -> None:
        self._palette: dict[Material, int] = {}
        self._packed: dict[str, list[NDArray[Any]]] = {
            "clusters": [np.zeros((0, CLUSTER_ROWS, CLUSTER), np.float32)],
            "bounds": [np.zeros((0, BOUNDS_ROWS, CLUSTER), np.float32)],
            "corner_uvs": [np.zeros((0, UV_ROWS, CLUSTER), np.float32)],
            "slopes": [np.zeros((0, 24), np.float32)],
            "material": [np.zeros(0, np.int32)],
            "objects": [np.zeros(0, np.int32)],
            "ranges": [np.zeros((0, 3), np.int32)],
        }
        self._places = np.zeros(3, np.int32)  # Of triangles, twice, and of bounds until now
        self._waiting: list[tuple[Mesh, NDArray[np.int32], NDArray[np.float32]]] = []
        self._triangles = 0  # Of those that wait
        self._last: _Palette = ((), np.zeros(0, np.int32), np.zeros(0, np.bool_))

    def add(
        self,
        mesh: Mesh,
        objects: NDArray[np.int32] | None = None,
        sizes: NDArray[np.float32] | None = None,
    ) -> None:
        """Append a mesh, with the object and the `Geometry.size` of each triangle."""
        count = len(mesh.triangles)
        objects = np.full(count, -1, np.int32) if objects is None else objects
        sizes = np.full(count, np.inf, np.float32) if sizes is None else sizes
        self._waiting.append((mesh, objects, sizes))
        self._triangles += count
        if self._triangles >= _AT_ONCE:
            self._pack()

    def packed(self) -> PackedMeshes:
        """Return all meshes; once, as their parts are let go of one by one."""
        self._pack()
        names = list(self._packed)
        whole = {name: np.concatenate(self._packed.pop(name)) for name in names}
        return PackedMeshes(**whole, palette=tuple(self._palette))

    def _pack(self) -> None:
        """Pack the meshes that wait."""
        waiting, self._waiting, self._triangles = self._waiting, [], 0
        if not waiting:
            return
        meshes = [mesh for mesh, _, _ in waiting]
        whose = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
        corners = np.concatenate([mesh.positions[mesh.triangles] for mesh in meshes])
        keep = np.flatnonzero(solid_triangles(corners))
        # The level of detail of what is too small to be seen is empty.
        counts = np.bincount(whose[keep], minlength=len(meshes))
        looks = [self._looked_up(mesh, some) for mesh, some in zip(meshes, counts, strict=True)]
        lookup, leafy = (np.concatenate(each) for each in zip(*looks, strict=True))
        sizes = np.concatenate([size for _, _, size in waiting])
        keep = keep[cluster_order(corners[keep], sizes[keep], leafy[keep], whose[keep])]
        uvs = np.concatenate([mesh.uvs[mesh.triangles] for mesh in meshes])[keep]
        normals = np.concatenate([mesh.normals[mesh.triangles] for mesh in meshes])[keep]
        slopes = gradients(corners[keep], normals, uvs)
        tiles = np.where(leafy[keep], np.abs(slopes[:, 23]), np.float32(-1.0))
        clusters = clusters_of(corners[keep], sizes[keep], tiles, counts)
        clusters_each = -(-counts // CLUSTER)
        bounds = bounds_of(clusters, clusters_each)
        source, own = slots_of(counts)
        objects = np.concatenate([some for _, some, _ in waiting])[keep]
        first, row = (
            np.cumsum(each) - each for each in (clusters_each, -(-clusters_each // CLUSTER))
        )
        ranges = np.column_stack([CLUSTER * first, CLUSTER * first + counts, row])
        made = {
            "clusters": clusters,
            "bounds": bounds,
            "corner_uvs": by_clusters(_filled(uvs.reshape(-1, UV_ROWS)[source], own)),
            "slopes": _filled(slopes[source], own),
            "material": _filled(lookup[keep][source], own),
            "objects": _filled(objects[source], own),
            "ranges": (self._places + ranges).astype(np.int32),
        }
        for name, array in made.items():
            self._packed[name].append(array)
        self._places += np.array([len(source), len(source), len(bounds)], np.int32)

    def _looked_up(self, mesh: Mesh, count: int) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Return each triangle's index in the pool's palette, and whether it is of leaves.

        A mesh without triangles that are drawn adds nothing to the palette.
        """
        if count == 0:
            return np.zeros(len(mesh.triangles), np.int32), np.zeros(len(mesh.triangles), np.bool_)
        if self._last[0] is not mesh.palette:  # all chunks have the same
            index = [self._palette.setdefault(m, len(self._palette)) for m in mesh.palette]
            leafy = [material.surface == Surface.FOLIAGE for material in mesh.palette]
            self._last = mesh.palette, np.array(index, np.int32), np.array(leafy, np.bool_)
        _, lookup, leaves = self._last
        return lookup[mesh.materials], leaves[mesh.materials]


def _filled(rows: NDArray[Any], own: NDArray[np.bool_]) -> NDArray[Any]:
    """Return rows with zeros where nothing is a mesh's own."""
    rows[~own] = 0
    return rows
