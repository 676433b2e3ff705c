"""Reading of `.npz` files that may come from anyone: sizes are limited, nothing is unpickled."""

import io
import math
import zipfile

import numpy as np
from numpy.typing import NDArray

__all__ = ["read_npz"]

_MEMBERS = 64
"""Largest number of arrays."""


def read_npz(data: bytes, largest: int) -> dict[str, NDArray[np.generic]]:
    """Return the arrays of a file, read-only.

    `numpy.load` makes arrays of the size that their headers claim before it reads them, and
    decompresses whatever there is. Here every size is known and checked first.

    Args:
        data: Content of the file.
        largest: Largest number of bytes of all arrays together.

    Raises:
        ValueError: The file is damaged or too large, or has other content than arrays of numbers or
            text.
        Exception: Other kinds, which `zipfile` and `zlib` raise for damaged bytes.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        size = sum(member.file_size for member in members)
        if len(members) > _MEMBERS or size > largest:
            raise ValueError(f"{len(members)} arrays of {size} bytes; allowed: {largest} bytes")
        return {
            member.filename.removesuffix(".npy"): _array(_content(archive, member))
            for member in members
        }


def _content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    with archive.open(member) as file:
        content = file.read(member.file_size + 1)  # never more, whatever there is
    if len(content) != member.file_size:
        raise ValueError(f"{member.filename}: cut off")
    return content


def _array(content: bytes) -> NDArray[np.generic]:
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):
        raise ValueError(f"npy version {version}; allowed: 1.0")
    shape, by_columns, dtype = np.lib.format.read_array_header_1_0(stream)
    rest = memoryview(content)[stream.tell() :]
    if dtype.kind not in "biufU" or math.prod(shape) * dtype.itemsize != len(rest):
        raise ValueError(f"an array of {dtype}, shape {shape}, in {len(rest)} bytes")
    flat = np.frombuffer(rest, dtype)
    return flat.reshape(shape, order="F" if by_columns else "C")
