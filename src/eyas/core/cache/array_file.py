"""Files of arrays that are mapped into memory: processes that use the same file share its pages.

A file is a `.npy` array of bytes, which hold: the CRC-32 of all bytes after it; the length of the
header; the header, in JSON; the arrays, each at a multiple of 64 bytes. Mapping one file with
hundreds of arrays takes a hundredth of the time of mapping one file for each array.
"""

import io
import json
import mmap
import os
import stat
import struct
import zlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.flat import Array, Json
from eyas.lanes.folder import open_at_once

__all__ = ["Content", "array_file", "let_go", "map_arrays"]

_ALIGNMENT = 64
_NUMBER = struct.Struct("<I")


class Content(NamedTuple):
    """Content of a file."""

    flat: Json
    """Everything except the arrays."""
    arrays: list[Array]


def array_file(content: Content, name: str) -> list[bytes | memoryview]:
    """Return the pieces of a file, in order.

    Args:
        content: What it holds.
        name: The name that it gets; under another one, it is not read.
    """
    table, size = [], 0
    for array in content.arrays:
        table.append([array.dtype.str, array.shape, size])
        size += array.nbytes + _padding(array.nbytes)
    header = json.dumps({"name": name, "arrays": table, "value": content.flat}).encode()
    header += b" " * _padding(2 * _NUMBER.size + len(header))
    pieces: list[bytes | memoryview] = [_NUMBER.pack(len(header)), header]
    for array in content.arrays:
        pieces += [_bytes_of(array), bytes(_padding(array.nbytes))]
    size += 2 * _NUMBER.size + len(header)
    return [_npy_header(size), _NUMBER.pack(_checksum(pieces)), *pieces]


def map_arrays(path: Path) -> Content:
    """Return the content of a file. Writes into its arrays are visible only in this process.

    Raises:
        OSError: The file does not exist or cannot be read.
        ValueError: The file is damaged, not a file of arrays, or was written under another name.
    """
    # Mapped copy-on-write: for numba, read-only arrays have a different type, and it would compile
    # all kernels again.
    with open(path, "rb", opener=open_at_once) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise ValueError(f"{path}: no ordinary file")
        whole = np.asarray(np.memmap(file, np.uint8, mode="c"))
    first = len(_npy_header(0))
    if bytes(whole[:first]) != _npy_header(len(whole) - first):
        raise ValueError(f"{path}: not a file of arrays, or cut off")
    body = whole[first:].data
    # Kernels index these arrays without checking bounds, so not a single bit may be wrong.
    if bytes(body[: _NUMBER.size]) != _NUMBER.pack(zlib.crc32(body[_NUMBER.size :])):
        raise ValueError(f"{path}: damaged")
    try:
        (length,) = _NUMBER.unpack_from(body, _NUMBER.size)
        data = 2 * _NUMBER.size + length
        header = json.loads(bytes(body[2 * _NUMBER.size : data]))
        arrays = [
            np.ndarray(tuple(shape), _plain(kind), body, data + offset)
            for kind, shape, offset in header["arrays"]
        ]
        name = header["name"]
    except (KeyError, TypeError, struct.error) as error:
        raise ValueError(f"{path}: not as Eyas writes it: {error}") from None
    if name != path.name:
        raise ValueError(f"{path}: in the place of another entry")
    return Content(header["value"], arrays)


def let_go(array: NDArray[Any]) -> None:
    """Let go of the memory of an array that has just been mapped, and that nobody has written into.

    Its pages come back one by one when they are used, from the system's memory. The checksum reads
    all of a file; of the motion of 400 people, for example, a process needs little.
    """
    owner: Any = array
    while isinstance(owner, np.ndarray | memoryview):
        owner = owner.base if isinstance(owner, np.ndarray) else owner.obj
    if isinstance(owner, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        owner.madvise(mmap.MADV_DONTNEED)


def _plain(kind: str) -> np.dtype[Any]:
    """Return a type of elements without pointers, which a file could aim anywhere."""
    dtype = np.dtype(kind)
    if dtype.hasobject:
        raise TypeError(f"elements of type {kind}")
    return dtype


def _npy_header(size: int) -> bytes:
    """Return the header of a `.npy` of `size` bytes; its length is the same for every size."""
    header = io.BytesIO()
    layout = {"descr": "|u1", "fortran_order": False, "shape": (size,)}
    np.lib.format.write_array_header_1_0(header, layout)
    return header.getvalue()


def _padding(size: int) -> int:
    return -size % _ALIGNMENT


def _bytes_of(array: Array) -> memoryview:
    flat: NDArray[np.uint8] = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    return flat.data


def _checksum(pieces: list[bytes | memoryview]) -> int:
    checksum = 0
    for piece in pieces:
        checksum = zlib.crc32(piece, checksum)
    return checksum
