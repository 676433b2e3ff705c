"""Writers beside the simulation: a few threads, each of which keeps the order of its work."""

import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import ParamSpec

__all__ = ["WriterLanes"]

Arguments = ParamSpec("Arguments")

MOST_WAITING = 8
"""Calls that may wait in a lane; more would only pile up pictures in memory."""


class WriterLanes:
    """Runs calls in threads; calls of the same key run one after the other, in their order.

    JPEG and movie encoding let go of Python's lock, so lanes use cores that drawing leaves free:
    four pictures of 320 x 240 took 22 ms instead of 31 with one such core.

    Args:
        count: Most keys that are used.
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
        """Run a call in the key's lane; raise what an earlier call of the lane raised."""
        lane = key % len(self._threads)
        waiting = self._waiting[lane]
        while waiting and (len(waiting) >= MOST_WAITING or waiting[0].done()):
            waiting.popleft().result()
        waiting.append(self._threads[lane].submit(self._run, lane, lambda: call(*args, **kwargs)))

    def _run(self, lane: int, call: Callable[[], None]) -> None:
        # After a frame that failed, an episode must not be finished as if it were whole.
        if self._failed[lane]:
            return
        try:
            call()
        except BaseException:
            self._failed[lane] = True
            raise

    def finish(self) -> None:
        """Wait for all calls; raise what one of them raised."""
        for waiting in self._waiting:
            while waiting:
                waiting.popleft().result()
        self.stop()

    def stop(self) -> None:
        """Wait for all calls, whatever becomes of them."""
        for thread in self._threads:
            thread.shutdown(wait=True)
