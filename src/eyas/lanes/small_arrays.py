"""Elementary functions of `eyas.lanes.elementary.arrays`, a fifth as long for small arrays.

To lay out arrays for a kernel takes longer than to copy and to compute a hundred numbers, and
builders call these functions tens of thousands of times. It is not done there, as that room is part
of the language of kernels: whatever changes in it, all have to be compiled anew.
"""

import threading
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes import BoundCall
from eyas.lanes.elementary import arrays

__all__ = [
    "acos",
    "asin",
    "atan",
    "atan2",
    "cos",
    "exp",
    "hypot",
    "log",
    "power",
    "sin",
    "tan",
    "tanh",
]

Floats = NDArray[np.float64]

_ROOMS = (8, 32, 128)
"""Sizes of the arrays that are kept, the least of which that suffices is computed whole."""


class _KeptCall(NamedTuple):
    """A call, and the arrays that it reads and writes."""

    call: BoundCall
    first: Floats
    second: Floats
    result: Floats

    def of(self, first: Floats, second: Floats | None = None) -> Floats:
        """Return the values for arrays of one shape."""
        size = first.size
        self.first[:size] = first.reshape(-1)
        if second is not None:
            self.second[:size] = second.reshape(-1)
        self.call()
        return self.result[:size].reshape(first.shape).copy()


class _KeptCalls(threading.local):
    """The calls of a thread, by function and room."""

    def __init__(self) -> None:
        self._calls: dict[tuple[int, int], _KeptCall] = {}

    def get(self, function: int, size: int) -> _KeptCall:
        room = next(room for room in _ROOMS if size <= room)
        kept = self._calls.get((function, room))
        if kept is None:
            first, second, result = np.zeros((3, room))
            call = arrays.elementary_of_all.bind(function, first, second, result)
            kept = self._calls[function, room] = _KeptCall(call, first, second, result)
        return kept


_kept = _KeptCalls()


class _OfOne:
    """A function of one number."""

    def __init__(self, function: arrays._OfOne) -> None:
        self._large, self._number = function, function._function

    @overload
    def __call__(self, x: float) -> float: ...
    @overload
    def __call__(self, x: NDArray[np.floating]) -> Floats: ...
    def __call__(self, x: ArrayLike) -> Floats | float:
        """Return its value for a number, or for each of an array."""
        if isinstance(x, float | int):
            return self._large(x)
        values = np.asarray(x, np.float64)
        if values.size > _ROOMS[-1]:
            return self._large(values)
        return _kept.get(self._number, values.size).of(values)


class _OfTwo:
    """A function of two numbers."""

    def __init__(self, function: arrays._OfTwo) -> None:
        self._large, self._number = function, function._function

    @overload
    def __call__(self, x: float, y: float) -> float: ...
    @overload
    def __call__(self, x: NDArray[np.floating], y: NDArray[np.floating] | float) -> Floats: ...
    @overload
    def __call__(self, x: float, y: NDArray[np.floating]) -> Floats: ...
    def __call__(self, x: ArrayLike, y: ArrayLike) -> Floats | float:
        """Return its value for two numbers, or for those of two arrays, broadcast."""
        if isinstance(x, float | int) and isinstance(y, float | int):
            return self._large(x, y)
        first, second = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        if first.size > _ROOMS[-1]:
            return self._large(first, second)
        return _kept.get(self._number, first.size).of(first, second)


sin, cos, tan = _OfOne(arrays.sin), _OfOne(arrays.cos), _OfOne(arrays.tan)
asin, acos, atan = _OfOne(arrays.asin), _OfOne(arrays.acos), _OfOne(arrays.atan)
exp, log, tanh = _OfOne(arrays.exp), _OfOne(arrays.log), _OfOne(arrays.tanh)
atan2, hypot, power = _OfTwo(arrays.atan2), _OfTwo(arrays.hypot), _OfTwo(arrays.power)
