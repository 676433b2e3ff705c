"""Hash-based noise: numbers that look random but are always the same."""

from eyas.lanes import kernel
from eyas.lanes.vector import any_of, greater, lesser, like, to_f4, to_i4, to_u4
from eyas.render.kernels.scalars import f4, u4

__all__ = ["hashed", "noise", "scrambled", "seen_noise", "tenth"]


@kernel(inline=True)
def scrambled(value: int) -> int:
    """Return a number that looks random, for a number."""
    value = to_u4((value ^ (value >> u4(16))) * u4(0x7FEB352D))
    value = to_u4((value ^ (value >> u4(15))) * u4(0x846CA68B))
    return to_u4(value ^ (value >> u4(16)))


@kernel(inline=True)
def tenth(number: int, bits: int) -> float:
    """Return ten bits of a number as 0 to 1."""
    return float((number >> u4(bits)) & u4(1023)) / 1023.0


@kernel(inline=True)
def hashed(a: int, b: int, c: int) -> int:
    """Return 32 bits that look random, for three numbers."""
    mixed = to_u4(a * u4(0x9E3779B1)) ^ to_u4(b * u4(0x85EBCA77)) ^ to_u4(c * u4(0xC2B2AE3D))
    mixed = to_u4((mixed ^ (mixed >> u4(15))) * u4(0x2C1B3C6D))
    mixed = to_u4((mixed ^ (mixed >> u4(12))) * u4(0x297A2D39))
    return to_u4(mixed ^ (mixed >> u4(15)))


@kernel(inline=True)
def _grain(column: int, row: int) -> float:
    """Return a number, 0 to 1, that looks random, for two hashed coordinates of a cell."""
    mixed = column ^ row
    mixed = to_u4((mixed ^ (mixed >> u4(15))) * u4(0x2C1B3C6D))
    return to_f4((mixed ^ (mixed >> u4(13))) & u4(0xFFFF)) * f4(1.0 / 65535.0)


@kernel(inline=True)
def noise(x: float, y: float) -> float:
    """Return smooth noise, 0 to 1, with cells of one unit."""
    # Moved so that all cells of the land have numbers above 0, where cutting off is rounding down.
    x, y = greater(x + f4(32768.0), f4(0.0)), greater(y + f4(32768.0), f4(0.0))
    column, row = to_i4(x), to_i4(y)
    across, down = x - to_f4(column), y - to_f4(row)
    across *= across * (f4(3.0) - f4(2.0) * across)
    down *= down * (f4(3.0) - f4(2.0) * down)
    left, upper_row = to_u4(to_u4(column) * u4(0x9E3779B1)), to_u4(to_u4(row) * u4(0x85EBCA77))
    right = to_u4(left + u4(0x9E3779B1))
    lower_row = to_u4(upper_row + u4(0x85EBCA77))
    a, b = _grain(left, upper_row), _grain(right, upper_row)
    c, d = _grain(left, lower_row), _grain(right, lower_row)
    upper = a + across * (b - a)
    return upper + down * (c + across * (d - c) - upper)


@kernel(inline=True)
def seen_noise(x: float, y: float, cells: float, footprint: float) -> float:
    """Return noise with some cells in a metre, faded to its mean where a pixel covers them [m]."""
    sharp = greater(f4(1.6) - f4(2.0) * cells * footprint, f4(0.0))
    value = like(x, f4(0.5))
    if any_of(sharp > f4(0.0)):
        value += lesser(sharp, f4(1.0)) * (noise(cells * x, cells * y) - f4(0.5))
    return value
