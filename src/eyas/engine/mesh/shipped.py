"""Shapes as they ship: files of packed arrays, made by `python -m art.ship`.

A file is a container (`eyas.lanes.container`): its header is an index, its pieces are blocks. A
block is a container too, compressed, and is unpacked when it is asked for.
"""

import json
import lzma
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.flat import restore
from eyas.engine.core.errors import DataFileError
from eyas.engine.state.mesh import Material, Mesh
from eyas.lanes.container import Contents, unpacked

Thing = TypeVar("Thing")


class Block(NamedTuple):
    """A block of a file."""

    number: int  # Its place among them
    digest: str  # Of its unpacked bytes, hexadecimal SHA-256


class Meshes(NamedTuple):
    """Meshes of parts, one after the other, the levels of a part from the finest on."""

    levels: NDArray[np.int32]  # Number of levels of each part
    vertices: NDArray[np.int32]  # Number of vertices of each mesh, and so on
    triangles: NDArray[np.int32]
    colours: NDArray[np.int32]
    positions: NDArray[np.float32]  # Of all meshes; this and those that follow as in `Mesh`
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    corners: NDArray[np.int32]
    materials: NDArray[np.int32]
    palettes: NDArray[np.int32]  # Indices into `palette`
    palette: tuple[Material, ...]

    def split(self) -> list[tuple[Mesh, ...]]:
        """Return the meshes of each part, the finest first."""
        at, face, colour = (
            np.concatenate([[0], np.cumsum(count)]).tolist()
            for count in (self.vertices, self.triangles, self.colours)
        )
        meshes = [
            Mesh(
                positions=self.positions[at[k] : at[k + 1]],
                normals=self.normals[at[k] : at[k + 1]],
                uvs=self.uvs[at[k] : at[k + 1]],
                triangles=self.corners[face[k] : face[k + 1]],
                materials=self.materials[face[k] : face[k + 1]],
                palette=tuple(self.palette[m] for m in self.palettes[colour[k] : colour[k + 1]]),
            )
            for k in range(len(self.vertices))
        ]
        ends = np.cumsum(self.levels).tolist()
        return [tuple(meshes[end - n : end]) for end, n in zip(ends, self.levels, strict=True)]


def index_of(file: Path, digest: str) -> Any:  # noqa: ANN401  # anything that JSON can tell
    """Return the index of a file, whose digest is known.

    Raises:
        DataFileError: The installation is damaged; so all that read these files.
    """
    index = _opened(file).header
    if digest_of(index) != digest:
        raise DataFileError(f"{file}: damaged; install Eyas again")
    return index


def digest_of(index: object) -> str:
    """Return the digest of an index, which has those of the blocks."""
    return sha256(json.dumps(index, sort_keys=True).encode()).hexdigest()


def read_block(file: Path, block: Block, of: type[Thing]) -> Thing:
    """Return what a block holds."""
    try:
        content = bytearray(lzma.decompress(_opened(file).pieces[block.number]))
        if sha256(content).hexdigest() != block.digest:
            raise ValueError("damaged")
        (table, flat), pieces = unpacked(memoryview(content))
        arrays = [
            np.ndarray(shape, kind, piece)
            for (kind, shape), piece in zip(table, pieces, strict=True)
        ]
        return restore(of, flat, arrays)
    except (ValueError, IndexError, EOFError, lzma.LZMAError) as error:
        raise DataFileError(f"{file}: cannot read: {error}; install Eyas again") from None


@lru_cache(maxsize=4)
def _opened(file: Path) -> Contents:
    try:
        return unpacked(file.read_bytes())
    except (OSError, ValueError) as error:
        raise DataFileError(f"{file}: cannot read: {error}; install Eyas again") from None
