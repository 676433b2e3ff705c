"""Pictures of the whole sky round a viewer, looked up by direction.

Columns go round the horizon by a measure of azimuth that needs no trigonometry: along the
square |x| + |y| = 1, from 0 in the east over 1 in the north to 4. Rows start at the horizon. The
value of a column or row is that at its centre.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import gather, greater, lesser, magnitude, select, to_f4, to_i4
from eyas.render.kernels.scalars import f4, i4

__all__ = ["azimuth", "panorama"]


@kernel(inline=True)
def azimuth(x: float, y: float) -> float:
    """Return the azimuth of the direction (x, y), 0 to 4."""
    share = y / (magnitude(x) + magnitude(y) + f4(1e-9))
    south = select(y < f4(0.0), share + f4(4.0), share)
    return select(x < f4(0.0), f4(2.0) - share, south)


@kernel(inline=True)
def panorama(values: NDArray[np.uint8], row: float, around: float, channel: int) -> float:
    """Return a channel, 0 to 1, interpolated between the four nearest values.

    Args:
        values: Shape (rows, columns, channels); the number of columns is a power of 2.
        row: From -0.5; below the first and above the last row it is the row's.
        around: See `azimuth`.
        channel: Index of the channel.
    """
    rows, columns, channels = values.shape
    row = lesser(greater(row, f4(0.0)), f4(rows - 1))
    # One round on: above 0, where cutting off is rounding down.
    column = (around * f4(0.25) + f4(1.0)) * f4(columns) - f4(0.5)
    low, left = to_i4(row), to_i4(column)
    up, across = row - to_f4(low), column - to_f4(left)
    high, mask = to_i4(lesser(low + i4(1), i4(rows - 1))), i4(columns - 1)
    left, right = left & mask, (left + i4(1)) & mask
    step, first = i4(channels), i4(channel)
    low, high = low * i4(columns), high * i4(columns)
    a = to_f4(gather(values, (low + left) * step + first))
    b = to_f4(gather(values, (low + right) * step + first))
    c = to_f4(gather(values, (high + left) * step + first))
    d = to_f4(gather(values, (high + right) * step + first))
    lower, upper = a + across * (b - a), c + across * (d - c)
    return (lower + up * (upper - lower)) * f4(1.0 / 255.0)
