"""Selection of a recording: the one named by the user, the shipped, a cached or a new one."""

import hashlib
import json
import logging
import re
from collections.abc import Callable
from importlib.resources.abc import Traversable
from pathlib import Path

from eyas.core.cache.entries import write_entry
from eyas.core.cache.folder import Kind, cache_folder, cache_limit, touch
from eyas.core.errors import ConfigError, DataFileError
from eyas.core.files import user_path
from eyas.state.roads import RoadGraph
from eyas.traffic.config import TrafficConfig
from eyas.traffic.network import graph_hash
from eyas.traffic.record import WARM_UP, record, resolved
from eyas.traffic.recording import Recording, check_map
from eyas.traffic.recording_file import FORMAT, load, save, to_bytes
from eyas.traffic.sumo import OPTIONS
from eyas.traffic.sumo_install import sumo_version

__all__ = [
    "CANONICAL_SEED",
    "STANDARD_DURATION",
    "find_recording",
    "record_canonical",
]

_LOG = logging.getLogger("eyas")

CANONICAL_SEED = 1
"""Seed of the shipped recordings, and the default seed of others."""

STANDARD_DURATION = 1260.0
"""Default length of a recording: 21 minutes [s]."""

_RECORDER = 1
"""Increased by 1 when the same settings give different traffic, so that cached recordings are
made anew."""


def find_recording(
    graph: RoadGraph,
    config: TrafficConfig,
    *,
    trackers: int = 1,
    duration: float = STANDARD_DURATION,
    shipped: Traversable | None = None,
) -> Recording:
    """Return the recording to replay: the named, the shipped, a cached or a new one.

    Before a new recording is made, one line in the log `eyas` says so; Python prints it.

    Args:
        graph: Roads to drive on.
        config: Settings of the traffic.
        trackers: Number of trackers, which determines the default size of a group.
        duration: Smallest duration of the recording [s].
        shipped: File of the recording that comes with the map, if there is one.

    Raises:
        DataFileError: The named recording cannot be read or is of another map.
        ConfigError: No recording fits, and `update_routes` forbids a new one.
        MissingExtraError: No recording fits, and SUMO is not installed.
    """
    if config.recording is not None:
        path = user_path(config.recording)
        named = load(path)
        check_map(named, graph.map_name, graph.seed, graph_hash(graph), str(path))
        return named
    seed = CANONICAL_SEED if config.seed is None else config.seed
    wanted = resolved(config, seed, trackers)
    found = _fitting(shipped, graph, wanted) if shipped is not None else None
    if found is not None and found.duration >= duration:
        return found
    if not config.update_routes:
        raise ConfigError(
            "traffic.update_routes: false, but no recording fits these settings; allowed: true, "
            "or the settings of the shipped recording, or traffic.recording"
        )
    return _cached_or_new(graph, wanted, duration)


def record_canonical(
    graph: RoadGraph, path: Path, progress: Callable[[float], None] | None = None
) -> None:
    """Record the canonical traffic of a map (its seed 0), to be shipped with it.

    For developers of a map, after a change in its roads.

    Raises:
        MissingExtraError: SUMO is not installed.
        OutputError: The file cannot be written.
    """
    name, seed = graph.map_name, graph.seed
    made = record(name, seed, graph, TrafficConfig(), STANDARD_DURATION, CANONICAL_SEED, progress)
    save(made, path)


def _cache_file(graph: RoadGraph, wanted: TrafficConfig, duration: float) -> Path:
    """Return the path of a recording in the cache.

    It does not depend on the version of SUMO, so that users without SUMO can use recordings made
    by others.

    Args:
        graph: Roads to drive on.
        wanted: Settings of the traffic, from `resolved`.
        duration: Length of the recording [s].
    """
    content = {
        "roads": graph_hash(graph),
        "config": wanted.model_dump(mode="json"),
        "duration": duration,
        "warm_up": WARM_UP,
        "options": OPTIONS,
        "recorder": _RECORDER,
        "format": FORMAT,
    }
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
    name = re.sub(r"[^\w.-]", "_", graph.map_name)
    return cache_folder() / Kind.TRAFFIC / f"{name}-{graph.seed}-{key}.npz"


def _fitting(file: Traversable, graph: RoadGraph, wanted: TrafficConfig) -> Recording | None:
    """Return a shipped recording if it fits the settings, else None."""
    recording = load(file)
    return recording if _fits(recording, graph, wanted) else None


def _fits(recording: Recording, graph: RoadGraph, wanted: TrafficConfig) -> bool:
    origin = recording.provenance
    return (origin.graph_hash, origin.config) == (graph_hash(graph), wanted)


def _cached_or_new(graph: RoadGraph, wanted: TrafficConfig, duration: float) -> Recording:
    limit, path = cache_limit(), _cache_file(graph, wanted, duration)
    kept = _cached(path)
    if kept is not None and _fits(kept, graph, wanted):
        touch(path)
        return kept
    _LOG.warning(
        "recording %.0f s of traffic on '%s' with SUMO %s, once; kept in %s",
        *(duration, graph.map_name, sumo_version(), path),
    )
    assert wanted.seed is not None
    made = record(graph.map_name, graph.seed, graph, wanted, duration, wanted.seed)
    try:
        write_entry(path, [to_bytes(made)], limit)
    except OSError as error:
        _LOG.warning("the recording is used but could not be cached: %s: %s", path, error.strerror)
    return made


def _cached(path: Path) -> Recording | None:
    """Return a recording from the cache; None if it is missing or damaged."""
    try:
        return load(path)
    except DataFileError:
        return None
