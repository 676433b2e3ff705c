"""The surface of still water: small waves, and the colour of what is below."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.surface.texture import texel

__all__ = ["water_colour", "water_slope"]


@inlined_kernel
def water_slope(
    textures: NDArray[np.uint32], layer: int, level: int, u: float, v: float
) -> tuple[float, float]:
    """Return the slope of the waves eastwards and northwards, see the texture `water`.

    Two sizes of waves that share no period, the smaller ones turned by a right angle, so that
    no repeat is seen.
    """
    scale = f4(1.0 / 255.0)
    large = texel(textures, layer, level, u, v)
    finer = min(level + 1, 8)
    small = texel(textures, layer, finer, f4(2.31) * v + f4(0.37), f4(-2.31) * u)
    large_u, large_v = f4(large & 255) * scale, f4((large >> 8) & 255) * scale
    small_u, small_v = f4(small & 255) * scale, f4((small >> 8) & 255) * scale
    half = f4(0.5)
    # The small waves' own v runs west, their u north.
    return (
        (large_u * large_u - half) - half * (small_v * small_v - half),
        (large_v * large_v - half) + half * (small_u * small_u - half),
    )


@inlined_kernel
def water_colour(
    tint: NDArray[np.float32], material: int, slope: float
) -> tuple[float, float, float]:
    """Return the colour of the depth; waves gather and spread the light on it."""
    light = f4(1.0) + f4(0.8) * slope
    return tint[material, 0] * light, tint[material, 1] * light, tint[material, 2] * light
