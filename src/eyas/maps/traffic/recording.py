"""Record traffic, into the package's files too, and say what a recording holds."""

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

from rich.console import Console

from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.sim.cover import cover_of
from eyas.engine.terminal.progress import sumo_progress
from eyas.engine.traffic.config import Demand, Drivers, Mix, Signals, TrafficConfig
from eyas.engine.traffic.library import (
    CANONICAL_MIX,
    CANONICAL_SEED,
    DENSE_DURATION,
    DENSE_TEST_DURATION,
    DENSE_VEHICLES,
    EVADING_MIX,
    RESPAWN_GROUPS,
    STANDARD_DURATION,
    TEST_DURATION,
    TEST_TRAFFIC,
    record_canonical,
)
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.network import build_network, network_xml
from eyas.engine.traffic.record import record
from eyas.engine.traffic.recording_file import save
from eyas.engine.traffic.signals import save_plan, signal_plan
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import (
    DENSE_FILE,
    DENSE_TEST_FILE,
    MIXED_FILE,
    SIGNALS_FILE,
    SIGNALS_TRAFFIC_FILE,
    TEST_TOWNS,
    TRAFFIC_FILE,
    MapRecipe,
    drivers_file,
    network_file,
    respawn_file,
    town_traffic_file,
)
from eyas.engine.world.roads.network_file import save_network

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


_CITIES = ("citystreet", "downtown")  # Maps that ship a recording of a mixed fleet

_TESTED = ("citystreet", "desert", "downtown", "farmland", "lake", "village")
"""Maps that ship traffic for the protocol `standard`."""

_WITH_SIGNALS = ("citystreet", "desert", "downtown", "village")
"""Maps with traffic lights, which ship traffic that obeys them."""

_WITH_TOWNS = ("citystreet", "downtown", "village")
"""Maps of which other towns ship, for the protocol `unseen`."""
_LOST_DRIVERS: dict[str, dict[Drivers, TrafficConfig]] = {
    "village": {Drivers.HIDING: TrafficConfig()},
    "citystreet": {
        Drivers.HIDING: TrafficConfig(),
        Drivers.EVADING: TrafficConfig(vehicle_type=EVADING_MIX),
    },
    "downtown": {Drivers.EVADING: TrafficConfig(vehicle_type=EVADING_MIX)},
}
"""Maps that ship recordings of drivers who want to be lost: those where something hides them."""


def run(
    world: WorldConfig,
    config: TrafficConfig,
    duration: float,  # Time to record [s]
    # The file; for several seeds the folder; None: `<map>-<seed>-<type>.npz` in the current folder
    path: Path | None,
    *,
    # Seeds of SUMO and of the routes, one file for each; none: that of the settings
    seeds: Sequence[int] = (),
    # Number of processes; None: one for each core, at most one for each seed
    workers: int | None = None,
    overwrite: bool = False,  # Whether existing files are replaced
) -> None:
    """Record traffic into files.

    Raises:
        ConfigError: The duration or a seed is out of range.
        MissingExtraError: SUMO is not installed.
        OutputError: A file cannot be written.
    """
    if not 1.0 <= duration <= 86_400.0:
        raise ConfigError(f"--duration: {duration:g} is not allowed; allowed: 1 to 86400 s")
    graph = MAPS.get(world.map).roads(world.seed)
    known = CANONICAL_SEED if config.seed is None else config.seed
    if seeds and path is not None:
        _make_folder(path)
    jobs = []
    for seed in seeds or (known,):
        name = Path(f"{graph.map_name}-{seed}-{_fleet_name(config)}.npz")
        target = (path / name if seeds else path) if path is not None else name
        check_free(target, overwrite=overwrite)  # before SUMO runs for minutes
        jobs.append(RecordingJob(world, config, duration, seed, target))
    with sumo_progress() as progress:
        for path_made, what in record_all(jobs, workers, progress):
            _report(path_made, what)


def _fleet_name(config: TrafficConfig) -> str:
    return "mixed" if isinstance(config.vehicle_type, Mix) else config.vehicle_type.value


def _make_folder(path: Path) -> None:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: cannot make the folder: {error.strerror}") from None


def check_free(path: Path, *, overwrite: bool) -> None:
    """Refuse a file that exists, unless it may be replaced, or that cannot be written.

    Raises:
        OutputError: It cannot be written.
    """
    if path.is_dir():
        raise OutputError(f"{path}: is a folder, not a file")
    if path.exists() and not overwrite:
        raise OutputError(f"{path}: already exists; replace it with --overwrite")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: cannot write: there is no folder '{path.parent}'")


def run_canonical(world: WorldConfig) -> None:
    """Regenerate the roads and the recordings that ship with a map, in its package's source.

    Raises:
        ConfigError: The map is not part of a package.
        MissingExtraError: SUMO is not installed.
        OutputError: The package's folder cannot be written to.
    """
    recipe = MAPS.get(world.map)
    if recipe.folder is None:
        raise ConfigError(
            f"world.map: {world.map!r} is not part of a package, so nothing can be shipped with it"
        )
    folder = Path(str(recipe.folder))
    for seed in (0, *(TEST_TOWNS if recipe.name in _WITH_TOWNS else ())):
        save_network(folder / network_file(seed), build_network(recipe.roads(seed)))
    if recipe.name in _WITH_SIGNALS:
        lit = SumoNet(network_xml(recipe.roads(0), signals=True))
        save_plan(folder / SIGNALS_FILE, signal_plan(lit))
    for name, town, config, duration in _shipped_recordings(recipe):
        cover = () if config.drivers is Drivers.NORMAL else cover_of(recipe.name, town)
        with sumo_progress() as progress:
            record_canonical(
                recipe.roads(town), folder / name, config, progress, cover=cover, duration=duration
            )
        _report(folder / name, "a shipped recording")


def _shipped_recordings(recipe: MapRecipe) -> Iterator[tuple[str, int, TrafficConfig, float]]:
    """Yield the recordings that ship with a map: file, seed of the map, settings, length [s]."""
    yield TRAFFIC_FILE, 0, TrafficConfig(), STANDARD_DURATION
    if recipe.name in _WITH_SIGNALS:
        obeying = TrafficConfig(signals=Signals.WORKING)
        yield SIGNALS_TRAFFIC_FILE, 0, obeying, STANDARD_DURATION
    for size in RESPAWN_GROUPS:
        groups = TrafficConfig(demand=Demand.RESPAWN, group_size=size)
        yield respawn_file(size), 0, groups, STANDARD_DURATION
    if recipe.name in _CITIES:
        mixed = TrafficConfig(vehicle_type=CANONICAL_MIX)
        yield MIXED_FILE, 0, mixed, STANDARD_DURATION
        dense = mixed.model_copy(update={"max_vehicles": DENSE_VEHICLES})
        yield DENSE_FILE, 0, dense, DENSE_DURATION
        tested = dense.model_copy(update={"seed": TEST_TRAFFIC[0]})
        yield DENSE_TEST_FILE, 0, tested, DENSE_TEST_DURATION
    for drivers, config in _LOST_DRIVERS.get(recipe.name, {}).items():
        own = config.model_copy(update={"drivers": drivers})
        yield drivers_file(drivers), 0, own, STANDARD_DURATION
        tested = own.model_copy(update={"seed": TEST_TRAFFIC[0]})
        yield drivers_file(drivers, TEST_TRAFFIC[0]), 0, tested, TEST_DURATION
    for seed in TEST_TRAFFIC if recipe.name in _TESTED else ():
        yield town_traffic_file(0, seed), 0, TrafficConfig(seed=seed), TEST_DURATION
    for town in TEST_TOWNS if recipe.name in _WITH_TOWNS else ():
        seed = TEST_TRAFFIC[0]
        yield town_traffic_file(town, seed), town, TrafficConfig(seed=seed), 0.5 * TEST_DURATION


def _report(path: Path, what: str) -> None:
    Console(stderr=True).print(f"{path}: {what}, {path.stat().st_size / 1024:.0f} KiB")
