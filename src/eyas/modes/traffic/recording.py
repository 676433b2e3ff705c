"""Record traffic with SUMO, for one seed or many."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from eyas.core.errors import ConfigError, OutputError
from eyas.modes.progress import sumo_progress
from eyas.modes.traffic.seeds import Job, record_all
from eyas.traffic.config import Demand, Mix, TrafficConfig
from eyas.traffic.library import (
    CANONICAL_MIX,
    CANONICAL_SEED,
    RESPAWN_GROUPS,
    record_canonical,
)
from eyas.traffic.network import build_network
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS
from eyas.world.maps.recipe import MIXED_FILE, NETWORK_FILE, TRAFFIC_FILE, respawn_file
from eyas.world.roads.network_file import save_network

__all__ = ["run", "run_canonical"]

_CITIES = ("citystreet", "downtown")
"""Maps that ship a recording of a mixed fleet."""


def run(  # noqa: PLR0913  # one parameter for each option
    world: WorldConfig,
    config: TrafficConfig,
    duration: float,
    path: Path | None,
    *,
    seeds: Sequence[int] = (),
    workers: int | None = None,
    overwrite: bool = False,
) -> None:
    """Record traffic into files.

    Args:
        world: The map.
        config: The traffic.
        duration: Time to record [s].
        path: The file; for several seeds the folder; None: `<map>-<seed>-<type>.npz` in the current
            folder.
        seeds: Seeds of SUMO and of the routes, one file for each; none: that of the settings.
        workers: Number of processes; None: one for each core, at most one for each seed.
        overwrite: Whether existing files are replaced.

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
        _check_free(target, overwrite=overwrite)  # before SUMO runs for minutes
        jobs.append(Job(world, config, duration, seed, target))
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


def _check_free(path: Path, *, overwrite: bool) -> None:
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
    folder, graph = Path(str(recipe.folder)), recipe.roads(0)
    save_network(folder / NETWORK_FILE, build_network(graph))
    shipped = {TRAFFIC_FILE: TrafficConfig()}
    for size in RESPAWN_GROUPS:
        shipped[respawn_file(size)] = TrafficConfig(demand=Demand.RESPAWN, group_size=size)
    if recipe.name in _CITIES:
        shipped[MIXED_FILE] = TrafficConfig(vehicle_type=CANONICAL_MIX)
    for name, config in shipped.items():
        with sumo_progress() as progress:
            record_canonical(graph, folder / name, config, progress)
        _report(folder / name, "a shipped recording")


def _report(path: Path, what: str) -> None:
    Console(stderr=True).print(f"{path}: {what}, {path.stat().st_size / 1024:.0f} KiB")
