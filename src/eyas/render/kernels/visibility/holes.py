"""Holes between leaves, where the alpha of their texture is low."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.core.lanes import gather, select, to_f4, to_i4
from eyas.render.kernels.scalars import f4, i4, i8

__all__ = ["Holes", "has_leaf", "holes_level", "holes_of", "no_holes"]

SMALLEST_HOLES = 4
"""Mip level from which on leaves have no holes: a leaf would be smaller than a pixel."""

_BITS = 8
"""Binary logarithm of the texels along a side of level 0."""


class Holes(NamedTuple):
    """A mip level of a texture; the levels of a layer lie in a row, see `Geometry.texture`."""

    texture: NDArray[np.uint32]
    first: int
    """Its first texel in the whole array."""
    level: int
    """-1: no holes."""


@inlined_kernel
def no_holes(texture: NDArray[np.uint32]) -> Holes:
    """Return what triangles without holes have."""
    return Holes(texture, i8(0), i8(-1))


@inlined_kernel
def holes_of(texture: NDArray[np.uint32], layer: int, level: int) -> Holes:
    """Return the holes of a layer at a mip level, below 8."""
    # 65536 + 16384 + ... = (4^9 - 4^(9 - level)) / 3
    before = (262144 - (262144 >> (2 * level))) // 3
    return Holes(texture, i8(layer * texture.shape[1] + before), i8(level))


@inlined_kernel
def holes_level(texels: float) -> int:
    """Return the mip level for a number of texels that a pixel spans; -1: no holes."""
    level, limit = 0, 2.0
    while level < SMALLEST_HOLES and texels * texels > limit:
        level += 1
        limit *= 4.0
    return level if level < SMALLEST_HOLES else -1


@inlined_kernel
def _place(x: float, bits: int) -> int:
    """Return the texel, of `2^bits`, at a texture coordinate [tiles]."""
    part = x - to_f4(to_i4(x))  # truncation is faster than rounding down
    part += select(part < f4(0.0), f4(1.0), f4(0.0))
    size = 1 << bits
    return to_i4(part * f4(size)) & i4(size - 1)


@inlined_kernel
def has_leaf(holes: Holes, u: float, v: float) -> bool:
    """Return where there is a leaf at texture coordinates [tiles]."""
    bits = _BITS - holes.level
    at = (_place(v, bits) << i4(bits)) + _place(u, bits) + i4(holes.first)
    return to_i4(gather(holes.texture, at)) < i4(0)  # alpha, the highest byte, above 127
