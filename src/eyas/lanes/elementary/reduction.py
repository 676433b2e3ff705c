"""Angles brought to an eighth of a turn: the quarter turns taken off, and what is left.

Angles below 10^6 take off multiples of pi/2, which is given in parts of 33 bits (Cody and Waite,
Software Manual for the Elementary Functions, 1980; the parts are those of fdlibm's
`e_rem_pio2.c`). For larger ones only those digits of 2/pi are multiplied that matter (Payne and
Hanek, Radian reduction for trigonometric functions, SIGNUM Newsletter 18, 1983).
"""

import math

import numpy as np

from eyas.lanes.elementary.exact import product_error
from eyas.lanes.intrinsics import bits_of_float
from eyas.lanes.jit import kernel

_EIGHTH = 0.25 * math.pi
_TO_QUARTERS = 6.36619772367581382433e-01
_ROUND = 6755399441055744.0  # 1.5 * 2^52: added and taken off again, it leaves a whole number

# pi/2 is the sum of the first parts so far and the rest after the last of them.
_FIRST, _FIRST_REST = 1.57079632673412561417e00, 6.07710050650619224932e-11
_SECOND, _SECOND_REST = 6.07710050630396597660e-11, 2.02226624879595063154e-21
_THIRD, _THIRD_REST = 2.02226624871116645580e-21, 8.47842766036889956997e-32

_QUARTER, _QUARTER_REST = 1.57079632679489655800e00, 6.12323399573676603587e-17

_DIGIT = 28
_MASK = (1 << _DIGIT) - 1

_DIGITS = (
    "A2F9836E4E441529FC2757D1F534DDC0DB6295993C439041FE5163ABDEBBC561B7246E3A424DD2E00649"
    "2EEA09D1921CFE1DEB1CB129A73EE88235F52EBB4484E99C7026B45F7E413991D639835339F49C845F8B"
    "BDF9283B1FF897FFDE05980FEF2F118B5A0A6D1F6D367ECF27CB09B74F463F669E5FEA2D7527BAC7EBE5"
    "F17B3D0739F78A5292EA6BFB5FB11F8D5D0856033046FC7B6BABF0CFBC209AF4361DA9"
)
"""The first 1288 binary digits of 2/pi, in hexadecimal notation."""

_LEADING_ZEROS = 2
_TWO_BY_PI = np.array(
    [0] * _LEADING_ZEROS + [int(_DIGITS[k : k + 7], 16) for k in range(0, len(_DIGITS), 7)],
    np.int64,
)
"""The same, 28 in a number, after some numbers of zeros."""


@kernel(inline=True)
def reduced(angle: float) -> tuple[int, float, float]:
    """Return how many quarter turns are taken off, modulo 4, and the sum of what is left.

    What is left is at most slightly more than an eighth of a turn [rad], and known to 2^-70 of
    itself. An infinite angle leaves nan.
    """
    if abs(angle) <= _EIGHTH:
        return 0, angle, 0.0
    if not abs(angle) < 1e6:
        return _far_reduced(angle)
    turns = (angle * _TO_QUARTERS + _ROUND) - _ROUND
    once = angle - turns * _FIRST
    part = turns * _SECOND
    left = once - part
    rest = turns * _SECOND_REST - ((once - left) - part)
    high = left - rest
    if abs(high) < 1e-8:  # nearly a multiple of a quarter: most digits have gone
        part = turns * _THIRD
        once, left = left, left - part
        rest = turns * _THIRD_REST - ((once - left) - part)
        high = left - rest
    return int(turns) & 3, high, (left - high) - rest


@kernel(inline=False)
def _far_reduced(angle: float) -> tuple[int, float, float]:
    """Return the same for an angle of at least 2^19."""
    if not abs(angle) < math.inf:
        return 0, math.nan, 0.0
    bits = bits_of_float(abs(angle))
    exponent = (bits >> 52) - 1075
    whole = (bits & 0xFFFFFFFFFFFFF) | 0x10000000000000
    low, high = whole & _MASK, whole >> _DIGIT
    # The digits of 2/pi before `exponent - 2` give whole turns. Seven numbers of those after it,
    # the last one first, times the angle; what is carried beyond the first is whole turns too.
    _, d0, carry = _product_digit(low, high, exponent, 6, 0, 0)
    _, d1, carry = _product_digit(low, high, exponent, 5, d0, carry)
    p2, d2, carry = _product_digit(low, high, exponent, 4, d1, carry)
    p3, d3, carry = _product_digit(low, high, exponent, 3, d2, carry)
    p4, d4, carry = _product_digit(low, high, exponent, 2, d3, carry)
    p5, d5, carry = _product_digit(low, high, exponent, 1, d4, carry)
    p6, _, _ = _product_digit(low, high, exponent, 0, d5, carry)
    turns, top = p6 >> 26, p6 & 0x3FFFFFF
    if top >= 1 << 25:
        turns, top = turns + 1, top - (1 << 26)
    first = float((top << _DIGIT) + p5) * 2.0**-54
    second = float(p4) * 2.0**-82
    share = first + second
    rest = (second - (share - first)) + (float(p3) * 2.0**-110 + float(p2) * 2.0**-138)
    left = share * _QUARTER
    tail = product_error(share, _QUARTER, left) + (share * _QUARTER_REST + rest * _QUARTER)
    if angle < 0.0:
        return -turns & 3, -left, -tail
    return turns & 3, left, tail


@kernel(inline=True)
def _product_digit(
    low: int, high: int, exponent: int, place: int, digit_below: int, carry: int
) -> tuple[int, int, int]:
    """Return a number of the product's digits, that of 2/pi it comes from, and what is carried."""
    first = exponent - 2 + _DIGIT * (place + _LEADING_ZEROS)
    at, shift = first // _DIGIT, first % _DIGIT
    pair = (int(_TWO_BY_PI[at]) << _DIGIT) | int(_TWO_BY_PI[at + 1])
    digit = (pair >> (_DIGIT - shift)) & _MASK
    sum_ = low * digit + high * digit_below + carry
    return sum_ & _MASK, digit, sum_ >> _DIGIT
