"""Processes that do the same work beside this one, each a share of it."""

import logging
import os
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from types import FrameType, TracebackType
from typing import Any, Generic, TypeVar

from eyas.engine.core.errors import EyasError
from eyas.engine.terminal.interrupts import Interrupted, interrupts_held
from eyas.lanes import limit_threads

Result = TypeVar("Result")


def begin_worker(threads: int) -> None:
    """Prepare a process that works for another one: so many threads, and it ends when its parent is
    killed.
    """
    limit_threads(threads)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it
    parent = parent_process()
    assert parent is not None

    def follow() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


_PATIENCE = 10.0  # Time for a process to leave nothing half-written, before it is killed [s]


@dataclass(frozen=True, slots=True)
class _Helper:
    process: BaseProcess
    results: Connection


class Helpers(Generic[Result]):
    """Processes that work while the block is not left; whatever ends the block ends them.

    Attributes:
        count: How many.

    Args:
        calls: What each of them calls: a function of a module, with its arguments.
        threads: Threads that each may draw with.
    """

    def __init__(
        self, calls: list[tuple[Callable[..., Result], tuple[Any, ...]]], threads: int
    ) -> None:
        self._calls, self._threads = calls, threads
        self.count = len(calls)
        self._waiting: list[_Helper] = []
        self._results: list[Result] = []

    def __enter__(self) -> "Helpers[Result]":
        # Forked processes would inherit locks of threads that they have not.
        context = get_context("spawn")
        for call, args in self._calls:
            ours, theirs = context.Pipe(duplex=False)
            process = context.Process(target=_work, args=(theirs, self._threads, call, args))
            with interrupts_held():
                process.start()
            theirs.close()
            self._waiting.append(_Helper(process, ours))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for helper in self._waiting:
            helper.process.terminate()
        for helper in self._waiting:
            helper.process.join(_PATIENCE)
            helper.process.kill()

    def check(self) -> None:
        """Raise what a process has raised.

        Raises:
            EyasError: That, or it was killed.
        """
        self._take(0.0)

    def results(self) -> list[Result]:
        """Wait for the processes; return what their calls returned, in the order of their ends.

        Raises:
            EyasError: As `check`.
        """
        while self._waiting:
            self._take(None)
        return self._results

    def _take(self, timeout: float | None) -> None:
        """Take what has come within a time [s]; None: wait until something has."""
        ready = wait([helper.results for helper in self._waiting], timeout)
        for helper in [helper for helper in self._waiting if helper.results in ready]:
            try:
                result = helper.results.recv()
            except (EOFError, OSError):
                raise EyasError(
                    "one of the processes was killed, perhaps for want of memory: try fewer "
                    "--workers, and continue with --resume"
                ) from None
            if isinstance(result, BaseException):
                raise result
            helper.process.join()
            self._waiting.remove(helper)
            self._results.append(result)


def _work(
    results: Connection, threads: int, call: Callable[..., object], args: tuple[Any, ...]
) -> None:
    """Call what is to be called in a new process; send what it returns or raises."""
    begin_worker(threads)
    signal.signal(signal.SIGTERM, _end)
    logging.getLogger("eyas").setLevel(logging.CRITICAL)  # the parent tells the same
    try:
        results.send(call(*args))
    except Interrupted:
        return
    except Exception as error:  # whatever it is, the parent raises it
        results.send(error)


def _end(number: int, frame: FrameType | None) -> None:
    signal.signal(number, signal.SIG_IGN)
    raise Interrupted
