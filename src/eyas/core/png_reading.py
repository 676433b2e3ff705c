"""Grey PNG files that `eyas.core.png` has written, read in half the time of Pillow: masks are empty
for the most part, and where bytes are 0 the filter need not be undone.
"""

import struct
import zlib
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.png import PAETH
from eyas.lanes import compiled

__all__ = ["grey_pixels"]

i4 = np.int32  # kernels would make unsigned numbers of bytes

_HEAD = struct.Struct(">8s4x4sIIBBBBB4xI4s")
"""Signature, header, and the beginning of the data."""


class _Rows(NamedTuple):
    """Rows that are filtered, and what they were."""

    filtered: NDArray[np.uint8]
    """Shape (H, bytes of a row)."""
    first: NDArray[np.int64]
    """A byte of each row before which all are 0; its length if all are; shape (H,)."""
    last: NDArray[np.int64]
    """One after which all are 0; -1 if all are; shape (H,)."""
    step: NDArray[np.int64]
    """Bytes of a pixel, shape (1,)."""
    raw: NDArray[np.uint8]
    """All 0 at first, shape (H, bytes of a row)."""


def grey_pixels(content: bytes) -> NDArray[np.uint8] | NDArray[np.uint16] | None:
    """Return the numbers of a picture, shape (H, W); None if the file is not one of `png_bytes` of
    8 or 16 bits without colours.
    """
    if len(content) < _HEAD.size:
        return None
    magic, name, width, height, bits, *kind, length, data = _HEAD.unpack_from(content)
    ours = (magic, name, data) == (b"\x89PNG\r\n\x1a\n", b"IHDR", b"IDAT")
    if not ours or any(kind) or bits not in (8, 16):
        return None
    step = bits // 8
    packed = content[_HEAD.size : _HEAD.size + length]
    try:
        stream = zlib.decompress(packed, bufsize=height * (1 + step * width))
    except zlib.error:
        return None
    if len(stream) != height * (1 + step * width):
        return None
    lines = np.frombuffer(stream, np.uint8).reshape(height, -1)
    if (lines[:, 0] != PAETH).any():
        return None
    raw = np.zeros((height, step * width), np.uint8)
    _unfilter(_rows_of(np.ascontiguousarray(lines[:, 1:]), raw, step))
    return raw.view(f">u{step}").astype(f"u{step}")


def _rows_of(filtered: NDArray[np.uint8], raw: NDArray[np.uint8], step: int) -> _Rows:
    length = filtered.shape[1]
    together = 8 if length % 8 == 0 else 1  # bytes that are looked at at once
    some = filtered.view(f"u{together}") != 0
    empty = ~some.any(axis=1)
    first = np.where(empty, length, together * some.argmax(axis=1))
    last = np.where(empty, -1, length - 1 - together * some[:, ::-1].argmax(axis=1))
    return _Rows(filtered, first, last, np.array([step]), raw)


@compiled
def _unfilter(rows: _Rows) -> None:
    """Write `_Rows.raw`: each byte and the neighbour that the filter has taken from it.

    A row is 0 before the first byte that is not 0 in it or above it; after the last one it goes on
    as the pixel to its left.
    """
    step, length = rows.step[0], rows.filtered.shape[1]
    above_first, above_last = length, i4(-1)
    for line in range(rows.filtered.shape[0]):
        filtered, raw = rows.filtered[line], rows.raw[line]
        start = min(rows.first[line], above_first)
        end = max(rows.last[line], above_last) + step
        above = rows.raw[max(line - 1, 0)]
        above_first, above_last = length, i4(-1)
        k = start
        while k < length:
            left = i4(raw[k - step]) if k >= step else i4(0)
            up = i4(above[k]) if line > 0 else i4(0)
            corner = i4(above[k - step]) if line > 0 and k >= step else i4(0)
            if k > end and left == 0 and raw[k - 1] == 0:
                break
            from_left, from_up = abs(up - corner), abs(left - corner)
            from_corner = abs(left + up - 2 * corner)
            nearest = up if from_up <= from_corner else corner
            if from_left <= from_up and from_left <= from_corner:
                nearest = left
            value = (i4(filtered[k]) + nearest) & 255
            raw[k] = value
            if value != 0:
                above_first = min(above_first, k)
                above_last = k
            k += 1
