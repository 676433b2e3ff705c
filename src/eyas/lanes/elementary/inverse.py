"""Angles from their sines, cosines and tangents.

The polynomials are those of fdlibm (Sun Microsystems, 1993: `e_asin.c`, `s_atan.c`).
"""

import math

from eyas.lanes.elementary.exact import leading, product_error
from eyas.lanes.jit import kernel

_QUARTER, _QUARTER_REST = 1.57079632679489655800e00, 6.12323399573676603587e-17
_EIGHTH, _EIGHTH_REST = 7.85398163397448278999e-01, 3.06161699786838301793e-17
_HALF, _HALF_REST = 3.14159265358979311600e00, 1.22464679914735317723e-16
_ATAN_OF_HALF, _ATAN_OF_HALF_REST = 4.63647609000806093515e-01, 2.26987774529616870924e-17

_P0, _P1, _P2 = 1.66666666666666657415e-01, -3.25565818622400915405e-01, 2.01212532134862925881e-01
_P3, _P4, _P5 = -4.00555345006794114027e-02, 7.91534994289814532176e-04, 3.47933107596021167570e-05
_Q1, _Q2 = -2.40339491173441421878e00, 2.02094576023350569471e00
_Q3, _Q4 = -6.88283971605453293030e-01, 7.70381505559019352791e-02

_A0, _A1, _A2 = 3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01
_A3, _A4, _A5 = -1.11111104054623557880e-01, 9.09088713343650656196e-02, -7.69187620504482999495e-02
_A6, _A7, _A8 = 6.66107313738753120669e-02, -5.83357013379057348645e-02, 4.97687799461593236017e-02
_A9, _A10 = -3.65315727442169155270e-02, 1.62858201153657823623e-02


@kernel(inline=True)
def _bend(z: float) -> float:
    """Return how much longer an arc is than its sine, as a share of the sine, whose square is z."""
    p = z * (_P0 + z * (_P1 + z * (_P2 + z * (_P3 + z * (_P4 + z * _P5)))))
    q = 1.0 + z * (_Q1 + z * (_Q2 + z * (_Q3 + z * _Q4)))
    return p / q


@kernel(inline=True)
def _arc_near_quarter(x: float) -> tuple[float, float]:
    """Return half the arc whose cosine is x, 0.5 to 1, as a sum."""
    z = 0.5 * (1.0 - x)
    root = math.sqrt(z)
    high = leading(root)
    low = (z - high * high) / (root + high) if z > 0.0 else 0.0
    return high, root * _bend(z) + low


@kernel(double=True)
def asin(x: float) -> float:
    """Return the angle of a sine, -pi/2 to pi/2 [rad]; nan beyond -1 to 1."""
    size = abs(x)
    if not size <= 1.0:
        return math.nan
    if size < 0.5:
        return x + x * _bend(x * x)
    high, low = _arc_near_quarter(size)
    # An eighth of a turn at a time: it is close to twice `high`, so nothing is lost.
    angle = _EIGHTH - ((2.0 * low - _QUARTER_REST) - (_EIGHTH - 2.0 * high))
    return -angle if x < 0.0 else angle


@kernel(double=True)
def acos(x: float) -> float:
    """Return the angle of a cosine, 0 to pi [rad]; nan beyond -1 to 1."""
    size = abs(x)
    if not size <= 1.0:
        return math.nan
    if size < 0.5:
        return _QUARTER - (x - (_QUARTER_REST - x * _bend(x * x)))
    high, low = _arc_near_quarter(size)
    if x > 0.0:
        return 2.0 * (high + low)
    return 2.0 * (_QUARTER - (high + (low - _QUARTER_REST)))


@kernel(double=True)
def atan(x: float) -> float:
    """Return the angle of a tangent, -pi/2 to pi/2 [rad]."""
    return atan2(x, 1.0)


@kernel(double=True)
def atan2(y: float, x: float) -> float:
    """Return the direction of a vector, counter-clockwise from x, -pi to pi [rad].

    Zeros and infinities as in the standard of C: their signs count.
    """
    if not (abs(x) < math.inf and abs(y) < math.inf):
        return _direction_at_infinity(y, x)
    wide, tall = abs(x), abs(y)
    steep = tall > wide
    long, short = (tall, wide) if steep else (wide, tall)
    if long > 1e290 or long < 1e-290:  # so that no product is too large or too small
        factor = 2.0**-600 if long > 1.0 else 2.0**600
        long, short = factor * long, factor * short
    angle, rest = _angle_of_slope(short, long)
    left = math.copysign(1.0, x) < 0.0
    if steep:
        sign = 1.0 if left else -1.0
        angle, rest = _sum(_QUARTER, _QUARTER_REST, sign * angle, sign * rest)
    elif left:
        angle, rest = _sum(_HALF, _HALF_REST, -angle, -rest)
    return math.copysign(angle + rest, y)


@kernel(inline=True)
def _sum(a: float, a_rest: float, b: float, b_rest: float) -> tuple[float, float]:
    """Return a sum of two sums, where a is the larger."""
    total = a + b
    return total, (b - (total - a)) + (a_rest + b_rest)


@kernel(inline=True)
def _angle_of_slope(short: float, long: float) -> tuple[float, float]:
    """Return the angle of short over long, which is the larger, as a sum; 0 if both are 0."""
    base, base_rest, t, rest = 0.0, 0.0, 0.0, 0.0
    if 16.0 * short < 7.0 * long:
        t = short / long
        if t > 1e-9:
            product = t * long
            rest = ((short - product) - product_error(t, long, product)) / long
    elif 16.0 * short < 11.0 * long:
        base, base_rest = _ATAN_OF_HALF, _ATAN_OF_HALF_REST
        t = (2.0 * short - long) / (2.0 * long + short)
    elif long > 0.0:
        base, base_rest = _EIGHTH, _EIGHTH_REST
        t = (short - long) / (short + long)
    z = t * t
    w = z * z
    even = z * (_A0 + w * (_A2 + w * (_A4 + w * (_A6 + w * (_A8 + w * _A10)))))
    odd = w * (_A1 + w * (_A3 + w * (_A5 + w * (_A7 + w * _A9))))
    bend = t * (even + odd)
    if base == 0.0:
        return t, rest - bend
    return _sum(base, base_rest, t, -bend)


@kernel
def _direction_at_infinity(y: float, x: float) -> float:
    """Return the direction of a vector with an infinite part, or nan."""
    if x != x or y != y:
        return math.nan
    angle = _QUARTER
    if not abs(x) < math.inf:
        angle = _EIGHTH if not abs(y) < math.inf else 0.0
        if x < 0.0:
            angle = _HALF - angle
    return math.copysign(angle, y)
