"""Pictures in the PNG format, whose bytes are the same on every machine."""

import struct
import zlib
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.deflate import deflated
from eyas.lanes import compiled

i4 = np.int32  # kernels would make unsigned numbers of bytes

_GREY, _COLOURS = 0, 2  # PNG's types of colour
PAETH = 4  # Number of the filter that predicts a byte from those beside and above it


class _Rows(NamedTuple):
    """Rows of a picture, and what the filter makes of them."""

    raw: NDArray[np.uint8]  # Bytes, the highest of a number first, shape (H, bytes of a row)
    step: NDArray[np.int64]  # Bytes of a pixel, shape (1,)
    filtered: NDArray[np.uint8]  # Shape (H, 1 + bytes of a row)


def png_bytes(pixels: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """Return a picture as a PNG file, without loss.

    Args:
        pixels: Numbers of 8 or 16 bits, shape (H, W) or, of red, green and blue, (H, W, 3).
    """
    height, width = pixels.shape[:2]
    numbers = np.ascontiguousarray(pixels, f">u{pixels.dtype.itemsize}")
    rows = _Rows(
        raw=numbers.view(np.uint8).reshape(height, -1),
        step=np.array([numbers.itemsize * (pixels.shape[2] if pixels.ndim == 3 else 1)]),
        filtered=np.empty((height, 1 + numbers.nbytes // height), np.uint8),
    )
    _filter(rows)
    data = rows.filtered.reshape(-1)
    # Deflate, with no preset; the check is of what was filtered.
    stream = b"\x78\x01" + deflated(data) + struct.pack(">I", zlib.adler32(data.data))
    kind = _COLOURS if pixels.ndim == 3 else _GREY
    header = struct.pack(">IIBBBBB", width, height, 8 * numbers.itemsize, kind, 0, 0, 0)
    chunks = (_chunk(b"IHDR", header), _chunk(b"IDAT", stream), _chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def _chunk(name: bytes, data: bytes) -> bytes:
    check = zlib.crc32(data, zlib.crc32(name))
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", check)


@compiled
def _filter(rows: _Rows) -> None:
    """Write `_Rows.filtered`: each byte less the neighbour that is nearest to what a plane through
    the three known neighbours says.
    """
    step = rows.step[0]
    for line in range(rows.raw.shape[0]):
        raw, out = rows.raw[line], rows.filtered[line]
        out[0] = PAETH
        if line == 0:
            for k in range(len(raw)):
                out[1 + k] = (raw[k] - (raw[k - step] if k >= step else 0)) & 255
            continue
        above = rows.raw[line - 1]
        for k in range(step):
            out[1 + k] = (raw[k] - above[k]) & 255
        for k in range(step, len(raw)):
            left, up, corner = i4(raw[k - step]), i4(above[k]), i4(above[k - step])
            from_left, from_up = abs(up - corner), abs(left - corner)
            from_corner = abs(left + up - corner - corner)
            nearest = up if from_up <= from_corner else corner
            if from_left <= from_up and from_left <= from_corner:
                nearest = left
            out[1 + k] = (raw[k] - nearest) & 255
