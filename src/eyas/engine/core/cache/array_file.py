"""Files of arrays that are mapped into memory: processes that use the same file share its pages.

A file is a container (`eyas.lanes.container`) whose pieces are the arrays. Mapping one file with
hundreds of arrays takes a hundredth of the time of mapping one file for each array. Recordings are
`.npz` (`eyas.engine.traffic.recording_file`) instead: packed, and read by other programs too.
"""

import mmap
import os
import stat
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.flat import Array, Json
from eyas.lanes.container import packed, unpacked
from eyas.lanes.trusted import open_at_once


class Content(NamedTuple):
    """Content of a file."""

    flat: Json  # Everything except the arrays
    arrays: list[Array]


def array_file(
    content: Content,  # What it holds
    name: str,  # The name that it gets; under another one, it is not read
) -> list[bytes | memoryview]:
    """Return the pieces of a file, in order."""
    table = [[array.dtype.str, array.shape] for array in content.arrays]
    return packed([name, table, content.flat], map(_bytes_of, content.arrays))


def map_arrays(path: Path, *, checked: bool = True) -> Content:
    """Return the content of a file. Writes into its arrays are visible only in this process.

    Unless it is `checked`, its checksum is not computed, for which every byte is read.

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
    # Kernels index these arrays without checking bounds, so not a single bit may be wrong.
    try:
        (name, table, flat), pieces = unpacked(whole.data, checked=checked)
        arrays = [
            np.ndarray(tuple(shape), _plain(kind), piece)
            for (kind, shape), piece in zip(table, pieces, strict=True)
        ]
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: not as Eyas writes it: {error}") from None
    if name != path.name:
        raise ValueError(f"{path}: in the place of another entry")
    let_go(whole)  # the checksum has read it to its end
    return Content(flat, arrays)


def let_go(array: NDArray[Any]) -> None:
    """Let go of the memory of an array that has just been mapped, and that nobody has written into.

    Its pages come back one by one when they are used, from the system's memory, and without their
    neighbours: of a map, or of the motion of 400 people, a process needs a part only.
    """
    owner: Any = array
    while isinstance(owner, np.ndarray | memoryview):
        owner = owner.base if isinstance(owner, np.ndarray) else owner.obj
    if isinstance(owner, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
        for advice in (mmap.MADV_DONTNEED, mmap.MADV_RANDOM):
            owner.madvise(advice)


def _plain(kind: str) -> np.dtype[Any]:
    """Return a type of elements without pointers, which a file could aim anywhere."""
    dtype = np.dtype(kind)
    if dtype.hasobject:
        raise TypeError(f"elements of type {kind}")
    return dtype


def _bytes_of(array: Array) -> memoryview:
    flat: NDArray[np.uint8] = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    return flat.data
