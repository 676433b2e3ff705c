"""Processes that work on the parts of a data set, each on the parts of one map at a time.

A map that a process has built serves all parts there that it records. After some maps a new process
takes its place, so that memory does not grow with their number.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any, TypeVar

from eyas.datasets.plan import DatasetPart, in_order_of_work
from eyas.engine.core.errors import EyasError
from eyas.engine.terminal.helpers import begin_worker
from eyas.engine.terminal.interrupts import interrupts_held

Result = TypeVar("Result")

_MAPS = 2
"""Maps after which a process is replaced, since each in four weathers stays with some 250 MB, while
a new process takes 4 s until its first frame."""

_RETRIES = 2  # How often a part is tried again whose process was lost, as by a lack of memory


class _Queue:
    """The parts that wait, by map."""

    def __init__(self, parts: Sequence[DatasetPart]) -> None:
        self._waiting: dict[str, list[DatasetPart]] = {}
        for part in in_order_of_work(parts):
            self._waiting.setdefault(part.config.world.map, []).append(part)
        self._workers = dict.fromkeys(self._waiting, 0)

    def next(self, last: str | None) -> DatasetPart | None:
        """Return the next part for a worker whose last one was on a map; None: none is left."""
        if last is not None:
            self._workers[last] -= 1
        chosen = last if last is not None and self._waiting[last] else self._longest()
        if chosen is None:
            return None
        self._workers[chosen] += 1
        return self._waiting[chosen].pop(0)

    def _longest(self) -> str | None:
        """Return the map with the most parts for each of its workers."""
        left = {name: parts for name, parts in self._waiting.items() if parts}
        if not left:
            return None
        return max(left, key=lambda name: len(left[name]) / (1 + self._workers[name]))

    def again(self, part: DatasetPart) -> None:
        """Put a part back."""
        self._waiting[part.config.world.map].insert(0, part)


@dataclass(slots=True)
class _Worker:
    """A process, and what it does."""

    threads: int
    pool: ProcessPoolExecutor | None = None
    place: str | None = None  # The map of its last part
    maps: int = 0  # Number of maps on which this process has worked

    def begin(self, part: DatasetPart, call: Callable[..., Any], *args: Any) -> Future[Any]:  # noqa: ANN401
        self.maps += part.config.world.map != self.place
        if self.maps > _MAPS:
            self.close()
        if self.pool is None:
            self.maps = 1
            # Forked processes would inherit locks of threads that they have not.
            context = get_context("spawn")
            self.pool = ProcessPoolExecutor(1, context, begin_worker, (self.threads,))
        self.place = part.config.world.map
        with interrupts_held():
            return self.pool.submit(call, part, *args)

    def close(self) -> None:
        if self.pool is not None:
            self.pool.shutdown(wait=False, cancel_futures=True)
            self.pool = None

    def kill(self) -> None:
        """End the process at once; every file that exists is complete."""
        for process in list((getattr(self.pool, "_processes", None) or {}).values()):
            process.terminate()
        self.close()


def work(
    parts: Sequence[DatasetPart],
    call: Callable[..., Result],
    count: int,
    threads: int,
    *args: Any,  # noqa: ANN401
) -> Iterator[tuple[DatasetPart, Result]]:
    """Yield what a function returns for each part, as they are done.

    Args:
        call: A function of a module, called with a part and `args`.

    Raises:
        EyasError: What it raises; all processes are ended.
    """
    if count == 1:  # also in a notebook or a script, which other processes could not import
        for part in in_order_of_work(parts):
            yield part, call(part, *args)
    else:
        yield from _spread(parts, call, count, threads, *args)


def _spread(
    parts: Sequence[DatasetPart],
    call: Callable[..., Result],
    count: int,
    threads: int,
    *args: Any,  # noqa: ANN401
) -> Iterator[tuple[DatasetPart, Result]]:
    """Yield what a function returns for each part, from several processes; see `work`."""
    queue, lost = _Queue(parts), dict[str, int]()
    workers = [_Worker(threads) for _ in range(min(count, len(parts)))]
    busy: dict[Future[Result], tuple[_Worker, DatasetPart]] = {}
    try:
        idle = list(workers)
        while True:
            for worker in idle:
                following = queue.next(worker.place)
                if following is None:
                    worker.close()
                else:
                    busy[worker.begin(following, call, *args)] = (worker, following)
            if not busy:
                return
            done, _ = wait(busy, return_when=FIRST_COMPLETED)
            idle = []
            for future in done:
                worker, part = busy.pop(future)
                idle.append(worker)
                try:
                    yield part, future.result()
                except BrokenProcessPool:
                    worker.kill()
                    lost[part.name] = lost.get(part.name, 0) + 1
                    if lost[part.name] > _RETRIES:
                        raise EyasError(
                            f"{part.name}: the process that works on it was killed "
                            f"{lost[part.name]} times, perhaps for want of memory: try fewer "
                            "--workers"
                        ) from None
                    queue.again(part)
    finally:
        for worker in workers:
            worker.kill()
