"""Pictures of the whole sky round a viewer, looked up by direction.

Columns go round the horizon by a measure of azimuth that needs no trigonometry: along the
square |x| + |y| = 1, from 0 in the east over 1 in the north to 4. Rows start at the horizon. The
value of a column or row is that at its centre.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.scalars import f4, u4

__all__ = ["azimuth", "panorama"]


@inlined_kernel
def azimuth(x: float, y: float) -> float:
    """Return the azimuth of the direction (x, y), 0 to 4."""
    share = y / (abs(x) + abs(y) + f4(1e-9))
    if x < f4(0.0):
        share = f4(2.0) - share
    elif y < f4(0.0):
        share += f4(4.0)
    return share


@inlined_kernel
def panorama(values: NDArray[np.uint8], row: float, around: float, channel: int) -> float:
    """Return a channel, 0 to 1, interpolated between the four nearest values.

    Args:
        values: Shape (rows, columns, channels); the number of columns is a power of 2.
        row: From -0.5; below the first and above the last row it is the row's.
        around: See `azimuth`.
        channel: Index of the channel.
    """
    rows, columns = values.shape[0], values.shape[1]
    row = min(max(row, f4(0.0)), f4(rows - 1))
    # One round on: above 0, where cutting off is rounding down.
    column = (around * f4(0.25) + f4(1.0)) * f4(columns) - f4(0.5)
    low, left = u4(row), u4(column)
    up, across = row - f4(low), column - f4(left)
    last, one = u4(rows - 1), u4(1)
    high, mask = min(low + one, last), u4(columns - 1)
    left, right = left & mask, (left + one) & mask
    a, b = f4(values[low, left, channel]), f4(values[low, right, channel])
    c, d = f4(values[high, left, channel]), f4(values[high, right, channel])
    lower, upper = a + across * (b - a), c + across * (d - c)
    return f4((lower + up * (upper - lower)) * f4(1.0 / 255.0))
