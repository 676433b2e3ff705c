"""Meshes packed one after the other, many at once."""

import hashlib
from collections import defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.render.kernels.visibility.clusters import CLUSTER, LEAVES, UV_ROWS
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

_NONE = Material()  # Of meshes that are not seen, where no other is


class Pool:
    """All triangles, one mesh after the other.

    Attributes:
        palette: Their materials, and the index of each.
    """

    def __init__(self) -> None:
        self.palette: dict[Material, int] = {}
        self._packed = defaultdict[str, list[NDArray[Any]]](list)
        self._places = np.zeros(3, np.int32)  # Of triangles, twice, and of bounds until now
        self._leafy = 0  # Clusters with leaves until now
        self._waiting: list[tuple[Mesh, NDArray[np.int32], NDArray[np.float32]]] = []
        self._triangles = 0  # Of those that wait
        self._last = tuple[Material, ...](), np.zeros(0, np.int32)
        self._numbers: list[int] = []  # Number of each mesh that was added among those kept
        self._known: dict[bytes, int] = {}  # The same of a mesh's content
        self._meshes = 0  # Number of those kept
        self.add(concatenate([]))  # so that there are arrays even without a mesh
        self._numbers.clear()

    def add(
        self,
        mesh: Mesh,
        objects: NDArray[np.int32] | None = None,
        sizes: NDArray[np.float32] | None = None,
    ) -> None:
        """Append a mesh, with the object and the `Geometry.size` of each triangle."""
        count = len(mesh.triangles)
        number = self._meshes
        if objects is None:  # the same wheel or lamp in several things takes its place once
            number = self._known.setdefault(_digest(mesh), number)
        self._numbers.append(number)
        if number < self._meshes:
            return
        self._meshes += 1
        objects = np.full(count, -1, np.int32) if objects is None else objects
        sizes = np.full(count, np.inf, np.float32) if sizes is None else sizes
        self._waiting.append((mesh, objects, sizes))
        self._triangles += count
        if self._triangles >= _AT_ONCE:
            self._pack()

    def packed(self) -> dict[str, NDArray[Any]]:
        """Return the arrays of all meshes by their names in `Geometry`, and besides `slopes`, from
        `gradients`, and `ranges`: of each mesh as in `Geometry.mesh_range`, shape (M, 3).

        What fills clusters up has the first material. Only once: the parts are let go of.
        """
        if self._waiting:
            self._pack()
        made = {name: np.concatenate(self._packed.pop(name)) for name in [*self._packed]}
        nothing = np.zeros((1, UV_ROWS, CLUSTER), np.float32)
        made["corner_uv"] = np.concatenate([nothing, made["corner_uv"]])
        return made | {"ranges": made["ranges"][self._numbers]}

    def _pack(self) -> None:
        """Pack the meshes that wait."""
        waiting, self._waiting, self._triangles = self._waiting, [], 0
        meshes = [mesh for mesh, _, _ in waiting]
        whose = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
        corners = np.concatenate([mesh.positions[mesh.triangles] for mesh in meshes])
        keep = np.flatnonzero(solid_triangles(corners))
        # The level of detail of what is too small to be seen is empty.
        counts = np.bincount(whose[keep], minlength=len(meshes))
        material = np.concatenate(
            [
                self._looked_up(mesh)[mesh.materials] if some else mesh.materials * 0  # unseen
                for mesh, some in zip(meshes, counts.tolist(), strict=True)
            ]
        )
        leafy = np.array([one.surface == Surface.FOLIAGE for one in (*self.palette, _NONE)])[
            material
        ]
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
        corner_uv = by_clusters(_filled(uvs.reshape(-1, UV_ROWS)[source], own))
        leaves = (clusters[:, LEAVES] >= 0.0).any(axis=1)
        made = {
            "cluster": clusters,
            "bounds": bounds,
            "corner_uv": corner_uv[leaves],
            "uv_row": np.where(leaves, np.cumsum(leaves) + self._leafy, 0).astype(np.int32),
            "slopes": _filled(slopes[source], own),
            "material": _filled(material[keep][source], own),
            "object_id": _filled(objects[source], own),
            "ranges": (self._places + ranges).astype(np.int32),
        }
        for name, array in made.items():
            self._packed[name].append(array)
        self._places += np.array([len(source), len(source), len(bounds)], np.int32)
        self._leafy += int(leaves.sum())

    def _looked_up(self, mesh: Mesh) -> NDArray[np.int32]:
        """Return the index of each material of a mesh in the palette."""
        if self._last[0] is not mesh.palette:  # all chunks have the same
            index = [self.palette.setdefault(m, len(self.palette)) for m in mesh.palette]
            self._last = mesh.palette, np.array(index, np.int32)
        return self._last[1]


def _digest(mesh: Mesh) -> bytes:
    """Return a number for the content of a mesh."""
    whole = hashlib.sha1(repr(mesh.palette).encode(), usedforsecurity=False)
    for array in (mesh.positions, mesh.normals, mesh.uvs, mesh.triangles, mesh.materials):
        whole.update(np.ascontiguousarray(array).view(np.uint8).data)
    return whole.digest()


def _filled(rows: NDArray[Any], own: NDArray[np.bool_]) -> NDArray[Any]:
    """Return rows with zeros where nothing is a mesh's own."""
    rows[~own] = 0
    return rows
