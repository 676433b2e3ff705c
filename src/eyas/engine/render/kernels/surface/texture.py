"""Textures: level of detail and smooth lookup.

A layer is a sheet of rows of `TEXELS_IN_ROW`: 256 x 256 texels, and below them its mip levels
beside each other, down to one texel. After the last column and row of each level its first is
repeated, so of four texels that are blended two always lie side by side, and two in the next row.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import (
    any_of,
    bit_pattern,
    gather_square,
    greater,
    lesser,
    like,
    select,
    to_f4,
    to_i4,
    to_u4,
)

LEVELS = 9  # Mip levels of a layer

TEXELS_IN_ROW = sum((1 << bits) + 1 for bits in range(LEVELS - 1))
"""Texels in a row of a layer: levels 1 to 8 lie beside each other."""

TEXELS = TEXELS_IN_ROW * (257 + 129)
"""Texels of a layer: the rows of level 0, and below them those of level 1."""

_ROW, _LAYER, _COARSEST = i4(TEXELS_IN_ROW), i4(TEXELS), i4(LEVELS - 1)

_BELOW = i4(257 * TEXELS_IN_ROW)  # Index of the first texel of level 1

LAST_TEXEL = 258 * TEXELS_IN_ROW - 2
"""Index of the only texel of the last level, which with its repetition ends level 1's first row."""

_ONE = i4(0x3F800000)  # The bits of 1.0.


@kernel(inline=True)
def detail_of(texels_squared: float) -> int:
    """Return the level of detail, 0 to 2048, from the squared number of texels that a pixel spans.

    256 steps are one mip level. The exponent of a square grows by two from level to level, and its
    upper bits with the mantissa's are nearly a logarithm.
    """
    steps = to_i4(bit_pattern(texels_squared) - _ONE) >> i4(16)
    return to_i4(lesser(greater(steps, i4(0)), _COARSEST << i4(8)))


@kernel(inline=True)
def fraction(x: float) -> float:
    """Return the fractional part of a number; truncation is faster than rounding down."""
    part = x - to_f4(to_i4(x))
    return part + select(part < f4(0.0), like(x, f4(1.0)), f4(0.0))


@kernel(inline=True)
def first_texel(level: int, side: int) -> int:
    """Return the index in a layer of the first texel of a level with so many texels along a side.

    Left of it lie 129 + 65 + ... = 255 - 2 side + level columns; for level 0 that is negative.
    """
    left = greater(to_i4(level - side - side + i4(255)), i4(0))
    return to_i4(left + select(level > i4(0), like(level, _BELOW), i4(0)))


@kernel(inline=True)
def texel(
    textures: NDArray[np.uint32], layer: int, detail: int, blend: bool, u: float, v: float
) -> tuple[int, int]:
    """Return the colour at (u, v) [tiles], blended from the four texels around it.

    Args:
        textures: See `Geometry.texture`.
        layer: Which of them.
        detail: From `detail_of`.
        blend: Whether to blend two mip levels where none of them is near, so that no line is seen
            where they meet; one answer for all lanes.
        u: Texture coordinates [tiles].
        v: Texture coordinates [tiles].

    Returns:
        Red and blue in bits 0 to 7 and 16 to 23 of a number, green and alpha in those of another;
        the bits between are not zero.
    """
    level = to_i4(detail + i4(128)) >> i4(8)
    low, high = _of_level(textures, layer, level, u, v)
    if blend:
        away = detail - (level << i4(8))
        far = away < i4(0)
        # Up to 3/8 from a level, that one is as good as a blend; half-way, half of each.
        part = to_i4(greater((select(far, -away, away) << i4(2)) - i4(384), i4(0)))
        if any_of(part > i4(0)):
            other = level + select(far, like(level, i4(-1)), i4(1))
            other_low, other_high = _of_level(textures, layer, other, u, v)
            share, even, eight = to_u4(part), u4(0x00FF00FF), u4(8)
            rest = u4(256) - share
            low = to_u4((rest * (low & even) + share * (other_low & even)) >> eight)
            high = to_u4((rest * (high & even) + share * (other_high & even)) >> eight)
    return low, high


@kernel(inline=True)
def _of_level(
    textures: NDArray[np.uint32], layer: int, level: int, u: float, v: float
) -> tuple[int, int]:
    """Return what `texel` does, of one mip level.

    Two bytes are blended with one multiplication: weights are 0 to 256 and sum to 256, so the
    lower product cannot reach the upper byte.
    """
    bits = to_i4(_COARSEST - level)
    one = like(level, i4(1))
    side = to_i4(one << bits)
    size = to_f4(side)
    x = fraction(u) * size + (size - f4(0.5))
    y = fraction(v) * size + (size - f4(0.5))
    column, row = to_i4(x), to_i4(y)
    across = to_u4(to_i4((x - to_f4(column)) * f4(256.0)))
    down = to_u4(to_i4((y - to_f4(row)) * f4(256.0)))
    mask = to_i4(side - i4(1))
    first = to_i4(first_texel(level, side) + layer * _LAYER)
    at = to_i4(first + (row & mask) * _ROW + (column & mask))
    a, b, c, d = gather_square(textures, at, TEXELS_IN_ROW)
    even, eight = u4(0x00FF00FF), u4(8)
    both = to_u4(to_u4(across * down) >> eight)
    w01, w10 = to_u4(across - both), to_u4(down - both)
    w00 = to_u4(u4(256) - across - w10)
    low = to_u4(w00 * (a & even) + w01 * (b & even) + w10 * (c & even) + both * (d & even))
    high = to_u4(
        w00 * ((a >> eight) & even)
        + w01 * ((b >> eight) & even)
        + w10 * ((c >> eight) & even)
        + both * ((d >> eight) & even)
    )
    return to_u4(low >> eight), to_u4(high >> eight)


@kernel(inline=True)
def colour_of(low: int, high: int) -> tuple[float, float, float, float]:
    """Return the linear colour and the alpha, 0 to 1, of a texel as `texel` returns it.

    Textures hold square roots of linear colours.
    """
    scale, byte, half = f4(1.0 / 255.0), u4(255), u4(16)
    red, green = to_f4(to_i4(low & byte)) * scale, to_f4(to_i4(high & byte)) * scale
    blue = to_f4(to_i4((low >> half) & byte)) * scale
    alpha = to_f4(to_i4((high >> half) & byte)) * scale
    return red * red, green * green, blue * blue, alpha
