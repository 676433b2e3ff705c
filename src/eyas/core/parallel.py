"""Parallel kernels: one loop over workers for all of them, and arguments that are found by address.

numba's own way, `parallel=True` on each kernel, compiles all that the kernel calls three times
(half a minute for the renderer), and unpacks every array at every call (a tenth of a small
picture's time). Here the parallel loop is compiled alone and knows a kernel by its address only.
"""

import threading
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from eyas.core.intrinsics import call, layout_of, size_of, store
from eyas.core.jit import KERNEL_SETTINGS, kernel, prange

__all__ = ["Held", "Pointer", "parallel_kernel"]

Bundle = TypeVar("Bundle")
Pointee = TypeVar("Pointee", covariant=True)


class Pointer(Protocol[Pointee]):
    """How a parallel kernel sees a bundle: `pointer[0]`."""

    def __getitem__(self, index: int) -> Pointee: ...


class Held(Generic[Bundle]):
    """A tuple of numbers, arrays and tuples of them, laid out once as kernels read it.

    Args:
        bundle: Its arrays are not copied: what is written into them later, kernels see.
    """

    __slots__ = ("_memory", "address", "bundle", "layout")

    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self._memory = np.empty(4096, np.uint8)
        self.layout = _lay_out(bundle, self._memory)
        if self.layout < 0:
            self._memory = np.empty(-self.layout, np.uint8)
            self.layout = _lay_out(bundle, self._memory)
        self.address = self._memory.ctypes.data


_ONE_AT_A_TIME = threading.Lock()


class parallel_kernel(Generic[Bundle]):  # noqa: N801  # a decorator like `kernel`
    """Compile a function that does the share of one worker, and call it for all workers at once.

    numba's workqueue layer, the one that survives forking, must not be entered from two Python
    threads at once, so calls wait for each other.

    Args:
        function: Called with `parts`, `worker` and `workers`; `parts[0]` has a pointer for each
            bundle, `parts[0][i][0]` is the bundle itself.
    """

    def __init__(self, function: Callable[[Pointer[Bundle], int, int], None]) -> None:
        self.__doc__ = function.__doc__
        self.function = function
        self._compiled: dict[tuple[int, ...], Any] = {}

    def __call__(self, workers: int, *parts: Held[Any]) -> None:
        """Run the shares of all workers and wait for them."""
        layouts = tuple([part.layout for part in parts])
        table = np.array([part.address for part in parts], np.int64)
        with _ONE_AT_A_TIME:
            if layouts not in self._compiled:
                self._compiled[layouts] = self._compile(parts)
            _run(self._compiled[layouts].address, table.ctypes.data, workers)

    def _compile(self, parts: tuple[Held[Any], ...]) -> Any:  # noqa: ANN401  # numba has no types
        pointers = [numba.types.CPointer(numba.typeof(part.bundle)) for part in parts]
        table = numba.types.CPointer(numba.types.Tuple(pointers))
        signature = numba.void(table, numba.intp, numba.intp)
        return numba.cfunc(signature, **KERNEL_SETTINGS)(self.function)


@kernel
def _lay_out(bundle: object, memory: NDArray[np.uint8]) -> int:
    """Write a bundle into memory and return its layout, or minus the bytes it needs."""
    size: int = size_of(bundle)
    if len(memory) < size:
        return -size
    store(memory, bundle)
    layout: int = layout_of(bundle)
    return layout


@numba.njit(cache=True, parallel=True)
def _run(function: int, table: int, workers: int) -> None:
    for worker in prange(workers):
        call(function, table, worker, workers)
