"""The tent filter of a picture's pixels: a quarter of each comes from either side, along rows and
along columns, as a lens and a sensor spread the light of a point over more than one pixel.

A sample in the middle of each pixel says all or nothing of what is thinner than a pixel, so it
comes and goes from picture to picture. The filter is the last that belongs to the light: it follows
what is in the air (halos, plumes, rain), since all that passes the lens, and precedes what is done
to pixels (noise, coding, overlays). Bytes are filtered, not light, which keeps highlights small and
costs a hundredth of a picture.

Sums are whole numbers, so bands and processors change no byte. Each 32 bits hold two bytes, the
even or the odd ones of four, with room for their sums.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, i8, u4
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import WIDTH, load, load_words, store, store_words

PIXELS_PER_THREAD = 100_000
"""Pixels below which another thread takes longer to wake than to help."""

SIDE, MIDDLE, PARTS = 1, 2, 2  # Weights along a row, or a column; their sum as a power of two

SHIFT, ROUNDING = 2 * PARTS, 1 << 2 * PARTS - 1  # Bits of a sum's fraction, and a half

_BYTES = 4 * WIDTH  # Bytes in lanes

_HALVES = u4(0x00FF00FF)  # The even bytes of four

_ROUNDINGS = u4(ROUNDING * 0x00010001)


class _Work(NamedTuple):
    """Bands that are filtered, and memory of K workers."""

    rgb: NDArray[np.uint8]  # Shape (P, H, W, 3)
    band: NDArray[np.int64]  # Picture, first row, last row + 1 of each, shape (J, 3)
    edge: NDArray[np.uint8]
    """The rows above and below each, before either is written, shape (J, 2, W, 3)."""
    line: NDArray[np.uint8]
    """Two rows by turns, with a pixel more at either end, shape (K, 2, bytes)."""
    total: NDArray[np.uint32]
    """Sums along three rows by turns, of even and of odd bytes, shape (K, 3, 2, words)."""


def filter_pixels(rgb: NDArray[np.uint8]) -> None:
    """Filter pictures, shape (P, H, W, 3), in place."""
    pictures, height, width = rgb.shape[:3]
    workers = min(thread_count(), 1 + pictures * height * width // PIXELS_PER_THREAD)
    bands = min(-(-workers // max(pictures, 1)), height)
    picture, number = np.divmod(np.arange(pictures * bands), bands)
    ends = np.stack((number, number + 1)) * height // bands
    above, below = np.maximum(ends[0] - 1, 0), np.minimum(ends[1], height - 1)
    edge = np.stack((rgb[picture, above], rgb[picture, below]), axis=1)
    band = np.stack((picture, *ends), axis=1)
    _filter(workers, _Work(rgb, band, edge, *memory(workers, width)))


def memory(workers: int, width: int) -> tuple[NDArray[np.uint8], NDArray[np.uint32]]:
    """Return `line` and `total` of so many workers."""
    words = -(-3 * width // _BYTES) * WIDTH
    line = np.empty((workers, 2, 4 * words + _BYTES), np.uint8)
    return line, np.empty((workers, 3, 2, words), np.uint32)


@parallel
def _filter(worker: int, workers: int, work: _Work) -> None:
    """Filter the bands whose turn is this worker's."""
    line, total = work.line[worker], work.total[worker]
    for index in range(worker, work.band.shape[0], workers):
        picture, first, last = work.band[index]
        filter_rows(work.rgb[picture], work.edge[index], line, total, first, last)


@kernel
def filter_rows(
    pixels: NDArray[np.uint8],  # Of a picture, shape (H, W, 3)
    edge: NDArray[np.uint8],  # See `_Work`
    line: NDArray[np.uint8],
    total: NDArray[np.uint32],
    first: int,
    last: int,
) -> None:
    """Filter rows from the first on, up to the last, excluded; those at the border of the picture
    stand for what is beyond it.

    A row is copied one turn before it is added up, since what has just been stored is not yet in
    the cache, from which the bytes beside each are loaded.
    """
    if first > 0:
        _copy_row(edge, 0, line[0])
    else:
        _copy_row(pixels, 0, line[0])
    _copy_row(pixels, first, line[1])
    _add_across(line[0], total[0])
    for row in range(first, last + 1):
        now = row - first
        if row + 1 == last < len(pixels):
            _copy_row(edge, 1, line[now & 1])
        elif row < last:
            _copy_row(pixels, min(row + 1, last - 1), line[now & 1])
        _add_across(line[now + 1 & 1], total[(now + 1) % 3])
        if now > 0:
            _write_row(pixels, row - 1, total[(now - 1) % 3], total[now % 3], total[(now + 1) % 3])


@kernel
def _copy_row(pixels: NDArray[np.uint8], row: int, line: NDArray[np.uint8]) -> None:
    """Copy a row, and its ends once more."""
    count = 3 * pixels.shape[1]
    begin, last = row * count, count - _BYTES
    for at in range(0, count - _BYTES + 1, _BYTES):
        store_words(line, 3 + at, load_words(pixels, begin + at))
    if last >= 0:
        store_words(line, 3 + last, load_words(pixels, begin + last))
    else:
        for at in range(count):
            line[3 + at] = pixels[row, at // 3, at % 3]
    for k in range(3):
        line[k] = line[3 + k]
        line[3 + count + k] = line[count + k]


@kernel
def _add_across(line: NDArray[np.uint8], total: NDArray[np.uint32]) -> None:
    """Add the bytes of a row to those of the pixels beside them."""
    words = total.shape[1]
    for word in range(0, words, WIDTH):
        at = 4 * word
        left, own, right = load_words(line, at), load_words(line, at + 3), load_words(line, at + 6)
        store(total, word, weighted(left & _HALVES, own & _HALVES, right & _HALVES))
        left, own, right = left >> u4(8), own >> u4(8), right >> u4(8)
        store(total, words + word, weighted(left & _HALVES, own & _HALVES, right & _HALVES))


@kernel
def _write_row(
    pixels: NDArray[np.uint8],  # Of which a row is written
    row: int,
    above: NDArray[np.uint32],  # Sums of the row above, of the row, and of that below
    middle: NDArray[np.uint32],
    below: NDArray[np.uint32],
) -> None:
    """Write a row, and no byte beside it: others may be writing those."""
    count = 3 * pixels.shape[1]
    whole = count // _BYTES * WIDTH
    for word in range(0, whole, WIDTH):
        store_words(pixels, row * count + 4 * word, _mean_down(above, middle, below, word))
    if count >= _BYTES and count % 4 == 0:
        word = count // 4 - WIDTH
        store_words(pixels, row * count + 4 * word, _mean_down(above, middle, below, word))
        return
    if count > 4 * whole:
        # Their sums are not needed any more, and have room for the bytes of all lanes.
        rest = _mean_down(above, middle, below, whole)
        store(above, whole, rest)
        for at in range(4 * whole, count):
            word = i8(above[0, at // 4])
            pixels[row, at // 3, at % 3] = (word >> 8 * (at & 3)) & 255


@kernel(inline=True)
def _mean_down(
    above: NDArray[np.uint32], middle: NDArray[np.uint32], below: NDArray[np.uint32], word: int
) -> int:
    """Return 32 bytes of a row, of their sums in three."""
    odd = word + above.shape[1]
    return _mean(load(above, word), load(middle, word), load(below, word)) | (
        _mean(load(above, odd), load(middle, odd), load(below, odd)) << u4(8)
    )


@kernel(inline=True)
def _mean(above: int, middle: int, below: int) -> int:
    """Return two bytes in each lane."""
    return ((weighted(above, middle, below) + _ROUNDINGS) >> u4(SHIFT)) & _HALVES


@kernel(inline=True)
def weighted(before: int, own: int, after: int) -> int:
    """Return weighted sums of whole numbers, two in each lane."""
    return (before + after) * u4(SIDE) + own * u4(MIDDLE)


class _Light(NamedTuple):
    """Light that is filtered, and memory of each worker as in `_Work`."""

    plane: NDArray[np.float32]  # Shape (planes, H, W)
    line: NDArray[np.float32]  # Shape (K, at least W + 9)
    total: NDArray[np.float32]  # Shape (K, 3, at least W + 7)


def filter_light(radiance: NDArray[np.float32]) -> None:
    """Filter the light of pictures at least eight pixels wide, shape (V, 3, H, W), in place."""
    plane = radiance.reshape(-1, *radiance.shape[2:])
    workers, room = min(thread_count(), len(plane)), plane.shape[2] + 2 * WIDTH
    line, total = np.zeros((workers, room), np.float32), np.empty((workers, 3, room), np.float32)
    _filter_planes(workers, _Light(plane, line, total))


@parallel
def _filter_planes(worker: int, workers: int, light: _Light) -> None:
    """Filter the planes whose turn is this worker's."""
    line, total = light.line[worker], light.total[worker]
    height, width = light.plane.shape[1], light.plane.shape[2]
    for number in range(worker, light.plane.shape[0], workers):
        plane = light.plane[number]
        for row in range(height + 1):
            if row < height:
                for first in range(0, width, WIDTH):
                    at = min(first, width - WIDTH)
                    store(line, 1 + at, load(plane, row * width + at))
                line[0], line[1 + width] = line[1], line[width]
                for at in range(0, width, WIDTH):
                    across = _spread(load(line, at), load(line, at + 1), load(line, at + 2))
                    store(total[row % 3], at, across)
            above, own, below = max(row - 2, 0) % 3, (row - 1) % 3, min(row, height - 1) % 3
            for first in range(0, width if row > 0 else 0, WIDTH):
                at = min(first, width - WIDTH)
                three = load(total[above], at), load(total[own], at), load(total[below], at)
                store(plane, (row - 1) * width + at, _spread(three[0], three[1], three[2]))


@kernel(inline=True)
def _spread(before: float, own: float, after: float) -> float:
    """Return the weighted mean of eight numbers and their neighbours'."""
    whole = f4(1 << PARTS)
    return (before + after) * (f4(SIDE) / whole) + own * (f4(MIDDLE) / whole)
