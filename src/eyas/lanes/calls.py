"""Calls of kernels from Python: bundles are passed by address, shares of work run in threads.

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
from typing import Any

from eyas.lanes.held import Held
from eyas.lanes.interrupts import shielded
from eyas.lanes.jit import thread_count

_ENTRY = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_ssize_t, ctypes.c_ssize_t, ctypes.c_ssize_t)
"""Addresses of the bundles, worker, workers; returns 0 unless the kernel raised an exception."""


class _Job:
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


class _ThreadPool:
    """The threads that help the calling thread; a forked process gets its own.

    Attributes:
        busy: Lock held by the calling thread: calls share the kernels' working memory.
        job: The call in progress, or one whose end a signal (Ctrl-C) prevented; it is kept, with
            all that its workers use, and the next call waits for them first.
    """

    def __init__(self) -> None:
        self._begin()
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self._begin)

    def _begin(self) -> None:
        self.busy = threading.Lock()
        self.job: _Job | None = None
        self._threads: ThreadPoolExecutor | None = None

    @property
    def threads(self) -> ThreadPoolExecutor:
        if self._threads is None:
            self._threads = ThreadPoolExecutor(max(thread_count() - 1, 1), "eyas-kernel")
        return self._threads

    def run(self, job: _Job) -> None:
        """Do all shares of a call; the caller must hold `busy`."""
        if self.job is not None:
            self.job.end()
        self.job = job
        try:
            job.do_all(self.threads if len(job.turns) > 1 else None)
        except BaseException:
            with shielded():  # a second Ctrl-C waits: what workers use may be freed afterwards
                job.end()
                self.job = None
            raise
        self.job = None


_POOL = _ThreadPool()


class BoundCall:
    """A kernel bound to its bundles, for short calls that are repeated often.

    A call takes one microsecond instead of eight. It does not wait for other calls, so nothing
    else may write into its bundles meanwhile.
    """

    __slots__ = ("_address", "_function", "_kept")

    def __init__(
        self, function: Callable[[int, int, int], int], bundles: tuple[Held[Any], ...]
    ) -> None:
        table = array("q", [bundle.address for bundle in bundles])
        self._function = function
        self._address = table.buffer_info()[0]
        self._kept = table, bundles

    def __call__(self) -> None:
        """Do all of it in the calling thread."""
        _check(self._function(self._address, 0, 1))


def _check(status: int) -> None:
    if status:
        raise RuntimeError("a kernel raised an exception")


class CompiledCall:
    """A function that Python calls, compiled with all kernels that it calls.

    Its parameters are bundles. Named tuples come by pointer, which is read as the tuple itself,
    `bundle.field`; arrays and numbers come as they are.

    Attributes:
        function: The function, which returns nothing.
    """

    over_workers = False
    """Whether the function begins with two parameters of its own, `worker` and `workers`."""

    def __init__(self, function: Callable[..., None]) -> None:
        self.__doc__ = function.__doc__
        self.function = function
        self._loaded: dict[tuple[str, ...], Callable[[int, int, int], int]] = {}

    def bind(self, *bundles: Any) -> BoundCall:  # noqa: ANN401
        """Return the call bound to bundles, `Held` or not; it runs in the calling thread."""
        held = _held(bundles)
        return BoundCall(self._function(held), held)

    def __call__(self, *bundles: Any) -> None:  # noqa: ANN401
        """Call it once."""
        self.bind(*bundles)()

    def _function(self, bundles: tuple[Held[Any], ...]) -> Callable[[int, int, int], int]:
        """Return the function for bundles of these kinds; as a ctypes function, it releases the
        interpreter's lock.
        """
        kinds = tuple([bundle.kind for bundle in bundles])
        if kinds not in self._loaded:
            self._loaded[kinds] = self._load(bundles)
        return self._loaded[kinds]

    def _load(self, bundles: tuple[Held[Any], ...]) -> Callable[[int, int, int], int]:
        from eyas.lanes.entry import entry_address  # LLVM, for the first call only

        return _ENTRY(entry_address(self.function, bundles, over_workers=self.over_workers))


def _held(bundles: tuple[Any, ...]) -> tuple[Held[Any], ...]:
    return tuple([b if isinstance(b, Held) else Held(b) for b in bundles])


class ParallelCall(CompiledCall):
    """A call of a function that does the share of one worker; it runs for all workers in parallel.

    Calls from several Python threads wait for each other.
    """

    over_workers = True

    def __call__(self, workers: int, *bundles: Any) -> None:  # noqa: ANN401
        """Run the shares of all workers and wait for them."""
        if workers == 0:
            return
        held = _held(bundles)
        with _POOL.busy:
            _POOL.run(_Job(self._function(held), held, workers))

    def in_order(self, workers: list[int], *bundles: Any) -> None:  # noqa: ANN401
        """Run the shares of all workers, of which each must be named once, one after another."""
        held = _held(bundles)
        function, table = self._function(held), array("q", [part.address for part in held])
        for worker in workers:
            _check(function(table.buffer_info()[0], worker, len(workers)))


def compiled(function: Callable[..., None]) -> CompiledCall:
    """Compile a function of bundles, for calls from Python."""
    return CompiledCall(function)


def parallel(function: Callable[..., None]) -> ParallelCall:
    """Compile a function of `worker`, `workers` and bundles, to be run by threads."""
    return ParallelCall(function)
