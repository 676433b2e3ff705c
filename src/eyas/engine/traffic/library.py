"""Selection of a recording: the one named by the user, the shipped, a cached or a new one."""

import hashlib
import json
import logging
import re
from collections.abc import Callable, Iterable, Mapping
from importlib.resources.abc import Traversable
from pathlib import Path

from eyas.engine.core.cache.entries import write_entry
from eyas.engine.core.cache.folder import EntryKind, cache_limit
from eyas.engine.core.config import shown
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import user_path
from eyas.engine.core.identity.program import code_of
from eyas.engine.core.rng import TEST_SEEDS
from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic.config import Demand, Drivers, Mix, Signals, TrafficConfig
from eyas.engine.traffic.cover import Cover, cover_hash
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.record import GROUP_SHARE, WARM_UP, record, resolved
from eyas.engine.traffic.recording import Provenance, TrafficRecording, check_map
from eyas.engine.traffic.recording_file import RecordingFile, save, to_bytes
from eyas.engine.traffic.sumo import options
from eyas.engine.traffic.sumo_install import sumo_version
from eyas.lanes.trusted import cache_folder, touch

_LOG = logging.getLogger("eyas")

CANONICAL_SEED = 1  # Seed of the shipped recordings, and the default seed of others

RESPAWN_GROUPS = (3, 5, 10, 12, 40)
"""Sizes of the groups in the shipped recordings with `respawn`: 3 for one tracker and 12 for the
four of a video by default; 5 in the manual's example; 10 in the original's own file; 40 for
more trackers: as many as there are vehicles, so one enters soon after another has left."""

_SHARED_OUT = 0.75
"""Largest share of vehicles that come and go which trackers may follow: beyond it, some find none
that stays for an episode of 3 s (of 40, at least 31 did at any time on each of the maps)."""

CANONICAL_MIX = Mix(passenger=0.7, bus=0.1, truck=0.1, trailer=0.05, motorcycle=0.05)
"""Classes of vehicles in the shipped recordings of a mixed fleet, which the two cities have."""

DENSE_VEHICLES = 320
"""Vehicles in the shipped recordings of dense traffic: downtown then has eight in a view of 38 x 28
m now and then (with 160, never), and citystreet, which has room for 399, still flows."""

DENSE_DURATION = 300.0  # Length of these: as many vehicle hours as in the others [s]
DENSE_TEST_DURATION = 80.0  # Length of those for tests, whose episodes take 20 s [s]
EVADING_MIX = Mix(passenger=0.75, bus=0.15, truck=0.1)
"""Classes of vehicles in the shipped recordings of drivers who evade: no trailers, whose tails
swing into cars that turn round beside them."""

STANDARD_DURATION = 1260.0  # Default length of a recording: 21 minutes [s]

TEST_TRAFFIC = tuple(TEST_SEEDS + number for number in (1, 2, 3))
"""Seeds of the recordings that ship for tests, see `TEST_SEEDS`."""

TEST_DURATION = 600.0
"""Least length of a recording with such a seed: that of the longest episodes, `long-10` [s]."""


def find_file(
    graph: RoadGraph,
    config: TrafficConfig,
    *,
    trackers: int = 1,
    duration: float | None = None,
    shipped: Iterable[Traversable] = (),
    cover: Callable[[], Cover] = tuple,
) -> RecordingFile:
    """Return the file of the recording to replay: the named, the shipped, a cached or a new one.

    Before a new recording is made, one line in the log `eyas` says so; Python prints it.

    Args:
        graph: Roads to drive on.
        config: Settings of the traffic.
        trackers: Number of trackers in a world, which determines the least size of a group.
        duration: Smallest duration of the recording [s]; None: that of its seed.
        shipped: Files of the recordings that come with the map.
        cover: Returns the stretches of lanes in which drivers hide; called where they do and no
            recording is shipped.

    Raises:
        DataFileError: The named recording cannot be read or is of another map.
        MissingExtraError: No recording fits, and SUMO is not installed.
    """
    if config.recording is not None:
        return _named(user_path(config.recording), graph, config)
    if graph.finished:  # has its own signals, which always work
        config = config.model_copy(update={"signals": Signals.AMBER})
    seed = CANONICAL_SEED if config.seed is None else config.seed
    wanted = resolved(_lasting(config, trackers), seed, trackers)
    if duration is None:
        duration = TEST_DURATION if seed >= TEST_SEEDS else STANDARD_DURATION
    _tell_raised(config, wanted, trackers)
    others: dict[RecordingFile, Provenance] = {}
    for file in shipped:
        found = RecordingFile.read(file)
        origin = found.outline().provenance
        if _fits(origin, graph, wanted):  # as long as whoever made the map wants it
            return found
        others[found] = origin
    if _may_be_larger(config, trackers):
        roomy = _with_larger_groups(others, graph, wanted, duration)
        if roomy is not None:
            _LOG.info(
                "traffic: groups of %d vehicles for %d trackers, the next that are shipped; "
                "traffic.group_size=%d has SUMO record such groups",
                *(others[roomy].config.group_size or 0, trackers, wanted.group_size or 0),
            )
            return roomy
    known = cover() if wanted.drivers is not Drivers.NORMAL else ()
    kept = _cached(graph, wanted, duration, known)
    if kept is not None:
        return kept
    reason = _reason(others.values(), graph, wanted, duration)
    if not config.update_routes:
        reason = f"although traffic.update_routes (Sumo_Params.rou_update) is false, {reason}"
    return _new(graph, wanted, duration, known, reason)


def is_shipped(graph: RoadGraph, config: TrafficConfig, shipped: Iterable[Traversable]) -> bool:
    """Return whether a recording of some traffic comes with a map, so that SUMO is not needed.

    Args:
        graph: Roads to drive on.
        config: Settings of the traffic.
        shipped: Files of the recordings that come with the map.
    """
    wanted = resolved(config, CANONICAL_SEED if config.seed is None else config.seed)
    found = (RecordingFile.read(file).outline().provenance for file in shipped)
    return any(_fits(origin, graph, wanted) for origin in found)


def _named(path: Path, graph: RoadGraph, config: TrafficConfig) -> RecordingFile:
    """Return the file of a recording that the user has named."""
    named = RecordingFile.read(path)
    origin = named.outline().provenance
    check_map(origin, graph.map_name, graph.seed, graph_hash(graph), str(path))
    obeyed = graph.finished or origin.config.signals is Signals.WORKING
    if config.signals is Signals.WORKING and not obeyed:
        raise DataFileError(
            f"{path}: its drivers knew no traffic lights; allowed with traffic.signals='working': "
            "a recording made with it (eyas traffic record)"
        )
    return named


def find_recording(
    graph: RoadGraph,
    config: TrafficConfig,
    *,
    trackers: int = 1,
    duration: float | None = None,
    shipped: Iterable[Traversable] = (),
) -> TrafficRecording:
    """Return the recording of `find_file`."""
    return find_file(graph, config, trackers=trackers, duration=duration, shipped=shipped).load()


def known_recording(
    graph: RoadGraph, config: TrafficConfig, shipped: Iterable[Traversable] = ()
) -> TrafficRecording | None:
    """Return the shipped or the cached recording of `find_file`; None: it is not made yet."""
    if graph.finished:
        config = config.model_copy(update={"signals": Signals.AMBER})
    wanted = resolved(config, CANONICAL_SEED if config.seed is None else config.seed)
    for file in map(RecordingFile.read, shipped):
        if _fits(file.outline().provenance, graph, wanted):
            return file.load()
    kept = _cached(graph, wanted, STANDARD_DURATION, ())
    return None if kept is None else kept.load()


def obeys_signals(
    graph: RoadGraph,  # Roads to drive on
    config: TrafficConfig,  # Settings of the traffic
    # File of the recording of drivers who do; None: none is shipped
    shipped: Traversable | None = None,
) -> bool:
    """Return whether the recording of settings that leave signals open is one whose drivers obey
    them: that which the user names, or the shipped one if all other settings are its.

    Raises:
        DataFileError: A recording cannot be read.
    """
    if config.recording is not None:
        named = RecordingFile.read(user_path(config.recording))
        return named.outline().provenance.config.signals is Signals.WORKING
    if shipped is None or config.demand is not Demand.KEEP_ALIVE:
        return False
    wanted = config.model_copy(update={"signals": Signals.WORKING})
    seed = CANONICAL_SEED if config.seed is None else config.seed
    origin = RecordingFile.read(shipped).outline().provenance
    return _fits(origin, graph, resolved(wanted, seed))


def record_canonical(
    graph: RoadGraph,  # Roads of the map
    path: Path,  # The file
    config: TrafficConfig | None = None,  # Settings of the traffic; None: the default
    progress: Callable[[float], None] | None = None,  # Called with the completed share, 0 to 1
    *,
    cover: Cover = (),  # The stretches of lanes in which drivers hide
    duration: float = STANDARD_DURATION,  # Its length [s]
) -> None:
    """Record traffic of a map, to be shipped with it.

    For developers of a map, after a change in its roads.

    Raises:
        MissingExtraError: SUMO is not installed.
        OutputError: The file cannot be written.
    """
    name, seed, chosen = graph.map_name, graph.seed, config or TrafficConfig()
    sampled = CANONICAL_SEED if chosen.seed is None else chosen.seed
    made = record(name, seed, graph, chosen, duration, sampled, progress, cover=cover)
    save(made, path)


def _cache_file(
    graph: RoadGraph,  # Roads to drive on
    wanted: TrafficConfig,  # Settings of the traffic, from `resolved`
    duration: float,  # Length of the recording [s]
    cover: Cover,  # The stretches of lanes in which drivers hide
) -> Path:
    """Return the path of a recording in the cache.

    It does not depend on the version of SUMO, so that users without SUMO can use recordings made
    by others.
    """
    content = {
        "roads": graph_hash(graph),
        "config": wanted.model_dump(mode="json"),
        "duration": duration,
        "warm_up": WARM_UP,
        "options": options(wanted),
        "cover": cover_hash(cover),
        "code": code_of(_recorded),
    }
    key = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]
    name = re.sub(r"[^\w.-]", "_", graph.map_name)
    return cache_folder() / EntryKind.TRAFFIC / f"{name}-{graph.seed}-{key}.npz"


def _lasting(config: TrafficConfig, trackers: int) -> TrafficConfig:
    """Return the settings, without vehicles that leave if these are too few for the trackers."""
    if config.demand is Demand.KEEP_ALIVE or trackers <= _SHARED_OUT * config.max_vehicles:
        return config
    _LOG.warning(
        "traffic: of %d vehicles that come and go, too few stay for %d trackers; so none leaves "
        "(traffic.demand: 'keep_alive')",
        *(config.max_vehicles, trackers),
    )
    return config.model_copy(update={"demand": Demand.KEEP_ALIVE})


def _may_be_larger(config: TrafficConfig, trackers: int) -> bool:
    """Return whether the number of trackers, not the user, determines the size of the groups."""
    said = config.group_size
    return config.demand is Demand.RESPAWN and (said is None or said < GROUP_SHARE * trackers)


def _with_larger_groups(
    others: Mapping[RecordingFile, Provenance],
    graph: RoadGraph,
    wanted: TrafficConfig,
    duration: float,
) -> RecordingFile | None:
    """Return the recording with the least groups that are large enough; None if there is none.

    More than all vehicles there are cannot enter together, so groups of that size are enough.
    """
    least, found = min(wanted.group_size or 0, wanted.max_vehicles), dict[int, RecordingFile]()
    for file, origin in others.items():
        size = origin.config.group_size
        if origin.config.demand is Demand.KEEP_ALIVE or size is None or size < least:
            continue
        alike = _fits(origin, graph, wanted.model_copy(update={"group_size": size}))
        if alike and origin.duration >= duration:
            found[size] = file
    return found[min(found)] if found else None


def _tell_raised(config: TrafficConfig, wanted: TrafficConfig, trackers: int) -> None:
    said, used = config.group_size, wanted.group_size
    if said is not None and used is not None and used > said:
        _LOG.warning(
            "traffic.group_size (Sumo_Params.car_group_num): %d raised to %d, %d for each tracker, "
            "of which a world has %d",
            *(said, used, GROUP_SHARE, trackers),
        )


def _fits(origin: Provenance, graph: RoadGraph, wanted: TrafficConfig) -> bool:
    return (origin.graph_hash, origin.config) == (graph_hash(graph), wanted)


def _cached(
    graph: RoadGraph, wanted: TrafficConfig, duration: float, cover: Cover
) -> RecordingFile | None:
    """Return a recording from the cache; None if it is missing or damaged, or of other traffic."""
    path = _cache_file(graph, wanted, duration, cover)
    try:
        kept = RecordingFile.read(path)
        origin = kept.load().provenance  # whole, or it is recorded again
    except DataFileError:
        return None
    if origin.duration < duration or not _fits(origin, graph, wanted):
        return None
    touch(path)
    return kept


def _reason(
    others: Iterable[Provenance], graph: RoadGraph, wanted: TrafficConfig, duration: float
) -> str:
    """Return why none of other recordings fits: how the most alike of them differs."""
    differences = [_differences(origin, graph, wanted, duration) for origin in others]
    if not differences:
        return "for there is none yet"
    fewest = min(differences, key=lambda told: len(told))
    return f"for {', '.join(fewest)}"


def _differences(
    origin: Provenance, graph: RoadGraph, wanted: TrafficConfig, duration: float
) -> list[str]:
    """Return what of a new recording is not as in one that is shipped."""
    told = []
    if origin.graph_hash != graph_hash(graph):
        told.append(f"the roads are those of seed {graph.seed}")
    new, old = wanted.model_dump(mode="json"), origin.config.model_dump(mode="json")
    told += [
        f"traffic.{name} is {shown(new[name])} (shipped: {shown(old[name])})"
        for name in new
        if new[name] != old[name]
    ]
    if origin.duration < duration:
        told.append(f"it must last {duration:g} s (shipped: {origin.duration:g} s)")
    return told


def _new(
    graph: RoadGraph, wanted: TrafficConfig, duration: float, cover: Cover, reason: str
) -> RecordingFile:
    """Return a new recording, and keep it in the cache."""
    limit, path = cache_limit(), _cache_file(graph, wanted, duration, cover)
    version = sumo_version("new traffic, as no recording fits the settings,")
    _LOG.warning(
        "recording %.0f s of traffic on '%s' with SUMO %s, %s; kept for the same settings in %s",
        *(duration, graph.map_name, version, reason, path),
    )
    assert wanted.seed is not None
    data = _recorded(graph, wanted, duration, wanted.seed, cover)
    try:
        write_entry(path, [data], limit)
    except OSError as error:
        _LOG.warning("the recording is used but could not be cached: %s: %s", path, error.strerror)
    return RecordingFile(data, str(path))


def _recorded(
    graph: RoadGraph, wanted: TrafficConfig, duration: float, seed: int, cover: Cover
) -> bytes:
    name, map_seed = graph.map_name, graph.seed
    return to_bytes(record(name, map_seed, graph, wanted, duration, seed, cover=cover))
