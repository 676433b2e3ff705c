"""Finding the recording that fits: the user's, the shipped one, a cached one, or a new one."""

import hashlib
import json
import logging
from collections.abc import Callable
from dataclasses import asdict
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

import platformdirs

from eyas.core.errors import ConfigError, DataFileError, OutputError
from eyas.state.roads import RoadGraph
from eyas.traffic.config import TrafficConfig
from eyas.traffic.network import graph_hash
from eyas.traffic.record import provenance, record, resolved
from eyas.traffic.recording import Provenance, Recording, check_map
from eyas.traffic.recording_file import FORMAT, load, save

__all__ = [
    "CANONICAL_SEED",
    "STANDARD_DURATION",
    "cache_file",
    "find_recording",
    "record_canonical",
    "shipped_file",
]

_LOG = logging.getLogger("eyas")

CANONICAL_SEED = 1
"""Seed of the recordings that are shipped, and of those that say no other."""

STANDARD_DURATION = 1260.0
"""Length of a recording where nothing else is asked for: 21 minutes [s]."""


def find_recording(
    graph: RoadGraph,
    config: TrafficConfig,
    *,
    trackers: int = 1,
    duration: float = STANDARD_DURATION,
) -> Recording:
    """Return the recording to replay: the one named, the shipped one, a cached or a new one.

    That one has to be made first is said in one line of the log `eyas`, which Python prints.

    Args:
        graph: Where to drive.
        config: What drives.
        trackers: Number of trackers, which the size of a group follows.
        duration: Shortest recording that will do [s].

    Raises:
        DataFileError: The named recording cannot be read or is of another map.
        ConfigError: None fits and `update_routes` forbids to record.
        MissingExtraError: None fits and SUMO is not installed.
    """
    if config.recording is not None:
        path = Path(config.recording).expanduser()
        named = load(path)
        check_map(named, graph.map_name, graph.seed, graph_hash(graph), str(path))
        return named
    seed = CANONICAL_SEED if config.seed is None else config.seed
    wanted = resolved(config, seed, trackers)
    shipped = _shipped(graph, wanted)
    if shipped is not None and shipped.duration >= duration:
        return shipped
    if not config.update_routes:
        raise ConfigError(
            "traffic.update_routes: false, but no recording fits these settings; allowed: true, "
            "or the settings of the shipped recording, or traffic.recording"
        )
    return _cached_or_new(graph, wanted, duration)


def shipped_file(map_name: str) -> Traversable:
    """Return where the package keeps the canonical recording of a map; it need not be there."""
    return files("eyas.world.maps") / map_name / "traffic.npz"


def record_canonical(
    map_name: str, graph: RoadGraph, progress: Callable[[float], None] | None = None
) -> Path:
    """Record the canonical traffic of a map (its seed 0) into the package; return the file.

    For developers, after a change of the map's roads.

    Raises:
        MissingExtraError: SUMO is not installed.
        OutputError: The package's folder cannot be written to.
    """
    made = record(
        map_name, graph.seed, graph, TrafficConfig(), STANDARD_DURATION, CANONICAL_SEED, progress
    )
    path = Path(str(shipped_file(map_name)))
    path.parent.mkdir(exist_ok=True)
    save(made, path)
    return path


def cache_file(origin: Provenance) -> Path:
    """Return where a recording with this provenance is cached."""
    content = {**asdict(origin), "config": origin.config.model_dump(mode="json"), "format": FORMAT}
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]
    folder = Path(platformdirs.user_cache_dir("eyas")) / "traffic"
    return folder / f"{origin.map_name}-{origin.map_seed}-{key}.npz"


def _shipped(graph: RoadGraph, wanted: TrafficConfig) -> Recording | None:
    file = shipped_file(graph.map_name)
    if not file.is_file():
        return None
    recording = load(file)
    origin = recording.provenance
    fits = (origin.graph_hash, origin.config) == (graph_hash(graph), wanted)
    return recording if fits else None


def _cached_or_new(graph: RoadGraph, wanted: TrafficConfig, duration: float) -> Recording:
    origin = provenance(graph.map_name, graph.seed, graph_hash(graph), wanted, duration)
    path = cache_file(origin)
    try:
        return load(path)
    except DataFileError:
        pass  # not there, or damaged: record it again
    _LOG.warning(
        "recording %.0f s of traffic on '%s' with SUMO %s, once; kept in %s",
        *(duration, graph.map_name, origin.sumo_version, path),
    )
    assert wanted.seed is not None
    made = record(graph.map_name, graph.seed, graph, wanted, duration, wanted.seed)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        save(made, path)
    except (OSError, OutputError) as error:
        _LOG.warning("the recording is used but not kept: %s", error)
    return made
