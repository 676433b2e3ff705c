"""Meshes packed one after the other, wherever in a `Geometry` they come to lie."""

import itertools
from collections.abc import Iterable, Sequence
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
    slots_of,
)
from eyas.engine.render.pack.triangles import gradients, solid_triangles
from eyas.engine.state.mesh import Material, Mesh, Surface

_AT_ONCE = 16_384
"""Triangles that are packed together: many, as most meshes are tiny; not all, as that takes memory.
"""

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
    for mesh in itertools.chain.from_iterable(all_levels):
        pool.add(mesh, None)
    points = [np.concatenate([mesh.positions for mesh in levels]) for levels in all_levels]
    return Prototypes(
        meshes=pool.packed(),
        levels=np.array([len(levels) for levels in all_levels], np.int32),
        box=np.array([box_of(each) for each in points], np.float32).reshape(-1, 6),
        sphere=np.array([sphere_of(each) for each in points], np.float32).reshape(-1, 4),
        silhouette=np.array([silhouette(m[0]) for m in all_levels], np.float32).reshape(-1, 7),
    )


def joined(packs: Iterable[PackedMeshes]) -> PackedMeshes:
    """Return packs one after the other, with one palette; what fills clusters up has its first."""
    every = tuple(packs)
    palette: dict[Material, int] = {}
    materials = []
    for pack in every:
        index = [palette.setdefault(one, len(palette)) for one in pack.palette]
        materials.append(np.array([*index, 0], np.int32)[pack.material])
    return _side_by_side(every, materials, tuple(palette))


def _side_by_side(
    packs: Sequence[PackedMeshes],
    materials: Sequence[NDArray[np.int32]],  # Of each pack, indices into one palette
    palette: tuple[Material, ...],
) -> PackedMeshes:
    """Return packs one after the other."""
    triangles, rows = (
        np.cumsum([0, *(len(getattr(pack, name)) for pack in packs)])
        for name in ("material", "bounds")
    )
    ranges = [
        pack.ranges + np.array([first, first, row], np.int32)
        for pack, first, row in zip(packs, triangles[:-1], rows[:-1], strict=True)
    ]
    return PackedMeshes(
        clusters=np.concatenate([_NONE.clusters, *(pack.clusters for pack in packs)]),
        bounds=np.concatenate([_NONE.bounds, *(pack.bounds for pack in packs)]),
        corner_uvs=np.concatenate([_NONE.corner_uvs, *(pack.corner_uvs for pack in packs)]),
        slopes=np.concatenate([_NONE.slopes, *(pack.slopes for pack in packs)]),
        material=np.concatenate([_NONE.material, *materials]),
        objects=np.concatenate([_NONE.objects, *(pack.objects for pack in packs)]),
        ranges=np.concatenate([_NONE.ranges, *ranges]),
        palette=palette,
    )


_NONE = PackedMeshes(
    clusters=np.zeros((0, CLUSTER_ROWS, CLUSTER), np.float32),
    bounds=np.zeros((0, BOUNDS_ROWS, CLUSTER), np.float32),
    corner_uvs=np.zeros((0, UV_ROWS, CLUSTER), np.float32),
    slopes=np.zeros((0, 24), np.float32),
    material=np.zeros(0, np.int32),
    objects=np.zeros(0, np.int32),
    ranges=np.zeros((0, 3), np.int32),
    palette=(),
)


class Pool:
    """All triangles, one mesh after the other, with one palette."""

    def __init__(self) -> None:
        self._palette: dict[Material, int] = {}
        self._packs: list[PackedMeshes] = []
        self._waiting: list[tuple[Mesh, NDArray[np.int32], NDArray[np.float32]]] = []
        self._triangles = 0  # Of those that wait
        self._last: _Palette = ((), np.zeros(0, np.int32), np.zeros(0, np.bool_))

    def add(
        self,
        mesh: Mesh,
        objects: NDArray[np.int32] | None,
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
        """Return all meshes."""
        self._pack()
        materials = [pack.material for pack in self._packs]
        return _side_by_side(self._packs, materials, tuple(self._palette))

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
        source, own = slots_of(counts)
        objects = np.concatenate([some for _, some, _ in waiting])[keep]
        first, row = (
            np.cumsum(each) - each for each in (clusters_each, -(-clusters_each // CLUSTER))
        )
        self._packs.append(
            PackedMeshes(
                clusters=clusters,
                bounds=bounds_of(clusters, clusters_each),
                corner_uvs=by_clusters(
                    np.where(own[:, None], uvs.reshape(-1, UV_ROWS)[source], np.float32(0.0))
                ),
                slopes=np.where(own[:, None], slopes[source], np.float32(0.0)),
                material=np.where(own, lookup[keep][source], np.int32(-1)),
                objects=np.where(own, objects[source], np.int32(0)),
                ranges=np.column_stack([CLUSTER * first, CLUSTER * first + counts, row]).astype(
                    np.int32
                ),
                palette=(),
            )
        )

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
