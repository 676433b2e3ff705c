"""Holes between leaves, where the alpha of their texture is low."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.surface.texture import TEXELS_IN_ROW, first_texel
from eyas.lanes import kernel
from eyas.lanes.vector import gather, to_i4, whole

SMALLEST_HOLES = 4
"""Mip level from which on leaves have no holes: a leaf would be smaller than a pixel."""

LEVELS = 16  # A layer of the texture times this, and a mip level, are one number

_BITS = 8  # Binary logarithm of the texels along a side of level 0


class Holes(NamedTuple):
    """A mip level of a texture; see `eyas.engine.render.kernels.surface.texture`."""

    texture: NDArray[np.uint32]
    first: int  # Its first texel in the whole array
    level: int  # -1: no holes
    size: float  # Texels along its sides


@kernel(inline=True)
def no_holes(texture: NDArray[np.uint32]) -> Holes:
    """Return what triangles without holes have."""
    return Holes(texture, i8(0), i8(-1), 1.0)


@kernel(inline=True)
def holes_of(texture: NDArray[np.uint32], leaves: int) -> Holes:
    """Return the holes that `eyas.engine.render.kernels.visibility.leaves.leaves_of` tells of."""
    if leaves < 0:
        return no_holes(texture)
    layer, level = leaves // LEVELS, leaves % LEVELS
    side = 1 << (_BITS - level)
    first = i8(layer * texture.shape[1] + first_texel(i4(level), i4(side)))
    return Holes(texture, first, i8(level), float(side))


@kernel(inline=True)
def holes_level(texels: float) -> int:
    """Return the mip level for a number of texels that a pixel spans; -1: no holes."""
    level, limit = 0, 2.0
    while level < SMALLEST_HOLES and texels * texels > limit:
        level += 1
        limit *= 4.0
    return level if level < SMALLEST_HOLES else -1


@kernel(inline=True)
def has_leaf(holes: Holes, u: float, v: float) -> bool:
    """Return where there is a leaf at texture coordinates [texels of the level]."""
    bits = _BITS - holes.level
    last = i4((1 << bits) - 1)
    column, row = to_i4(whole(u)) & last, to_i4(whole(v)) & last
    at = to_i4(row * i4(TEXELS_IN_ROW) + column + i4(holes.first))
    return to_i4(gather(holes.texture, at)) < i4(0)  # alpha, the highest byte, above 127
