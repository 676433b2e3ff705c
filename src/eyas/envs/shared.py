"""Observations in memory that several processes share."""

from ctypes import Array as CArray
from ctypes import c_ubyte
from multiprocessing.sharedctypes import RawArray
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.envs.observation import Observation

__all__ = ["SharedObservations"]


class _Part(NamedTuple):
    """A part of the observations, in bytes: ctypes has not all types of numpy."""

    memory: "CArray[c_ubyte]"
    dtype: str
    shape: tuple[int, ...]

    def of(self, rows: slice) -> NDArray[Any]:
        whole = np.frombuffer(memoryview(self.memory), np.dtype(self.dtype))
        part: NDArray[Any] = whole.reshape(self.shape)[rows]
        return part


class SharedObservations:
    """Observations of N environments. It can be given to processes when they are started.

    The memory has no name in the file system, so whatever ends the processes, nothing is left.

    Args:
        space: Space of one observation.
        count: N.
    """

    # It does not keep the space, whose limits are as large as pictures: a process that fails while
    # it starts is waited for in vain if it was to read more than a pipe holds.
    def __init__(self, space: gymnasium.Space[Any], count: int) -> None:
        self._several = isinstance(space, gymnasium.spaces.Dict)
        spaces = space.spaces if isinstance(space, gymnasium.spaces.Dict) else {"": space}
        self._parts = {name: _part(own, count) for name, own in spaces.items()}

    def of(self, rows: slice) -> Observation:
        """Return the observations of some environments, in arrays that are the shared memory."""
        arrays = {name: part.of(rows) for name, part in self._parts.items()}
        return arrays if self._several else arrays[""]


def _part(space: gymnasium.Space[Any], count: int) -> _Part:
    assert space.shape is not None
    dtype, shape = np.dtype(space.dtype), (count, *space.shape)
    return _Part(RawArray(c_ubyte, int(np.prod(shape)) * dtype.itemsize), dtype.str, shape)
