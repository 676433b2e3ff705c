"""Pixels of the sky, behind all things."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, bits_of, lane_numbers, root, to_f4
from eyas.render.kernels.bundles import Band, Illumination, Light
from eyas.render.kernels.light.tone import tone_bytes
from eyas.render.kernels.pixels import keys_of, pack, write_pixels
from eyas.render.kernels.rays import Rays, ray_of, rays_of
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.sky.radiance import sky

__all__ = ["draw_backdrop", "sky_pixel"]


@kernel(inline=True)
def sky_pixel(light: Light, lit: Illumination, rays: Rays, line: float, column: float) -> int:
    """Return the packed bytes of the sky at a place of the picture [samples]."""
    x, y, z = ray_of(rays, line, column)
    unit = f4(1.0) / root(x * x + y * y + z * z)
    colour = sky(light, lit, x * unit, y * unit, z * unit, rays.pixel)
    red, green, blue = tone_bytes(light, lit.air.exposure, colour)
    return pack(red, green, blue)


@kernel(inline=True)
def _sky_bits(key: NDArray[np.int64], line: int, sample: int, samples: int) -> int:
    """Return in which of eight pixels any sample shows the sky, a bit each."""
    bits = i8(0)
    for k in range(samples * samples):
        keys = keys_of(key, line + (k >> 1), sample + (k & 1), samples)
        bits |= bits_of(keys == i8(0))
    return bits


@kernel
def draw_backdrop(band: Band, pixels: NDArray[np.uint8]) -> None:
    """Write the sky at the centre of each pixel in which any sample shows it.

    Separate from `shade_band`, so that the code that shades surfaces stays small.

    Args:
        band: The band.
        pixels: sRGB, shape (rows, columns, 3).
    """
    view, light, lit, key = band.camera, band.light, band.lit, band.key
    rays, samples = rays_of(view), view.samples
    side, half = f4(samples), f4(0.5) * f4(samples)
    width = pixels.shape[1]
    for row in range(pixels.shape[0]):
        for first in range(0, width, WIDTH):
            chosen = _sky_bits(key, row * samples, first * samples, samples)
            if width - first < WIDTH:
                chosen &= (1 << (width - first)) - 1
            if chosen == 0:
                continue
            column = to_f4(lane_numbers()) * side + (f4(first) * side + half)
            packed = sky_pixel(light, lit, rays, rays.top + f4(row) * side + half, column)
            write_pixels(pixels, row, first, chosen, packed)
