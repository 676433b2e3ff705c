"""Pixels of the sky, behind all things."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.light.tone import tone_byte
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.sky.radiance import sky

__all__ = ["draw_backdrop"]


@inlined_kernel
def _shows_sky(owners: NDArray[np.int64]) -> bool:
    """Return whether any owner is negative, without a branch for each: most rows show no sky."""
    signs = i8(0)
    for k in range(len(owners)):
        signs |= owners[k]
    return signs < 0


@inner_kernel
def draw_backdrop(
    samples: int,
    top: int,
    light: Light,
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    owner: NDArray[np.int64],
    output: NDArray[np.uint8],
) -> None:
    """Write the sky at the centre of each pixel in which any sample shows it.

    Separate from `shade_band`, so that the code that shades surfaces stays small.

    Args:
        samples: Samples along a side of each pixel, 1 or 2.
        top: Row of the picture that is row 0 of `output`.
        light: Light and air.
        axes: See `Job`.
        lens: See `Job`.
        owner: See `Scratch`.
        output: sRGB, shape (rows, columns, 3).
    """
    half = f4(0.5) * f4(samples)
    across, down = f4(1.0 / lens[0]), f4(1.0 / lens[4])
    middle, centre_line = f4(0.5 * lens[1]), f4(0.5 * lens[2] - top * samples)
    ahead_x, ahead_y, ahead_z = f4(axes[0, 0]), f4(axes[0, 1]), f4(axes[0, 2])
    left_x, left_y, left_z = f4(axes[1, 0]), f4(axes[1, 1]), f4(axes[1, 2])
    up_x, up_y, up_z = f4(axes[2, 0]), f4(axes[2, 1]), f4(axes[2, 2])
    for row in range(output.shape[0]):
        line = row * samples
        if not (_shows_sky(owner[line]) or _shows_sky(owner[line + samples - 1])):
            continue
        for column in range(output.shape[1]):
            sample = column * samples
            first = owner[line, sample]
            if samples == 2:
                first = min(first, owner[line, sample + 1])
                first = min(first, min(owner[line + 1, sample], owner[line + 1, sample + 1]))
            if first >= 0:
                continue
            left = (middle - (f4(sample) + half)) * across
            up = (centre_line - (f4(line) + half)) * down
            x = ahead_x + left * left_x + up * up_x
            y = ahead_y + left * left_y + up * up_y
            z = ahead_z + left * left_z + up * up_z
            unit = f4(1.0) / math.sqrt(x * x + y * y + z * z)
            colour = sky(light, x * unit, y * unit, z * unit)
            for k in range(3):
                output[row, column, k] = tone_byte(light, colour[k])
