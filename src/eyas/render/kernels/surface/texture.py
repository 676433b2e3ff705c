"""Textures: level of detail and smooth lookup.

A layer holds 256 x 256 texels, then its mip levels down to one texel, in one row.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.core.lanes import (
    bit_pattern,
    gather,
    greater,
    lesser,
    like,
    select,
    to_f4,
    to_i4,
    to_u4,
)
from eyas.render.kernels.scalars import f4, i4, u4

__all__ = ["colour_of", "first_texel", "fraction", "level_of", "texel"]

_LAYER = i4(87381)
"""Texels of a layer with all its levels."""

_THIRD = i4(-1431655765)
"""Inverse of 3 for numbers of 32 bits: a product with it is exact where nothing is left over."""


@inlined_kernel
def level_of(texels_squared: float) -> int:
    """Return the mip level, 0 to 8, from the squared number of texels that a pixel spans.

    It rises at 2, 8, 32, ...: at every second step of the exponent.
    """
    exponent = ((bit_pattern(texels_squared) - i4(1)) >> i4(23)) - i4(127)
    return to_i4(lesser((greater(exponent, i4(0)) + i4(1)) >> i4(1), i4(8)))


@inlined_kernel
def fraction(x: float) -> float:
    """Return the fractional part of a number; truncation is faster than rounding down."""
    part = x - to_f4(to_i4(x))
    return part + select(part < f4(0.0), like(x, f4(1.0)), f4(0.0))


@inlined_kernel
def first_texel(level: int) -> int:
    """Return the first texel of a level: 65536 + 16384 + ... = (4^9 - 4^(9 - level)) / 3."""
    above = i4(262144) - (like(level, i4(262144)) >> (level + level))
    return to_i4(above * _THIRD)


@inlined_kernel
def texel(
    textures: NDArray[np.uint32], layer: int, level: int, u: float, v: float
) -> tuple[int, int]:
    """Return the texel at (u, v) [tiles], blended from the four around it.

    Two bytes are blended with one multiplication: weights are 0 to 256 and sum to 256, so the
    lower product cannot reach the upper byte.

    Returns:
        Red and blue in bits 0 to 7 and 16 to 23 of a number, green and alpha in those of another;
        the bits between are not zero.
    """
    bits = i4(8) - level
    one = like(level, i4(1))
    side = to_i4(one << bits)
    size = to_f4(side)
    x = fraction(u) * size + (size - f4(0.5))
    y = fraction(v) * size + (size - f4(0.5))
    column, row = to_i4(x), to_i4(y)
    across = to_u4(to_i4((x - to_f4(column)) * f4(256.0)))
    down = to_u4(to_i4((y - to_f4(row)) * f4(256.0)))
    mask = side - i4(1)
    first = first_texel(level) + layer * _LAYER
    upper = first + ((row & mask) << bits)
    lower = first + (((row + i4(1)) & mask) << bits)
    left, right = column & mask, (column + i4(1)) & mask
    a, b = gather(textures, upper + left), gather(textures, upper + right)
    c, d = gather(textures, lower + left), gather(textures, lower + right)
    even, eight = u4(0x00FF00FF), u4(8)
    both = to_u4((across * down) >> eight)
    w01, w10 = across - both, down - both
    w00 = u4(256) - across - w10
    low = w00 * (a & even) + w01 * (b & even) + w10 * (c & even) + both * (d & even)
    high = (
        w00 * ((a >> eight) & even)
        + w01 * ((b >> eight) & even)
        + w10 * ((c >> eight) & even)
        + both * ((d >> eight) & even)
    )
    return to_u4(low >> eight), to_u4(high >> eight)


@inlined_kernel
def colour_of(low: int, high: int) -> tuple[float, float, float, float]:
    """Return the linear colour and the alpha, 0 to 1, of a texel as `texel` returns it.

    Textures hold square roots of linear colours.
    """
    scale, byte, half = f4(1.0 / 255.0), u4(255), u4(16)
    red, green = to_f4(low & byte) * scale, to_f4(high & byte) * scale
    blue, alpha = to_f4((low >> half) & byte) * scale, to_f4((high >> half) & byte) * scale
    return red * red, green * green, blue * blue, alpha
