"""Threads in which writers run beside the simulation; each keeps the order of its calls."""

import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import ParamSpec

__all__ = ["WriterLanes"]

Arguments = ParamSpec("Arguments")

MOST_WAITING = 8
"""Most calls that may wait in a lane; it limits the pictures held in memory."""


class WriterLanes:
    """Runs calls in threads; calls with the same key run one after the other, in order.

    JPEG and video encoding release Python's global lock, so lanes use cores that drawing leaves
    idle: with one such core, four pictures of 320 x 240 took 22 ms instead of 31.

    Args:
        count: Largest number of keys.
    """

    def __init__(self, count: int) -> None:
        lanes = min(count, os.cpu_count() or 1, 8)
        self._threads = [ThreadPoolExecutor(1, f"eyas-writer-{lane}") for lane in range(lanes)]
        self._waiting: list[deque[Future[None]]] = [deque() for _ in range(lanes)]
        self._failed = [False] * lanes

    def submit(
        self,
        key: int,
        call: Callable[Arguments, None],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> None:
        """Run a call in the key's lane; raise the error of an earlier call of that lane."""
        lane = key % len(self._threads)
        waiting = self._waiting[lane]
        while waiting and (len(waiting) >= MOST_WAITING or waiting[0].done()):
            waiting.popleft().result()
        waiting.append(self._threads[lane].submit(self._run, lane, lambda: call(*args, **kwargs)))

    def _run(self, lane: int, call: Callable[[], None]) -> None:
        # After a frame has failed, its episode must not be finished as if it were complete.
        if self._failed[lane]:
            return
        try:
            call()
        except BaseException:
            self._failed[lane] = True
            raise

    def finish(self) -> None:
        """Wait for all calls; raise the error of one that failed."""
        for waiting in self._waiting:
            while waiting:
                waiting.popleft().result()
        self.stop()

    def stop(self) -> None:
        """Wait for all calls, and ignore their errors."""
        for thread in self._threads:
            thread.shutdown(wait=True)
