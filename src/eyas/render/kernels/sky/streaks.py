"""Streaks of falling flakes, drawn into a picture."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.render.kernels.bundles import View
from eyas.render.kernels.scalars import i8
from eyas.render.kernels.visibility.key import distance_inverse

__all__ = ["Snowfall", "smear"]


class Snowfall(NamedTuple):
    """A band, the air in it and its picture, into which flakes are drawn."""

    band: View
    instant: float
    """Time [s]."""
    most: int
    """Largest number of flakes in a cell."""
    white: tuple[int, int, int]
    """Bytes of a flake."""
    key: NDArray[np.int64]
    """See `Scratch`."""
    pixels: NDArray[np.uint8]
    """sRGB, shape (rows, columns, 3)."""


@kernel
def smear(
    column: float,
    row: float,
    to_column: float,
    to_row: float,
    radius: float,
    inverse: float,
    snowfall: Snowfall,
) -> None:
    """Draw a soft streak.

    Args:
        column: Column of its end [pixels].
        row: Row of its end in the band [pixels].
        to_column: Columns from there to its start [pixels].
        to_row: Rows from there to its start [pixels].
        radius: Half its width [pixels].
        inverse: One over its distance [1/m].
        snowfall: Band to draw into.
    """
    drawn = max(radius, 0.6)
    soft = 0.5 + 0.35 * drawn
    reach = drawn + soft
    pixels, step = snowfall.pixels, snowfall.band.samples
    first = max(i8(math.floor(min(row, row + to_row) - reach)), 0)
    last = min(i8(math.ceil(max(row, row + to_row) + reach)), pixels.shape[0])
    start = max(i8(math.floor(min(column, column + to_column) - reach)), 0)
    stop = min(i8(math.ceil(max(column, column + to_column) + reach)), pixels.shape[1])
    if first >= last or start >= stop:
        return
    length = math.sqrt(to_column * to_column + to_row * to_row)
    # A small flake covers part of a pixel; a moving one is in each pixel part of the time.
    strength = (radius / drawn) ** 2 * min(1.0, 2.6 * drawn / (drawn + length))
    strength *= 0.9 / (1.0 + 0.09 * max(radius - 2.0, 0.0))
    red, green, blue = snowfall.white
    for i in range(first, last):
        for j in range(start, stop):
            if distance_inverse(snowfall.key[i * step, j * step]) > inverse:
                continue
            y, x = i + 0.5 - row, j + 0.5 - column
            share = (x * to_column + y * to_row) / (length * length + 1e-9)
            share = min(max(share, 0.0), 1.0)
            x, y = x - share * to_column, y - share * to_row
            cover = (reach - math.sqrt(x * x + y * y)) / (2.0 * soft)
            cover = strength * min(max(cover, 0.0), 1.0)
            pixels[i, j, 0] = i8(pixels[i, j, 0] + cover * (red - pixels[i, j, 0]) + 0.5)
            pixels[i, j, 1] = i8(pixels[i, j, 1] + cover * (green - pixels[i, j, 1]) + 0.5)
            pixels[i, j, 2] = i8(pixels[i, j, 2] + cover * (blue - pixels[i, j, 2]) + 0.5)
