"""Hash-based noise: numbers that look random but are always the same."""

from eyas.engine.render.kernels.scalars import f4, u4
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, greater, lesser, like, to_f4, to_i4, to_u4, whole

_COLUMN, _ROW = u4(0x9E3779B1), u4(0x85EBCA77)
"""Odd factors that spread the numbers of cells over 32 bits."""

_FIRST_COLUMN, _FIRST_ROW = u4(0x3C6EF372), u4(0x6A09E667)
"""What 0 is spread to. Cells on both sides of the one that is spread to 0 are mirrored (the square
of a number is that of its negative); so it lies 350 million cells away from the origin or more."""


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
    """Return a number, -2^31 to 2^31, that looks random, for two hashed coordinates of a cell.

    A square's upper bits depend on all bits of what is squared, so one multiplication mixes enough.
    """
    mixed = column ^ row
    return to_f4(to_i4(mixed * mixed))


@kernel(inline=True)
def swing(x: float, y: float) -> float:
    """Return smooth noise, -0.5 to 0.5, with cells of one unit.

    No point of the land is so far away that a cell's number would not be an int32.
    """
    first, upper = whole(x), whole(y)
    across, down = x - first, y - upper
    across *= across * (f4(3.0) - (across + across))
    down *= down * (f4(3.0) - (down + down))
    left = to_u4(to_u4(to_i4(first)) * _COLUMN + _FIRST_COLUMN)
    above = to_u4(to_u4(to_i4(upper)) * _ROW + _FIRST_ROW)
    right, below = to_u4(left + _COLUMN), to_u4(above + _ROW)
    a, b = _grain(left, above), _grain(right, above)
    c, d = _grain(left, below), _grain(right, below)
    top = a + across * (b - a)
    return f4(2.0**-32) * (top + down * (c + across * (d - c) - top))


@kernel(inline=True)
def noise(x: float, y: float) -> float:
    """Return smooth noise, 0 to 1, with cells of one unit."""
    return swing(x, y) + f4(0.5)


@kernel(inline=True)
def seen_swing(x: float, y: float, cells: float, footprint: float) -> float:
    """Return noise with some cells in a metre, -0.5 to 0.5, faded where a pixel covers them [m]."""
    sharp = f4(1.8) - f4(3.0) * cells * footprint
    value = like(x, f4(0.0))
    if any_of(sharp > f4(0.0)):
        share = lesser(greater(sharp, f4(0.0)), f4(1.0))
        value = share * swing(cells * x, cells * y)
    return value


@kernel(inline=True)
def seen_noise(x: float, y: float, cells: float, footprint: float) -> float:
    """Return what `seen_swing` does, 0 to 1."""
    return f4(0.5) + seen_swing(x, y, cells, footprint)
