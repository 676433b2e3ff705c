"""Reading and writing eight pixels of a row; rows of pictures may have any length."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    first_bit,
    gather,
    lane,
    lane_numbers,
    load,
    own,
    store,
    store_triples,
    to_u4,
)
from eyas.render.kernels.bundles import Canvas, Light
from eyas.render.kernels.light.tone import tone_bytes
from eyas.render.kernels.scalars import i4, i8, u4

__all__ = ["keys_of", "pack", "write_colours", "write_pixels", "write_plane"]

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
    canvas: Canvas,
    light: Light,
    exposure: float,
    row: int,
    first: int,
    chosen: int,
    colour: tuple[float, float, float],
) -> None:
    """Write the colours of those of eight pixels, from column `first` on, whose bit is set.

    Args:
        canvas: Where to.
        light: Has the table of tones.
        exposure: See `Air`.
        row: Row of the band.
        first: Column of the first pixel.
        chosen: A bit for each pixel.
        colour: Linear radiance.
    """
    if len(canvas.red) > 0:
        write_plane(canvas.red, row, first, chosen, colour[0])
        write_plane(canvas.green, row, first, chosen, colour[1])
        write_plane(canvas.blue, row, first, chosen, colour[2])
        return
    red, green, blue = tone_bytes(light, exposure, colour)
    write_pixels(canvas.pixels, row, first, chosen, pack(red, green, blue))


@kernel(inline=True)
def keys_of(key: NDArray[np.int64], line: int, sample: int, step: int) -> int:
    """Return eight keys of a line, from a sample on, `step` apart."""
    at = i8(line) * key.shape[1] + sample
    if step == 1:
        return load(key, at)
    return gather(key, lane_numbers() * i4(step) + i4(at))
