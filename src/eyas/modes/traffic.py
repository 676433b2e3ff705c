"""Record traffic with SUMO."""

from pathlib import Path

from rich.console import Console

from eyas.core.errors import ConfigError, OutputError
from eyas.modes.progress import sumo_progress
from eyas.traffic.config import TrafficConfig
from eyas.traffic.library import CANONICAL_SEED, RESPAWN_GROUPS, record_canonical
from eyas.traffic.network import build_network
from eyas.traffic.record import record
from eyas.traffic.recording_file import save
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS
from eyas.world.maps.recipe import NETWORK_FILE, TRAFFIC_FILE, respawn_file
from eyas.world.roads.network_file import save_network

__all__ = ["run", "run_canonical"]


def run(
    world: WorldConfig,
    config: TrafficConfig,
    duration: float,
    path: Path | None,
    *,
    overwrite: bool = False,
) -> None:
    """Record traffic into a file.

    Args:
        world: The map.
        config: The traffic.
        duration: Time to record [s].
        path: The file; None: `<map>-<seed>-<type>.npz` in the current folder.
        overwrite: Whether an existing file is replaced.

    Raises:
        ConfigError: The duration is out of range.
        MissingExtraError: SUMO is not installed.
        OutputError: The file cannot be written.
    """
    if not 1.0 <= duration <= 86_400.0:
        raise ConfigError(f"--duration: {duration:g} is not allowed; allowed: 1 to 86400 s")
    seed = CANONICAL_SEED if config.seed is None else config.seed
    graph = MAPS.get(world.map).roads(world.seed)
    target = path or Path(f"{graph.map_name}-{seed}-{config.vehicle_type}.npz")
    _check_free(target, overwrite=overwrite)  # before SUMO runs for minutes
    with sumo_progress() as progress:
        recording = record(graph.map_name, graph.seed, graph, config, duration, seed, progress)
    save(recording, target)
    _report(target, f"{recording.actors} vehicles, {recording.duration:g} s")


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
    sizes: tuple[int | None, ...] = (None, *RESPAWN_GROUPS)
    for size in sizes:
        path = folder / (TRAFFIC_FILE if size is None else respawn_file(size))
        with sumo_progress() as progress:
            record_canonical(graph, path, size, progress)
        _report(path, "a shipped recording")


def _report(path: Path, what: str) -> None:
    Console(stderr=True).print(f"{path}: {what}, {path.stat().st_size / 1024:.0f} KiB")
