"""Recordings of several seeds at once: libsumo runs one simulation in a process."""

import ctypes
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from multiprocessing.sharedctypes import RawArray
from pathlib import Path
from typing import Any

from eyas.engine.sim.cover import cover_of
from eyas.engine.traffic.config import Drivers, TrafficConfig
from eyas.engine.traffic.record import record
from eyas.engine.traffic.recording_file import save
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS

__all__ = ["RecordingJob", "record_all"]

_LOOK = 0.2  # Time between two looks at the progress [s]

_shares: Any = ()  # Completed share of each job, in memory that the processes share


@dataclass(frozen=True, slots=True)
class RecordingJob:
    """A recording to make."""

    world: WorldConfig
    config: TrafficConfig
    duration: float  # [s]
    seed: int
    path: Path


def record_all(
    jobs: Sequence[RecordingJob], workers: int | None, progress: Callable[[float], None]
) -> Iterator[tuple[Path, str]]:
    """Make recordings; yield the file of each that is made, and what is in it.

    Args:
        jobs: The recordings. The file of each is the same however many processes there are.
        workers: Number of processes; None: one for each core, at most one for each recording.
        progress: Called with the completed share of all, 0 to 1.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: The roads have no room for the requested traffic.
        OutputError: A file cannot be written.
    """
    count = min(workers or os.cpu_count() or 1, len(jobs))
    if count == 1:
        for done, job in enumerate(jobs):
            yield _record(job, partial(_tell_one, progress, done, len(jobs)))
        return
    shares = RawArray(ctypes.c_double, len(jobs))
    # Forked processes would inherit locks of threads that they have not.
    pool = ProcessPoolExecutor(count, get_context("spawn"), _begin, (shares,))
    try:
        waiting: set[Future[tuple[Path, str]]] = {
            pool.submit(_record_one, index, job) for index, job in enumerate(jobs)
        }
        while waiting:
            made, waiting = wait(waiting, _LOOK, FIRST_COMPLETED)
            progress(sum(shares) / len(jobs))
            for future in made:
                yield future.result()
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _tell_one(progress: Callable[[float], None], done: int, jobs: int, share: float) -> None:
    progress((done + share) / jobs)


def _begin(shares: Any) -> None:  # noqa: ANN401  # an array of ctypes
    global _shares
    _shares = shares


def _record_one(index: int, job: RecordingJob) -> tuple[Path, str]:
    return _record(job, partial(_shares.__setitem__, index))


def _record(job: RecordingJob, progress: Callable[[float], None]) -> tuple[Path, str]:
    graph = MAPS.get(job.world.map).roads(job.world.seed)
    name, seed = graph.map_name, graph.seed
    usual = job.config.drivers is Drivers.NORMAL
    cover = () if usual else cover_of(job.world.map, job.world.seed)
    made = record(name, seed, graph, job.config, job.duration, job.seed, progress, cover=cover)
    save(made, job.path)
    return job.path, f"{made.actors} vehicles, {made.duration:g} s"
