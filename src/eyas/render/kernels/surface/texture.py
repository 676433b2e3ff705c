"""Textures: level of detail and smooth lookup.

A layer holds 256 x 256 texels, then its mip levels down to one texel, in one row.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.scalars import f4, i4, u4

__all__ = ["coverage", "level_of", "texel"]


@inlined_kernel
def level_of(texels_squared: float) -> int:
    """Return the mip level, 0 to 8, from the squared number of texels that a pixel spans."""
    level = 0
    limit = f4(2.0)
    while level < 8 and texels_squared > limit:
        level += 1
        limit *= f4(4.0)
    return level


@inlined_kernel
def _fraction(x: float) -> float:
    """Return the fractional part of a number; truncation is faster than rounding down."""
    part = x - f4(i4(x))
    return part + f4(1.0) if part < f4(0.0) else part


@inlined_kernel
def _first_texel(level: int) -> int:
    """Return the first texel of a level: 65536 + 16384 + ... = (4^9 - 4^(9 - level)) / 3."""
    return (262144 - (262144 >> (2 * level))) // 3


@inlined_kernel
def texel(textures: NDArray[np.uint32], layer: int, level: int, u: float, v: float) -> int:
    """Return the texel at (u, v) [tiles], blended from the four around it, packed as they are.

    Two bytes are blended with one multiplication: weights are 0 to 256 and sum to 256, so the
    lower product cannot reach the upper byte.
    """
    bits = 8 - level
    size = f4(1 << bits)
    x = _fraction(u) * size + (size - f4(0.5))
    y = _fraction(v) * size + (size - f4(0.5))
    column, row = u4(x), u4(y)
    across = u4((x - f4(column)) * f4(256.0))
    down = u4((y - f4(row)) * f4(256.0))
    mask = u4((1 << bits) - 1)
    first = u4(_first_texel(level))
    upper = first + ((row & mask) << u4(bits))
    lower = first + (((row + u4(1)) & mask) << u4(bits))
    left, right = column & mask, (column + u4(1)) & mask
    both = (across * down) >> u4(8)
    w01, w10 = across - both, down - both
    w00 = u4(256) - across - down + both
    a, b = textures[layer, upper + left], textures[layer, upper + right]
    c, d = textures[layer, lower + left], textures[layer, lower + right]
    even = u4(0x00FF00FF)
    low = w00 * (a & even) + w01 * (b & even) + w10 * (c & even) + both * (d & even)
    eight = u4(8)
    high = (
        w00 * ((a >> eight) & even)
        + w01 * ((b >> eight) & even)
        + w10 * ((c >> eight) & even)
        + both * ((d >> eight) & even)
    )
    return u4(((low >> eight) & even) | (high & u4(0xFF00FF00)))


@inlined_kernel
def coverage(textures: NDArray[np.uint32], layer: int, level: int, u: float, v: float) -> int:
    """Return the alpha, 0 to 255, of the texel at (u, v)."""
    bits = 8 - level
    size = f4(1 << bits)
    mask = (1 << bits) - 1
    column = int(_fraction(u) * size) & mask
    row = int(_fraction(v) * size) & mask
    return u4(textures[layer, _first_texel(level) + (row << bits) + column] >> u4(24))
