"""The surface of still water: small waves, and the colour of what is below."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import lesser, to_i4
from eyas.render.kernels.scalars import f4, i4
from eyas.render.kernels.surface.texture import colour_of, texel

__all__ = ["water_slope"]


@kernel(inline=True)
def water_slope(
    textures: NDArray[np.uint32], layer: int, detail: int, blend: bool, u: float, v: float
) -> tuple[float, float]:
    """Return the slope of the waves eastwards and northwards, see the texture `water`.

    Two sizes of waves that share no period, the smaller ones turned by a right angle, so that
    no repeat is seen.
    """
    low, high = texel(textures, layer, detail, blend, u, v)
    large_u, large_v, _, _ = colour_of(low, high)
    finer = to_i4(lesser(detail + i4(256), i4(2048)))
    low, high = texel(textures, layer, finer, blend, f4(2.31) * v + f4(0.37), f4(-2.31) * u)
    small_u, small_v, _, _ = colour_of(low, high)
    half = f4(0.5)
    # The small waves' own v runs west, their u north.
    return (
        (large_u - half) - half * (small_v - half),
        (large_v - half) + half * (small_u - half),
    )
