"""Hash-based noise: numbers that look random but are always the same."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.scalars import f4, u4

__all__ = ["noise", "scrambled", "tenth"]


@inlined_kernel
def scrambled(value: int) -> int:
    """Return a number that looks random, for a number."""
    value = u4((value ^ (value >> u4(16))) * u4(0x7FEB352D))
    value = u4((value ^ (value >> u4(15))) * u4(0x846CA68B))
    return u4(value ^ (value >> u4(16)))


@inlined_kernel
def tenth(number: int, bits: int) -> float:
    """Return ten bits of a number as 0 to 1."""
    return float((number >> u4(bits)) & u4(1023)) / 1023.0


@inlined_kernel
def _grain(column: int, row: int) -> float:
    """Return a number, 0 to 1, that looks random, for a cell of the plane."""
    mixed = u4(u4(column) * u4(0x9E3779B1)) ^ u4(u4(row) * u4(0x85EBCA77))
    mixed = u4((mixed ^ (mixed >> u4(15))) * u4(0x2C1B3C6D))
    return f4((mixed ^ (mixed >> u4(13))) & u4(0xFFFF)) * f4(1.0 / 65535.0)


@inlined_kernel
def noise(x: float, y: float) -> float:
    """Return smooth noise, 0 to 1, with cells of one unit."""
    # Moved so that all cells of the land have numbers above 0, where cutting off is rounding down.
    x, y = max(x + f4(32768.0), f4(0.0)), max(y + f4(32768.0), f4(0.0))
    column, row = u4(x), u4(y)
    across, down = x - f4(column), y - f4(row)
    across *= across * (f4(3.0) - f4(2.0) * across)
    down *= down * (f4(3.0) - f4(2.0) * down)
    right, lower = u4(column + u4(1)), u4(row + u4(1))
    a, b = _grain(column, row), _grain(right, row)
    c, d = _grain(column, lower), _grain(right, lower)
    upper = a + across * (b - a)
    return f4(upper + down * (c + across * (d - c) - upper))
