"""Parallel kernels: each worker's share runs in a thread, and arguments are passed by address.

numba's own solution, `parallel=True` on each kernel, compiles everything that the kernel calls
three times (half a minute for the renderer), unpacks every array at every call (a tenth of the time
of a small picture), and wakes a thread for each worker while the caller waits (another tenth).
"""

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Generic, Protocol, TypeVar

import numba
import numpy as np
from numpy.typing import NDArray

from eyas.core.intrinsics import layout_of, size_of, store
from eyas.core.jit import KERNEL_SETTINGS, kernel, may_be_kept, thread_count

__all__ = ["BoundKernel", "Held", "Pointer", "parallel_kernel"]

Bundle = TypeVar("Bundle")
Pointee = TypeVar("Pointee", covariant=True)


class Pointer(Protocol[Pointee]):
    """Pointer through which a parallel kernel reads a bundle: `pointer[0]`."""

    def __getitem__(self, index: int) -> Pointee: ...


class Held(Generic[Bundle]):
    """A tuple of numbers, arrays and tuples of them, laid out once in the kernels' memory format.

    Args:
        bundle: The tuple. Its arrays are not copied: kernels see later changes.
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


class _Call:
    """A call with everything that it reads and writes, kept until the last worker is done.

    Attributes:
        turns: A lock for each worker, held while its share is being done.
        left: Workers whose shares have not begun.
    """

    __slots__ = ("_kernel", "_parts", "_table", "left", "turns")

    def __init__(
        self, kernel: Callable[[int, int, int], None], parts: tuple[Held[Any], ...], workers: int
    ) -> None:
        self._kernel = kernel
        self._parts = parts
        self._table = np.array([part.address for part in parts], np.int64)
        self.turns = [threading.Lock() for _ in range(workers)]
        self.left = set(range(workers))

    def do(self, worker: int) -> None:
        """Do a worker's share if it has not begun; return when it is done, in any thread."""
        with self.turns[worker]:
            if worker in self.left:
                self.left.discard(worker)
                self._kernel(self._table.ctypes.data, worker, len(self.turns))

    def do_all(self, threads: ThreadPoolExecutor | None) -> None:
        """Do all shares with the help of threads; return when they are done."""
        workers = range(1, len(self.turns))
        if threads is not None:
            for worker in workers:
                threads.submit(self.do, worker)
        self.do(0)
        for worker in workers:
            if not self.turns[worker].locked():  # its thread is not awake yet, or has finished
                self.do(worker)
        for worker in workers:
            self.do(worker)

    def end(self) -> None:
        """Let no more shares begin, and wait for those that have begun."""
        self.left.clear()
        for turn in self.turns:
            with turn:
                pass


class _Crew:
    """The threads that help the calling thread; a forked process gets its own.

    Attributes:
        busy: Lock held by the calling thread: calls share the kernels' working memory.
        call: The call in progress, or one that a signal (Ctrl-C) interrupted while it waited for
            its workers; the next call waits for them first.
    """

    def __init__(self) -> None:
        self._begin()
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self._begin)

    def _begin(self) -> None:
        self.busy = threading.Lock()
        self.call: _Call | None = None
        self._threads: ThreadPoolExecutor | None = None

    @property
    def threads(self) -> ThreadPoolExecutor:
        if self._threads is None:
            self._threads = ThreadPoolExecutor(max(thread_count() - 1, 1), "eyas-kernel")
        return self._threads

    def run(self, call: _Call) -> None:
        """Do all shares of a call; the caller must hold `busy`."""
        if self.call is not None:
            self.call.end()
        self.call = call
        try:
            call.do_all(self.threads if len(call.turns) > 1 else None)
        finally:
            call.end()
            self.call = None


_CREW = _Crew()


class BoundKernel:
    """A kernel bound to its bundles, for short calls that are repeated often.

    A call takes one microsecond instead of eight. It does not wait for other calls, so nothing
    else may write into its bundles meanwhile.
    """

    __slots__ = ("_address", "_function", "_kept")

    def __init__(
        self, function: Callable[[int, int, int], None], parts: tuple[Held[Any], ...]
    ) -> None:
        table = np.array([part.address for part in parts], np.int64)
        self._function = function
        self._address = table.ctypes.data
        self._kept = table, parts

    def __call__(self) -> None:
        """Do all shares."""
        self._function(self._address, 0, 1)


class parallel_kernel(Generic[Bundle]):  # noqa: N801  # a decorator like `kernel`
    """Compile a function that does the share of one worker, and run it for all workers in parallel.

    Calls from several Python threads wait for each other.

    Args:
        function: Called with `parts`, `worker` and `workers`; `parts[0]` holds a pointer to each
            bundle, and `parts[0][i][0]` is bundle i.
    """

    def __init__(self, function: Callable[[Pointer[Bundle], int, int], None]) -> None:
        self.__doc__ = function.__doc__
        self.function = function
        self._compiled: dict[tuple[int, ...], Any] = {}

    def __call__(self, workers: int, *parts: Held[Any]) -> None:
        """Run the shares of all workers and wait for them."""
        if workers == 0:
            return
        with _CREW.busy:
            _CREW.run(_Call(self._function(parts), parts, workers))

    def bound(self, *parts: Held[Any]) -> "BoundKernel":
        """Return the kernel bound to these bundles; it runs in the calling thread."""
        return BoundKernel(self._function(parts), parts)

    def _function(self, parts: tuple[Held[Any], ...]) -> Callable[[int, int, int], None]:
        """Return the function for bundles of these layouts; as a ctypes function, it releases the
        interpreter's lock.
        """
        layouts = tuple([part.layout for part in parts])
        if layouts not in self._compiled:
            self._compiled[layouts] = self._compile(parts)
        function: Callable[[int, int, int], None] = self._compiled[layouts].ctypes
        return function

    def _compile(self, parts: tuple[Held[Any], ...]) -> Any:  # noqa: ANN401  # numba has no types
        pointers = [numba.types.CPointer(numba.typeof(part.bundle)) for part in parts]
        table = numba.types.CPointer(numba.types.Tuple(pointers))
        signature = numba.void(table, numba.intp, numba.intp)
        settings = {**KERNEL_SETTINGS, "cache": may_be_kept(self.function, pointers)}
        return numba.cfunc(signature, **settings)(self.function)


@kernel
def _lay_out(bundle: object, memory: NDArray[np.uint8]) -> int:
    """Write a bundle into memory and return its layout; if too small, minus the bytes needed."""
    size: int = size_of(bundle)
    if len(memory) < size:
        return -size
    store(memory, bundle)
    layout: int = layout_of(bundle)
    return layout
