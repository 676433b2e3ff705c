"""Lengths."""

import math

from eyas.lanes.elementary.exact import leading
from eyas.lanes.jit import kernel


@kernel(inline=True)
def _square(x: float) -> tuple[float, float]:
    """Return a square as a sum (Dekker's product, see `eyas.lanes.elementary.exact`)."""
    square = x * x
    high = leading(x)
    low = x - high
    return square, (high * high - square + 2.0 * high * low) + low * low


@kernel(double=True)
def hypot(x: float, y: float) -> float:
    """Return the length of a vector; infinite if one part is, even if the other is nan."""
    wide, tall = abs(x), abs(y)
    long, short = (tall, wide) if tall > wide else (wide, tall)
    if not (long < 1e150 and short > 1e-140):
        return _hypot_at_ends(long, short)
    return _hypot_of(long, short)


@kernel(inline=True)
def _hypot_of(long: float, short: float) -> float:
    long_square, long_rest = _square(long)
    short_square, short_rest = _square(short)
    total = long_square + short_square
    rest = (long_square - total) + short_square
    return math.sqrt(total + (rest + (long_rest + short_rest)))


@kernel
def _hypot_at_ends(long: float, short: float) -> float:
    """Return the same where squares would be too large or too small."""
    if long == math.inf or short == math.inf:
        return math.inf
    if long != long or short != short:
        return math.nan
    if short < 2.0**-60 * long or short == 0.0:
        return long + short
    if long > 1e100:
        return _hypot_of(long * 2.0**-700, short * 2.0**-700) * 2.0**700
    return _hypot_of(long * 2.0**600, short * 2.0**600) * 2.0**-600
