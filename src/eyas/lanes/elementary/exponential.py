"""Exponentials, logarithms, powers and the hyperbolic tangent.

The polynomials of `exp` and `log` are those of fdlibm (Sun Microsystems, 1993: `e_exp.c`,
`e_log.c`), those of `tanh` near 0 of Cephes (Moshier, Methods and Programs for Mathematical
Functions, 1989).
"""

import math

from eyas.lanes.elementary.exact import product_error
from eyas.lanes.intrinsics import bits_of_float, float_of_bits
from eyas.lanes.jit import kernel

_LN2, _LN2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_BY_LN2 = 1.44269504088896338700e00
_ROUND = 6755399441055744.0  # 1.5 * 2^52: added and taken off again, it leaves a whole number

_E1, _E2, _E3 = 1.66666666666666019037e-01, -2.77777777770155933842e-03, 6.61375632143793436117e-05
_E4, _E5 = -1.65339022054652515390e-06, 4.13813679705723846039e-08

_L1, _L2, _L3 = 6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01
_L4, _L5, _L6 = 2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01
_L7 = 1.479819860511658591e-01

_TP0, _TP1, _TP2 = -9.64399179425052238628e-1, -9.92877231001918586564e1, -1.61468768441708447952e3
_TQ0, _TQ1, _TQ2 = 1.12811678491632931402e2, 2.23548839060100448583e3, 4.84406305325125486048e3

# Factors of the series 2 s + 2/3 s^3 + 2/5 s^5 + ...: the second as a sum, the later ones reversed.
_TWO_THIRDS, _TWO_THIRDS_REST = 2.0 / 3.0, 2.0 / 3.0 * 2.0**-54
_LATER = tuple(2.0 / k for k in range(27, 3, -2))

_LARGEST, _SMALLEST = 710.0, -746.0  # Above, `exp` is infinite; below, it is 0


@kernel(inline=True)
def _power_of_two(exponent: int) -> float:
    """Return 2^exponent, for -1022 to 1023."""
    power: float = float_of_bits((exponent + 1023) << 52)
    return power


@kernel(inline=True)
def _parts(x: float, tail: float) -> tuple[int, float, float]:
    """Return exp(x + tail) as 2^whole * (high + low)."""
    whole = (x * _BY_LN2 + _ROUND) - _ROUND
    high = x - whole * _LN2
    low = whole * _LN2_REST - tail
    r = high - low
    z = r * r
    c = r - z * (_E1 + z * (_E2 + z * (_E3 + z * (_E4 + z * _E5))))
    most = 1.0 + high
    return int(whole), most, ((1.0 - most) + high) + (r * c / (2.0 - c) - low)


@kernel(inline=True)
def _scaled(whole: int, value: float) -> float:
    """Return value * 2^whole, rounded once."""
    half = whole >> 1
    return value * _power_of_two(half) * _power_of_two(whole - half)


@kernel(double=True)
def exp(x: float) -> float:
    """Return e^x."""
    if x != x:
        return x
    whole, high, low = _parts(min(max(x, _SMALLEST), _LARGEST), 0.0)
    return _scaled(whole, high + low)


@kernel(inline=True)
def _normal(x: float) -> tuple[int, float]:
    """Return x, positive and finite, as 2^whole times a number near 1: root 1/2 to root 2."""
    more = 0
    if x < 2.3e-308:  # stored with fewer digits
        x, more = x * 2.0**54, -54
    bits = bits_of_float(x)
    whole = (bits >> 52) - 1023
    near = float_of_bits((bits & 0xFFFFFFFFFFFFF) | 0x3FF0000000000000)
    if near > 1.4142135623730951:
        whole, near = whole + 1, 0.5 * near
    return whole + more, near


@kernel(inline=True)
def _log_series(z: float) -> float:
    """Return (log(1 + f) - 2 s) / s for s = f / (2 + f), whose square is z."""
    w = z * z
    even = w * (_L2 + w * (_L4 + w * _L6))
    return z * (_L1 + w * (_L3 + w * (_L5 + w * _L7))) + even


@kernel(double=True)
def log(x: float) -> float:
    """Return the natural logarithm; -inf of 0, and nan below."""
    if not 0.0 < x < math.inf:
        return _log_at_ends(x)
    whole, near = _normal(x)
    f = near - 1.0
    s = f / (2.0 + f)
    half = 0.5 * f * f
    rest = s * (half + _log_series(s * s)) + whole * _LN2_REST
    return whole * _LN2 - ((half - rest) - f)


@kernel
def _log_at_ends(x: float) -> float:
    if x == 0.0:
        return -math.inf
    return x if x > 0.0 else math.nan


@kernel(inline=True)
def _log_parts(x: float) -> tuple[float, float]:
    """Return the logarithm of x, positive and finite, as a sum."""
    whole, near = _normal(x)
    f = near - 1.0
    d = 2.0 + f
    d_rest = f - (d - 2.0)
    s = f / d
    product = s * d
    s_rest = (((f - product) - product_error(s, d, product)) - s * d_rest) / d
    # log(1 + f) = 2 s + 2/3 s^3 + ...: the second term as a sum too, the others as one number.
    z = s * s
    z_rest = product_error(s, s, z) + 2.0 * s * s_rest
    cube = z * s
    cube_rest = product_error(z, s, cube) + z_rest * s + z * s_rest
    third = cube * _TWO_THIRDS
    third_rest = product_error(cube, _TWO_THIRDS, third)
    third_rest += cube * _TWO_THIRDS_REST + cube_rest * _TWO_THIRDS
    later = 0.0
    for factor in _LATER:
        later = later * z + factor
    later *= z * cube
    high, low = _added(2.0 * s, third)
    low += 2.0 * s_rest + (third_rest + later)
    total, rest = _added(whole * _LN2, high)
    return _added(total, rest + (low + whole * _LN2_REST))


@kernel(inline=True)
def _added(a: float, b: float) -> tuple[float, float]:
    """Return the exact sum of two numbers as a sum (Knuth's)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@kernel(double=True)
def power(base: float, exponent: float) -> float:
    """Return base^exponent for a base that is not negative; nan for others.

    Anything to the power 0, and 1 to any power, is 1.
    """
    if exponent == 0.0 or base == 1.0:
        return 1.0
    if not (0.0 < base < math.inf and abs(exponent) < math.inf):
        return _power_at_ends(base, exponent)
    if abs(exponent) > 1e19:  # no base is so near to 1
        return math.inf if (base > 1.0) == (exponent > 0.0) else 0.0
    high, low = _log_parts(base)
    product = exponent * high
    if product > _LARGEST:
        return math.inf
    if product < _SMALLEST:
        return 0.0
    rest = product_error(exponent, high, product) + exponent * low
    whole, high, low = _parts(product, rest)
    return _scaled(whole, high + low)


@kernel
def _power_at_ends(base: float, exponent: float) -> float:
    if base != base or exponent != exponent or base < 0.0:
        return math.nan
    return math.inf if (base > 1.0) == (exponent > 0.0) else 0.0


@kernel(double=True)
def tanh(x: float) -> float:
    """Return the hyperbolic tangent."""
    size = abs(x)
    if size < 0.625:
        z = x * x
        p = _TP2 + z * (_TP1 + z * _TP0)
        q = _TQ2 + z * (_TQ1 + z * (_TQ0 + z))
        return math.copysign(size + size * (z * p / q), x)
    if size > 22.0:
        return math.copysign(1.0, x)
    if x != x:
        return x
    whole, high, low = _parts(2.0 * size, 0.0)
    scale = _power_of_two(whole)
    grown = scale * (high + low)
    grown_rest = scale * ((high - (high + low)) + low)
    below = grown + 1.0
    below_rest = (1.0 - (below - grown)) + grown_rest
    share = 2.0 / below
    product = share * below
    share_rest = ((2.0 - product) - product_error(share, below, product)) - share * below_rest
    value = 1.0 - share
    value += ((1.0 - value) - share) - share_rest / below
    return math.copysign(value, x)
