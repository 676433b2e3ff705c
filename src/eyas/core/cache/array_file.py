"""Files of arrays that are mapped into memory: processes that use the same file share its pages.

A file is a `.npy` of bytes, which hold: CRC-32 of all that follows; length of the header; the
header, JSON; the arrays, each at a multiple of 64 bytes. To map one file with hundreds of arrays
takes a hundredth of the time that a file for each array would.
"""

import io
import json
import struct
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.cache.flat import Array, Json

__all__ = ["Content", "array_file", "map_arrays"]

_ALIGNMENT = 64
_NUMBER = struct.Struct("<I")


class Content(NamedTuple):
    """What a file holds."""

    flat: Json
    """Everything but the arrays."""
    arrays: list[Array]


def array_file(content: Content) -> list[bytes | memoryview]:
    """Return the pieces of a file, one after the other."""
    table, size = [], 0
    for array in content.arrays:
        table.append([array.dtype.str, array.shape, size])
        size += array.nbytes + _padding(array.nbytes)
    header = json.dumps({"arrays": table, "value": content.flat}).encode()
    header += b" " * _padding(2 * _NUMBER.size + len(header))
    pieces: list[bytes | memoryview] = [_NUMBER.pack(len(header)), header]
    for array in content.arrays:
        pieces += [_bytes_of(array), bytes(_padding(array.nbytes))]
    size += 2 * _NUMBER.size + len(header)
    return [_npy_header(size), _NUMBER.pack(_checksum(pieces)), *pieces]


def map_arrays(path: Path) -> Content:
    """Return what a file holds. What is written into its arrays stays in this process.

    Raises:
        OSError: It is not there or cannot be read.
        ValueError: It is damaged or something else.
    """
    # Mapped to be copied when written to: read-only arrays are another type to numba, for which it
    # would compile all kernels again.
    whole = np.asarray(np.memmap(path, np.uint8, mode="c"))
    first = len(_npy_header(0))
    if bytes(whole[:first]) != _npy_header(len(whole) - first):
        raise ValueError(f"{path}: not a file of arrays, or cut off")
    body = whole[first:].data
    # Kernels read these arrays without a look at their bounds: not a bit may be wrong.
    if bytes(body[: _NUMBER.size]) != _NUMBER.pack(zlib.crc32(body[_NUMBER.size :])):
        raise ValueError(f"{path}: damaged")
    (length,) = _NUMBER.unpack_from(body, _NUMBER.size)
    data = 2 * _NUMBER.size + length
    header = json.loads(bytes(body[2 * _NUMBER.size : data]))
    arrays = [
        np.ndarray(tuple(shape), np.dtype(kind), body, data + offset)
        for kind, shape, offset in header["arrays"]
    ]
    return Content(header["value"], arrays)


def _npy_header(size: int) -> bytes:
    """Return what a `.npy` of so many bytes begins with; its own length does not depend on it."""
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
