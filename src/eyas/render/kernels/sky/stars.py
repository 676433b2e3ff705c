"""Stars: at most one in each cell of the sky, always the same."""

from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, like, magnitude, root, select, to_f4, to_i4, to_u4
from eyas.render.kernels.chance import hashed
from eyas.render.kernels.scalars import f4, u4

__all__ = ["starlight"]

_ROWS = f4(72.0)
"""Rows of cells from the horizon to the zenith, of equal area."""

_COLUMNS = f4(80.0)
"""Columns of cells in a quarter of the horizon."""

_SIZE = f4(0.0011)
"""Radius to which the brightness of stars refers [rad]; wider pixels dim them."""


@kernel(inline=True)
def starlight(x: float, y: float, z: float, around: float, pixel: float) -> tuple[float, float]:
    """Return the radiance of the star in a direction of length 1, and its tint: red above 0.

    Each cell's hash says where its star stands and how bright it is: few are bright, most cells
    have one too faint to see.

    Args:
        x: The direction.
        y: The direction.
        z: The direction.
        around: Its `azimuth`.
        pixel: Angle that a pixel spans [rad].
    """
    zero, one, unit, byte = f4(0.0), f4(1.0), f4(1.0 / 255.0), u4(255)
    column, row = to_i4(around * _COLUMNS), to_i4(greater(z, zero) * _ROWS)
    bits = hashed(to_u4(column), to_u4(row), like(to_u4(row), u4(0x57A2)))
    # Not too near to the cell's edge, where the star would be cut.
    aside = f4(0.25) + f4(0.5 / 255.0) * to_f4(bits & byte)
    over = f4(0.25) + f4(0.5 / 255.0) * to_f4((bits >> u4(8)) & byte)
    turn, high = (to_f4(column) + aside) / _COLUMNS, (to_f4(row) + over) / _ROWS
    east = magnitude(turn - f4(2.0)) - one
    north = select(turn < f4(3.0), one - magnitude(turn - one), turn - f4(4.0))
    flat = root((one - high * high) / (east * east + north * north))
    dx, dy, dz = x - east * flat, y - north * flat, z - high
    radius = greater(like(x, _SIZE), f4(0.62) * pixel)
    near = greater(one - (dx * dx + dy * dy + dz * dz) / (radius * radius), zero)
    rank = to_f4((bits >> u4(16)) & byte) * unit
    rank *= rank
    rank *= rank
    dim = _SIZE / radius
    tint = f4(0.3) * to_f4((bits >> u4(24)) & u4(127)) * f4(1.0 / 127.0) - f4(0.15)
    return lesser(f4(0.9) * rank * rank * rank * near * dim, one), tint
