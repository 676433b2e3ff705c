"""Observations in memory that several processes share."""

from ctypes import Array as CArray
from ctypes import c_ubyte
from multiprocessing.sharedctypes import RawArray
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.envs.observation import Observation

__all__ = ["SharedObservations"]


class SharedObservations:
    """Observations of N environments. It can be given to processes when they are started.

    The memory has no name in the file system, so whatever ends the processes, nothing is left.

    Args:
        space: Space of one observation.
        count: N.
    """

    def __init__(self, space: gymnasium.Space[Any], count: int) -> None:
        self._space, self._count = space, count
        # Arrays of bytes, because ctypes has not all types of numpy.
        self._bytes: dict[str, CArray[c_ubyte]] = {
            part: RawArray(c_ubyte, count * _size(own)) for part, own in self._parts().items()
        }

    def of(self, rows: slice) -> Observation:
        """Return the observations of some environments, in arrays that are the shared memory."""
        arrays = {
            part: np.frombuffer(memoryview(self._bytes[part]), np.dtype(own.dtype)).reshape(
                self._count, *_shape(own)
            )
            for part, own in self._parts().items()
        }
        if isinstance(self._space, gymnasium.spaces.Dict):
            return {part: array[rows] for part, array in arrays.items()}
        only: NDArray[Any] = arrays[""][rows]
        return only

    def _parts(self) -> dict[str, gymnasium.Space[Any]]:
        if isinstance(self._space, gymnasium.spaces.Dict):
            return dict(self._space.spaces)
        return {"": self._space}


def _shape(space: gymnasium.Space[Any]) -> tuple[int, ...]:
    assert space.shape is not None
    return space.shape


def _size(space: gymnasium.Space[Any]) -> int:
    """Return the size of one observation [bytes]."""
    return int(np.prod(_shape(space))) * np.dtype(space.dtype).itemsize
