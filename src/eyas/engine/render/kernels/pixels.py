"""Reading and writing eight pixels of a row; rows of pictures may have any length."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Canvas, Light
from eyas.engine.render.kernels.light.tone import tone_bytes
from eyas.engine.render.kernels.scalars import i4, i8, u4
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    any_of,
    bits_of,
    first_bit,
    gather,
    lane,
    lane_numbers,
    load,
    load_two,
    own,
    scatter,
    select,
    splat,
    store,
    store_triples,
    store_triples_two,
    to_u4,
)

ACROSS = 4
"""Pixels in each of the two rows of a tile. What eight pixels show that lie together is more often
one thing than in a row, and pictures are more often a multiple of four wide than of eight."""

_ALL = (1 << WIDTH) - 1


@kernel(inline=True)
def pack(red: int, green: int, blue: int) -> int:
    """Return three bytes in one number, red in the lowest."""
    return to_u4(red | (green << u4(8)) | (blue << u4(16)))


@kernel(inline=True)
def _write_own_pixel(
    pixels: NDArray[np.uint8], row: int, first: int, chosen: int, packed: int
) -> None:
    """Write what `write_pixels` does; each thread writes its own pixel."""
    number, value = i8(own(lane_numbers())), own(packed)
    if (chosen >> number) & 1:
        column = first + number
        pixels[row, column, 0] = value & u4(255)
        pixels[row, column, 1] = (value >> u4(8)) & u4(255)
        pixels[row, column, 2] = (value >> u4(16)) & u4(255)
    agree()


@kernel(inline=True)
def _write_own_of_tile(
    pixels: NDArray[np.uint8], row: int, first: int, chosen: int, packed: int
) -> None:
    """Write what `_write_tile_pixels` does; each thread writes its own pixel."""
    number, value = i8(own(lane_numbers())), own(packed)
    if (chosen >> number) & 1:
        line, column = row + number // ACROSS, first + number % ACROSS
        pixels[line, column, 0] = value & u4(255)
        pixels[line, column, 1] = (value >> u4(8)) & u4(255)
        pixels[line, column, 2] = (value >> u4(16)) & u4(255)
    agree()


@kernel(inline=True)
def _write_own_number(
    plane: NDArray[np.float32], row: int, first: int, chosen: int, value: float
) -> None:
    """Write what `write_plane` does; each thread writes its own number."""
    number = i8(own(lane_numbers()))
    if (chosen >> number) & 1:
        plane[row, first + number] = own(value)
    agree()


@kernel(inline=True, threads=_write_own_pixel)
def write_pixels(pixels: NDArray[np.uint8], row: int, first: int, chosen: int, packed: int) -> None:
    """Write packed bytes to those of eight pixels, from column `first` on, whose bit is set."""
    if chosen == _ALL:
        store_triples(pixels, (row * pixels.shape[1] + first) * 3, packed)
        return
    while chosen != 0:
        number = first_bit(chosen)
        chosen &= chosen - 1
        value = lane(packed, number)
        column = first + number
        pixels[row, column, 0] = value & u4(255)
        pixels[row, column, 1] = (value >> u4(8)) & u4(255)
        pixels[row, column, 2] = (value >> u4(16)) & u4(255)


@kernel(inline=True, threads=_write_own_number)
def write_plane(
    plane: NDArray[np.float32], row: int, first: int, chosen: int, value: float
) -> None:
    """Write those of eight numbers, from column `first` on, whose bit is set."""
    if chosen == _ALL:
        store(plane, row * plane.shape[1] + first, value)
        return
    while chosen != 0:
        number = first_bit(chosen)
        chosen &= chosen - 1
        plane[row, first + number] = lane(value, number)


@kernel(inline=True)
def write_colours(
    canvas: Canvas,  # Where to
    light: Light,  # Has the table of tones
    exposure: float,  # See `Air`
    row: int,  # Row of the band
    first: int,  # Column of the first pixel
    chosen: int,  # A bit for each pixel
    colour: tuple[float, float, float],  # Linear radiance
) -> None:
    """Write the colours of those of eight pixels, from column `first` on, whose bit is set."""
    if len(canvas.red) > 0:
        write_plane(canvas.red, row, first, chosen, colour[0])
        write_plane(canvas.green, row, first, chosen, colour[1])
        write_plane(canvas.blue, row, first, chosen, colour[2])
        return
    red, green, blue = tone_bytes(light, exposure, colour)
    write_pixels(canvas.pixels, row, first, chosen, pack(red, green, blue))


@kernel(inline=True, threads=_write_own_of_tile)
def _write_tile_pixels(
    pixels: NDArray[np.uint8], row: int, first: int, chosen: int, packed: int
) -> None:
    """Write packed bytes to those pixels of a tile whose bit is set."""
    if chosen == _ALL:
        width = pixels.shape[1]
        store_triples_two(pixels, (row * width + first) * 3, width * 3, packed)
        return
    while chosen != 0:
        number = first_bit(chosen)
        chosen &= chosen - 1
        value = lane(packed, number)
        line, column = row + number // ACROSS, first + number % ACROSS
        pixels[line, column, 0] = value & u4(255)
        pixels[line, column, 1] = (value >> u4(8)) & u4(255)
        pixels[line, column, 2] = (value >> u4(16)) & u4(255)


@kernel(inline=True)
def write_tile(
    canvas: Canvas,
    light: Light,
    exposure: float,
    row: int,
    first: int,
    chosen: bool,
    colour: tuple[float, float, float],
) -> None:
    """Write what `write_colours` does, to four pixels of a row and four of the next."""
    if len(canvas.red) > 0:
        lanes = lane_numbers()
        line, column = lanes >> i4(2), lanes & i4(ACROSS - 1)
        at = line * i4(canvas.red.shape[1]) + column + i4(row * canvas.red.shape[1] + first)
        scatter(canvas.red, at, chosen, colour[0])
        scatter(canvas.green, at, chosen, colour[1])
        scatter(canvas.blue, at, chosen, colour[2])
        return
    red, green, blue = tone_bytes(light, exposure, colour)
    _write_tile_pixels(canvas.pixels, row, first, bits_of(chosen), pack(red, green, blue))


@kernel(inline=True)
def keys_of_tile(key: NDArray[np.int64], line: int, sample: int, below: int) -> int:
    """Return four keys of a line, from a sample on, and the four `below` lines after them."""
    return load_two(key, i8(line) * key.shape[1] + sample, below * key.shape[1])


@kernel(inline=True)
def keys_of(key: NDArray[np.int64], line: int, sample: int, step: int) -> int:
    """Return eight keys of a line, from a sample on, `step` apart."""
    at = i8(line) * key.shape[1] + sample
    if step == 1:
        return load(key, at)
    return gather(key, lane_numbers() * i4(step) + i4(at))


@kernel(inline=True)
def written(pixels: NDArray[np.uint8], row: int, first: int, mask: bool) -> int:
    """Return the packed bytes that eight pixels have already, 0 where the mask is not set."""
    packed = splat(u4(0))
    if any_of(mask):
        at = (lane_numbers() + i4(row * pixels.shape[1] + first)) * i4(3)
        at = select(mask, at, i4(0))
        words = pack(gather(pixels, at), gather(pixels, at + i4(1)), gather(pixels, at + i4(2)))
        packed = select(mask, words, packed)
    return packed
