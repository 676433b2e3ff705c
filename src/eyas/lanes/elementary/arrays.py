"""Elementary functions for Python code, with the same bytes on every processor.

For results that must not depend on the machine: numpy's own functions use the instructions that a
processor has, those of `math` the C library's, and both differ in the last bits. These are the
functions of kernels (`eyas.lanes.elementary`), of arrays and of numbers. They compute in float64,
broadcast as numpy's do, and give a float for numbers. An array of up to 128 elements takes some 3
microseconds, a larger one 15, and 5 to 50 nanoseconds for each element; a number some microseconds.
"""

import threading
from collections.abc import Callable
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes import elementary
from eyas.lanes.calls import BoundCall, compiled
from eyas.lanes.jit import interpreted, kernel

Floats = NDArray[np.float64]

_FUNCTIONS: tuple[Callable[..., float], ...] = (
    elementary.sin,
    elementary.cos,
    elementary.tan,
    elementary.asin,
    elementary.acos,
    elementary.atan,
    elementary.exp,
    elementary.log,
    elementary.tanh,
    elementary.atan2,
    elementary.hypot,
    elementary.power,
)
(_SIN, _COS, _TAN, _ASIN, _ACOS, _ATAN, _EXP, _LOG, _TANH, _ATAN2, _HYPOT, _POWER) = range(12)
_OF_NUMBERS = tuple(interpreted(function) for function in _FUNCTIONS)

_KEPT_SIZES = (8, 32, 128)
"""Lengths of the arrays kept for calls; the shortest that suffices is computed whole."""


@kernel(inline=True)
def _value(function: int, a: float, b: float) -> float:  # a table
    if function == _SIN:
        return elementary.sin(a)
    if function == _COS:
        return elementary.cos(a)
    if function == _TAN:
        return elementary.tan(a)
    if function == _ASIN:
        return elementary.asin(a)
    if function == _ACOS:
        return elementary.acos(a)
    if function == _ATAN:
        return elementary.atan(a)
    if function == _EXP:
        return elementary.exp(a)
    if function == _LOG:
        return elementary.log(a)
    if function == _TANH:
        return elementary.tanh(a)
    if function == _ATAN2:
        return elementary.atan2(a, b)
    if function == _HYPOT:
        return elementary.hypot(a, b)
    return elementary.power(a, b)


@compiled
def elementary_of_all(function: int, first: Floats, second: Floats, result: Floats) -> None:
    """Compute all elements; functions of one number pay no heed to `second`."""
    for k in range(len(result)):
        result[k] = _value(function, first[k], second[k])


class _KeptCall(NamedTuple):
    """A call, and the arrays that it reads and writes."""

    call: BoundCall
    first: Floats
    second: Floats
    result: Floats

    def of(self, first: Floats, second: Floats) -> Floats:
        """Return the values for arrays of one shape."""
        size = first.size
        self.first[:size], self.second[:size] = first.reshape(-1), second.reshape(-1)
        self.call()
        return self.result[:size].reshape(first.shape).copy()


class _KeptCalls(threading.local):
    """The calls of a thread, by function and size.

    To lay out arrays for a kernel takes longer than to copy and to compute a hundred numbers, and
    builders call these functions tens of thousands of times.
    """

    def __init__(self) -> None:
        self._calls: dict[tuple[int, int], _KeptCall] = {}

    def get(self, function: int, size: int) -> _KeptCall:
        length = next(length for length in _KEPT_SIZES if size <= length)
        kept = self._calls.get((function, length))
        if kept is None:
            first, second, result = np.zeros((3, length))
            call = elementary_of_all.bind(function, first, second, result)
            kept = self._calls[function, length] = _KeptCall(call, first, second, result)
        return kept


_kept = _KeptCalls()


def _of_all(function: int, first: Floats, second: Floats) -> Floats:
    """Return the values for arrays of one shape."""
    if first.size <= _KEPT_SIZES[-1]:
        return _kept.get(function, first.size).of(first, second)
    result = np.empty(first.shape)
    # Arrays of one kind, whatever their strides were, so that one kernel serves all.
    flat = (np.array(a).reshape(-1) for a in (first, second))
    elementary_of_all(function, *flat, result.reshape(-1))
    return result


class _OfOne:
    """A function of one number."""

    def __init__(self, function: int) -> None:
        self._function = function

    @overload
    def __call__(self, x: float) -> float: ...
    @overload
    def __call__(self, x: NDArray[np.floating]) -> Floats: ...
    def __call__(self, x: ArrayLike) -> Floats | float:
        """Return its value for a number, or for each of an array."""
        if isinstance(x, float | int):
            return _OF_NUMBERS[self._function](float(x))
        values = np.asarray(x, np.float64)
        return _of_all(self._function, values, values)


class _OfTwo:
    """A function of two numbers."""

    def __init__(self, function: int) -> None:
        self._function = function

    @overload
    def __call__(self, x: float, y: float) -> float: ...
    @overload
    def __call__(self, x: NDArray[np.floating], y: NDArray[np.floating] | float) -> Floats: ...
    @overload
    def __call__(self, x: float, y: NDArray[np.floating]) -> Floats: ...
    def __call__(self, x: ArrayLike, y: ArrayLike) -> Floats | float:
        """Return its value for two numbers, or for those of two arrays, broadcast."""
        if isinstance(x, float | int) and isinstance(y, float | int):
            return _OF_NUMBERS[self._function](float(x), float(y))
        first, second = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        return _of_all(self._function, first, second)


sin = _OfOne(_SIN)  # Sine of angles [rad]
cos = _OfOne(_COS)  # Cosine of angles [rad]
tan = _OfOne(_TAN)  # Tangent of angles [rad]
asin = _OfOne(_ASIN)  # Angles of sines, -pi/2 to pi/2 [rad]; nan beyond -1 to 1
acos = _OfOne(_ACOS)  # Angles of cosines, 0 to pi [rad]; nan beyond -1 to 1
atan = _OfOne(_ATAN)  # Angles of tangents, -pi/2 to pi/2 [rad]
exp = _OfOne(_EXP)  # e to powers
log = _OfOne(_LOG)  # Natural logarithms; -inf of 0, nan below
tanh = _OfOne(_TANH)  # Hyperbolic tangents
atan2 = _OfTwo(_ATAN2)  # Directions of vectors y, x, counter-clockwise from x, -pi to pi [rad]
hypot = _OfTwo(_HYPOT)  # Lengths of vectors x, y
power = _OfTwo(_POWER)  # Bases, which must not be negative, to the power of exponents
