"""Packs shapes as `eyas.engine.mesh.shipped` reads them."""

import lzma
from collections.abc import Iterable, Sequence
from hashlib import sha256

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.flat import flatten
from eyas.engine.mesh.shipped import Block, Meshes
from eyas.engine.state.mesh import Mesh
from eyas.engine.targets.shapes import Columns
from eyas.lanes.container import packed


class Packer:
    """Gathers the blocks of a file."""

    def __init__(self) -> None:
        self._blocks: list[bytes] = []

    def add(self, value: object) -> Block:
        """Add a block, and return where it is."""
        flat, arrays = flatten(value)
        kept = [np.ascontiguousarray(array) for array in arrays]
        table = [[array.dtype.str, array.shape] for array in kept]
        pieces = [array.reshape(-1).view(np.uint8).data for array in kept]
        content = b"".join(packed([table, flat], pieces))
        self._blocks.append(lzma.compress(content, preset=9))
        return Block(len(self._blocks) - 1, sha256(content).hexdigest())

    def file(self, index: object) -> bytes:
        """Return the content of the file."""
        return b"".join(packed(index, self._blocks))


def joined(parts: Sequence[Iterable[Mesh]]) -> Meshes:
    """Return the meshes of parts, the finest level of each first, one after the other."""
    levels = [tuple(part) for part in parts]
    meshes = [mesh for part in levels for mesh in part]
    palette = {one: k for k, one in enumerate({m: None for mesh in meshes for m in mesh.palette})}
    return Meshes(
        levels=np.array([len(part) for part in levels], np.int32),
        vertices=np.array([len(mesh.positions) for mesh in meshes], np.int32),
        triangles=np.array([len(mesh.triangles) for mesh in meshes], np.int32),
        colours=np.array([len(mesh.palette) for mesh in meshes], np.int32),
        positions=np.concatenate([mesh.positions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
        uvs=np.concatenate([mesh.uvs for mesh in meshes]),
        corners=np.concatenate([mesh.triangles for mesh in meshes]),
        materials=np.concatenate([mesh.materials for mesh in meshes]),
        palettes=np.array([palette[m] for mesh in meshes for m in mesh.palette], np.int32),
        palette=tuple(palette),
    )


def columns_of(records: NDArray[np.void]) -> Columns:
    """Return the fields of an array of records."""
    return {name: np.ascontiguousarray(records[name]) for name in records.dtype.names or ()}
