"""Parallel kernels: each worker's share runs in a thread, and arguments are passed by address.

numba's own solution, `parallel=True` on each kernel, compiles everything that the kernel calls
three times (half a minute for the renderer), unpacks every array at every call (a tenth of the time
of a small picture), and wakes a thread for each worker while the caller waits (another tenth).
"""

import ctypes
import os
import threading
from array import array
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Generic, Protocol, TypeVar

from eyas.core.interrupts import shielded
from eyas.lanes.entry import entry_address
from eyas.lanes.held import Held
from eyas.lanes.jit import thread_count

__all__ = ["BoundKernel", "Held", "Pointer", "parallel_kernel"]

Bundle = TypeVar("Bundle")
Pointee = TypeVar("Pointee", covariant=True)

_ENTRY = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_ssize_t, ctypes.c_ssize_t, ctypes.c_ssize_t)
"""Addresses of the bundles, worker, workers; returns 0 unless the kernel raised an exception."""


class Pointer(Protocol[Pointee]):
    """Pointer through which a parallel kernel reads a bundle: `pointer[0]`."""

    def __getitem__(self, index: int) -> Pointee: ...


class _Call:
    """A call with everything that it reads and writes, kept until the last worker is done.

    Attributes:
        turns: A lock for each worker, held while its share is being done.
        left: Workers whose shares have not begun.
    """

    __slots__ = ("_address", "_failed", "_kernel", "_parts", "_table", "left", "turns")

    def __init__(
        self, kernel: Callable[[int, int, int], int], parts: tuple[Held[Any], ...], workers: int
    ) -> None:
        self._kernel = kernel
        self._parts = parts
        self._table = array("q", [part.address for part in parts])
        self._address = self._table.buffer_info()[0]
        self.turns = [threading.Lock() for _ in range(workers)]
        self.left = set(range(workers))
        self._failed = False

    def do(self, worker: int) -> None:
        """Do a worker's share if it has not begun; return when it is done, in any thread."""
        with self.turns[worker]:
            if worker in self.left:
                self.left.discard(worker)
                if self._kernel(self._address, worker, len(self.turns)):
                    self._failed = True

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
        _check(self._failed)

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
        call: The call in progress, or one whose end a signal (Ctrl-C) prevented; it is kept, with
            all that its workers use, and the next call waits for them first.
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
        except BaseException:
            with shielded():  # a second Ctrl-C waits: what workers use may be freed afterwards
                call.end()
                self.call = None
            raise
        self.call = None


_CREW = _Crew()


class BoundKernel:
    """A kernel bound to its bundles, for short calls that are repeated often.

    A call takes one microsecond instead of eight. It does not wait for other calls, so nothing
    else may write into its bundles meanwhile.
    """

    __slots__ = ("_address", "_function", "_kept")

    def __init__(
        self, function: Callable[[int, int, int], int], parts: tuple[Held[Any], ...]
    ) -> None:
        table = array("q", [part.address for part in parts])
        self._function = function
        self._address = table.buffer_info()[0]
        self._kept = table, parts

    def __call__(self) -> None:
        """Do all shares."""
        _check(self._function(self._address, 0, 1))


def _check(status: int) -> None:
    if status:
        raise RuntimeError("a kernel raised an exception")


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
        self._compiled: dict[tuple[str, ...], Callable[[int, int, int], int]] = {}

    def __call__(self, workers: int, *parts: Held[Any]) -> None:
        """Run the shares of all workers and wait for them."""
        if workers == 0:
            return
        with _CREW.busy:
            _CREW.run(_Call(self._function(parts), parts, workers))

    def bound(self, *parts: Held[Any]) -> "BoundKernel":
        """Return the kernel bound to these bundles; it runs in the calling thread."""
        return BoundKernel(self._function(parts), parts)

    def _function(self, parts: tuple[Held[Any], ...]) -> Callable[[int, int, int], int]:
        """Return the function for bundles of these kinds; as a ctypes function, it releases the
        interpreter's lock.
        """
        kinds = tuple([part.kind for part in parts])
        if kinds not in self._compiled:
            self._compiled[kinds] = self._load(parts)
        return self._compiled[kinds]

    def _load(self, parts: tuple[Held[Any], ...]) -> Callable[[int, int, int], int]:
        return _ENTRY(entry_address(self.function, parts))
