"""Elementary functions: right to the last place, and the same compiled, interpreted, in arrays."""

import itertools
import math
import struct

import mpmath
import numpy as np
import pytest

from eyas.lanes import compiled, elementary
from eyas.lanes.elementary import arrays as elementary_arrays
from eyas.lanes.elementary import reduction

from .elementary_points import MPMATH, largest_error, points

SPECIAL = [0.0, 5e-324, 1e-310, 2.2e-308, 1e-160, 0.5, 1.0, 2.0, 1e160, 1e308, math.inf]
SPECIAL = [sign * value for value in SPECIAL for sign in (1.0, -1.0)] + [math.nan]
OF_TWO = ("atan2", "hypot", "power")


def bits(value) -> bytes:
    return b"nan" if math.isnan(value) else struct.pack("<d", value)


def as_math_has_it(name, *arguments):
    try:
        return getattr(math, "pow" if name == "power" else name)(*arguments)
    except OverflowError:
        return math.inf
    except ValueError:
        if name == "log" and arguments[0] == 0.0:
            return -math.inf
        return math.inf if name == "power" and arguments[0] == 0.0 else math.nan


@pytest.mark.parametrize("name", MPMATH)
def test_values_are_within_a_unit_in_the_last_place(name):
    assert largest_error(name, 40_000, seed=1) < 0.9


@pytest.mark.parametrize("name", MPMATH)
def test_at_ends_and_beyond_they_are_as_those_of_math(name):
    of_all = getattr(elementary_arrays, name)
    for values in itertools.product(SPECIAL, repeat=2 if name in OF_TWO else 1):
        if name == "power" and math.copysign(1.0, values[0]) < 0.0:
            continue  # signs of powers of negative numbers are not asked for
        expected, found = as_math_has_it(name, *values), of_all(*values)
        near = abs(found - expected) <= math.ulp(expected)
        assert bits(found) == bits(expected) or near, (values, expected, found)


def test_a_negative_number_has_no_power():
    assert math.isnan(elementary_arrays.power(-2.0, 2.0))
    assert elementary_arrays.power(-2.0, 0.0) == 1.0


@pytest.mark.parametrize("name", MPMATH)
def test_numbers_short_and_long_arrays_get_the_same_bytes(name):
    """Interpreted one by one, or compiled."""
    of_all = getattr(elementary_arrays, name)
    given = points(name, 400, np.random.default_rng(2))
    special = np.array(list(itertools.product(SPECIAL, repeat=2)))
    given = [np.append(a, b) for a, b in zip(given, special.T, strict=False)]
    whole = of_all(*given)
    one_by_one = [of_all(*values) for values in zip(*(a.tolist() for a in given), strict=True)]
    assert list(map(bits, whole.tolist())) == list(map(bits, one_by_one))
    few = of_all(*(a[:4] for a in given))
    assert few.tobytes() == whole[:4].tobytes()


def test_arrays_are_broadcast_and_numbers_give_numbers():
    x, y = np.linspace(-3.0, 3.0, 7), np.linspace(1.0, 2.0, 5, dtype=np.float32)[:, None]
    assert elementary_arrays.atan2(y, x).shape == (5, 7)
    np.testing.assert_allclose(elementary_arrays.atan2(y, x), np.arctan2(y, x), rtol=1e-6)
    assert elementary_arrays.hypot(x, 2.0).shape == (7,)
    assert elementary_arrays.sin(np.zeros((0, 3))).shape == (0, 3)
    assert elementary_arrays.sin(x[::2]).tolist() == elementary_arrays.sin(x).tolist()[::2]
    assert type(elementary_arrays.cos(np.float64(0.5))) is float
    assert type(elementary_arrays.hypot(3, 4.0)) is float


def test_both_of_sine_and_cosine_are_those_alone():
    (angle,) = points("sin", 400, np.random.default_rng(3))
    both = np.array([_sin_cos(value) for value in angle.tolist()])
    np.testing.assert_array_equal(both[:, 0], elementary_arrays.sin(angle))
    np.testing.assert_array_equal(both[:, 1], elementary_arrays.cos(angle))


def _sin_cos(angle):
    from eyas.lanes import interpreted

    return interpreted(elementary.sin_cos)(angle)


def test_digits_of_two_over_pi():
    with mpmath.workprec(1500):
        digits = mpmath.floor(2 / mpmath.pi * mpmath.mpf(2) ** 1288)
    assert int(reduction._DIGITS, 16) == int(digits)


@compiled
def named_otherwise(x, single, out):
    for k in range(len(x)):
        out[k, 0] = math.sin(x[k])
        out[k, 1] = np.cos(x[k])
        out[k, 2] = np.arctan2(x[k], 2)
        out[k, 3] = tanh_of_math(x[k])
        out[k, 4] = elementary.sin(single[k])
        out[k, 5] = elementary.sin_cos(x[k])[0]


tanh_of_math = math.tanh


def test_kernels_that_name_those_of_math_or_numpy_get_these():
    x = np.linspace(-9.0, 9.0, 999)
    single, out = x.astype(np.float32), np.zeros((len(x), 6))
    named_otherwise(x, single, out)
    own = elementary_arrays
    expected = own.sin(x), own.cos(x), own.atan2(x, 2.0), own.tanh(x), own.sin(single), own.sin(x)
    np.testing.assert_array_equal(out.T, expected)
