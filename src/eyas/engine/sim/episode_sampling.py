"""What is sampled at random when an episode begins, for all trackers in one kernel call.

In Python it took 100 µs for each tracker, a third of what a picture takes.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import room_key
from eyas.engine.core.variation import Rule, sampled
from eyas.engine.sim.light import LightRules, change_light
from eyas.engine.state.episode import EpisodeState
from eyas.engine.state.snapshot import Snapshot, TargetState
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.looks import LookTable, sample_looks
from eyas.engine.task.spawn import start_distance
from eyas.engine.traffic.source import Stays
from eyas.lanes import compiled, kernel
from eyas.lanes.pcg64 import begin_stream, whole

_LOOKS, _LIGHT, _CAMERA, _EPISODE = map(room_key, ("looks", "light", "camera", "episode"))

ATTEMPTS: Final = 100  # Number of start times that are tried

_TIMES: Final = 10  # Number of start times after which half the stay of a vehicle is enough

_ROUNDING: Final = 1e-9  # Tolerance for rounding errors in times that are multiples of 2 ms [s]


class Streams(NamedTuple):
    """What the random numbers of N trackers depend on, beside the number of the episode."""

    seed: NDArray[np.int64]  # Seed of each, shape (N,)
    number: NDArray[np.int64]  # Number of each among those with its seed, shape (N,)


class ModelTable(NamedTuple):
    """The M models of the catalogue, as far as targets have their numbers; see `TargetState`."""

    size: NDArray[np.float64]  # [m], shape (M, 3)
    rise: NDArray[np.float64]  # [m], shape (M,)
    ahead: NDArray[np.float64]  # [m], shape (M,)
    slowest: NDArray[np.float64]  # [m/s], shape (M,)
    flies: NDArray[np.bool_]  # Shape (M,)


class SamplingRules(NamedTuple):
    """How episodes are sampled: settings, and limits that follow from them."""

    pitch: Rule  # The start: the fields of `StartConfig`, in the order in which they are sampled
    horizontal_bias: Rule
    vertical_bias: Rule
    height: Rule
    direction: Rule
    field_of_view: Rule  # [rad]
    varied_field: int  # 1: the field of view is sampled; 0: it is a number
    same_target: int  # 1: trackers that share a world follow one target
    first_tick: int  # Earliest start [physics steps]
    times: int
    """Number of starts that leave enough of the traffic for a whole episode [physics steps]."""
    last_tick: int  # End of the traffic [physics steps]
    steps: int  # Longest episode [physics steps]


class EpisodeSampling(NamedTuple):
    """Everything that the sampling of episodes reads and writes."""

    snapshot: Snapshot
    world_of: NDArray[np.int32]  # World of each tracker, shape (N,)
    leader: NDArray[np.int64]  # First tracker of each world, shape (W,)
    lasting: NDArray[np.bool_]  # Whether the time of each world goes on, shape (W,)
    side: NDArray[np.float64]
    """What is added to the sampled direction of each tracker, whose target others may follow, too
    [rad], shape (N,)."""
    looks: Looks
    look_table: LookTable
    models: ModelTable
    light: LightRules
    rules: SamplingRules
    streams: Streams
    free: NDArray[np.bool_]  # Working memory: whether each actor may be the target, shape (A,)
    state: NDArray[np.int64]
    """Working memory: a random stream, see `eyas.lanes.pcg64`, shape (`STATE`,)."""


class Call(NamedTuple):
    """The input and output of one call."""

    starts: NDArray[np.int64]  # Number of trackers that begin an episode, K, shape (1,)
    chosen: NDArray[np.int64]  # Those trackers, in the first K of N elements
    pitch: NDArray[np.float64]
    """Their sampled camera pitch, positive down [rad], in the first K of N elements; written."""
    problem: NDArray[np.int64]
    """A tracker that has no target, or -1; how many actors could be followed, or -1 if that is not
    known yet; how many trackers of its world have a target, or when that must be known [physics
    steps], shape (3,); written."""

    @classmethod
    def create(cls, trackers: int) -> "Call":
        """Return a call for up to N trackers."""
        return cls(
            np.zeros(1, np.int64),
            np.zeros(trackers, np.int64),
            np.zeros(trackers),
            np.full(3, -1, np.int64),
        )


@compiled
def sample_episodes(sampling: EpisodeSampling, stays: Stays, call: Call) -> None:
    """Draw episodes one after the other: who shares a world takes what others leave."""
    count, targets = call.starts[0], sampling.snapshot.targets
    call.problem[0] = -1
    for k in range(count):
        targets.actor[call.chosen[k]] = -1
    for k in range(count):
        n = call.chosen[k]
        sampling.snapshot.episodes.number[n] += 1
        _sample_world(sampling, n)
        _stream(sampling, n, _EPISODE)
        if not _sample_target(sampling, stays, n, call.problem):
            if call.problem[1] < 0:  # it is sampled again
                sampling.snapshot.episodes.number[n] -= 1
            return
        _sample_start(sampling, n, call.pitch, k)


@kernel(inline=True)
def _stream(sampling: EpisodeSampling, n: int, room: int) -> None:
    """Begin the stream of a room in a tracker's episode."""
    episode = sampling.snapshot.episodes.number[n]
    begin_stream(
        sampling.state, sampling.streams.seed[n], room, sampling.streams.number[n], episode
    )


@kernel(inline=True)
def _sample_world(sampling: EpisodeSampling, n: int) -> None:
    """Draw what is around a tracker: looks, light; and its lens."""
    world, first = sampling.world_of[n], sampling.snapshot.episodes.number[n] == 0
    leads = n == sampling.leader[world]
    if not sampling.lasting[world] or (leads and first):
        _stream(sampling, n, _LOOKS)
        sample_looks(
            sampling.look_table,
            sampling.looks.model[world],
            sampling.looks.colour[world],
            sampling.state,
        )
    if sampling.light.changes == 1 and leads and (first or sampling.light.each_reset == 1):
        _stream(sampling, n, _LIGHT)
        sky, sun, density = change_light(sampling.light, sampling.state)
        for other in range(len(sampling.world_of)):
            if sampling.world_of[other] == world:
                light = sampling.snapshot.light
                light.sky[other], light.sun[other], light.fog_density[other] = sky, sun, density
    if sampling.rules.varied_field == 1:  # a stream costs a microsecond
        _stream(sampling, n, _CAMERA)
    sampling.snapshot.cameras.field_of_view[n] = sampled(
        sampling.rules.field_of_view, sampling.state
    )


@kernel(inline=True)
def _sample_target(
    sampling: EpisodeSampling, stays: Stays, n: int, problem: NDArray[np.int64]
) -> bool:
    """Draw time and target of an episode; return whether there is one, else see `Call.problem`.

    If vehicles come and go, none may stay for a whole episode. Then other times are tried, and
    vehicles that stay for a shorter time; in a lasting world, whose time is given, only these.
    """
    rules = sampling.rules
    lasting = sampling.lasting[sampling.world_of[n]]
    tick = _now(sampling, n) if lasting else 0
    if lasting and rules.same_target == 1:
        followed = _followed(sampling, stays, n, tick * PHYSICS_STEP)
        if followed >= 0:
            _follow(sampling, n, followed, tick)
            return True
    for attempt in range(ATTEMPTS):
        if not lasting:
            tick = rules.first_tick + whole(sampling.state, rules.times)
        steps = rules.steps >> (attempt if lasting else attempt // _TIMES)
        start = tick * PHYSICS_STEP
        if start >= stays.known:
            problem[0], problem[1], problem[2] = n, -1, tick
            return False
        end = min(tick + steps, rules.last_tick) * PHYSICS_STEP
        here, followed = _free_targets(sampling, stays, n, start, end)
        actor = _any_of(sampling.free, sampling.state)
        if actor >= 0:
            _follow(sampling, n, actor, tick)
            return True
        if attempt == ATTEMPTS - 1 or steps == 0:
            problem[0], problem[1], problem[2] = n, here, followed
            return False
    return False


@kernel(inline=True)
def _now(sampling: EpisodeSampling, n: int) -> int:
    """Return the latest time of a tracker's world, or the first time [physics steps]."""
    tick, world = sampling.rules.first_tick, sampling.world_of[n]
    for other in range(len(sampling.world_of)):
        if sampling.world_of[other] == world:
            tick = max(tick, sampling.snapshot.episodes.tick[other])
    return tick


@kernel(inline=True)
def _followed(sampling: EpisodeSampling, stays: Stays, n: int, time: float) -> int:
    """Return the target of the first tracker of a world that follows one who is there, or -1."""
    world, actors = sampling.world_of[n], sampling.snapshot.targets.actor
    for other in range(len(sampling.world_of)):
        if sampling.world_of[other] == world and actors[other] >= 0:
            for stay in range(len(stays.actor)):
                if stays.actor[stay] == actors[other] and _covers(stays, stay, time, time):
                    return int(actors[other])
    return -1


@kernel(inline=True)
def _covers(stays: Stays, stay: int, start: float, end: float) -> bool:
    return bool(stays.enters[stay] - _ROUNDING <= start) and bool(
        end - _ROUNDING <= stays.leaves[stay]
    )


@kernel(inline=True)
def _free_targets(
    sampling: EpisodeSampling, stays: Stays, n: int, start: float, end: float
) -> tuple[int, int]:
    """Find out whether each actor stays from `start` to `end` [s] and nobody follows it.

    Returns:
        How many stay, and how many of the tracker's world are followed.
    """
    free, world = sampling.free, sampling.world_of[n]
    for actor in range(len(free)):
        free[actor] = False
    here, followed = 0, 0
    for stay in range(len(stays.actor)):
        actor = stays.actor[stay]
        if not free[actor] and _covers(stays, stay, start, end):
            free[actor] = True
            here += 1
    if sampling.lasting[world]:
        for other in range(len(sampling.world_of)):
            actor = int(sampling.snapshot.targets.actor[other])
            if sampling.world_of[other] == world and actor >= 0:
                free[actor] = False
                followed += 1
    return here, followed


@kernel(inline=True)
def _any_of(free: NDArray[np.bool_], state: NDArray[np.int64]) -> int:
    """Return one of the free actors, each as likely, or -1."""
    count = 0
    for actor in range(len(free)):
        count += free[actor]
    if count == 0:
        return -1
    left = whole(state, count)
    for actor in range(len(free)):
        if free[actor]:
            if left == 0:
                return actor
            left -= 1
    return -1


@kernel(inline=True)
def _follow(sampling: EpisodeSampling, n: int, actor: int, tick: int) -> None:
    """Make an actor of its world the target of tracker n, at a time of it [physics steps]."""
    sampling.snapshot.episodes.tick[n] = tick
    model = int(sampling.looks.model[sampling.world_of[n], actor])
    follow(sampling.snapshot.targets, sampling.snapshot.episodes, sampling.models, n, actor, model)


@kernel(inline=True)
def follow(
    targets: TargetState, episodes: EpisodeState, models: ModelTable, n: int, actor: int, model: int
) -> None:
    """Make an actor of a model, see `eyas.engine.targets.catalogue.MODELS`, the target of
    tracker n.
    """
    # Relative motion restarts here, since a change of target is not a motion.
    episodes.observations[n] = 0
    targets.actor[n], targets.model[n] = actor, model
    targets.lost[n] = False
    for axis in range(3):
        episodes.relative_velocity[n, axis] = episodes.relative_acceleration[n, axis] = 0.0
        targets.size[n, axis] = models.size[model, axis]
    targets.rise[n], targets.ahead[n] = models.rise[model], models.ahead[model]
    targets.slowest[n], targets.flies[n] = models.slowest[model], models.flies[model]


@kernel(inline=True)
def _sample_start(sampling: EpisodeSampling, n: int, pitches: NDArray[np.float64], k: int) -> None:
    """Draw a start in the original's order, and set it relative to the target."""
    rules, state = sampling.rules, sampling.state
    pitch = sampled(rules.pitch, state)
    left = sampled(rules.horizontal_bias, state)
    vertical_bias = sampled(rules.vertical_bias, state)
    height = sampled(rules.height, state)
    direction = sampled(rules.direction, state) + sampling.side[n]
    ahead = sampling.snapshot.targets.ahead[n]
    offset = sampling.snapshot.episodes.start_offset[n]
    offset[0], offset[1] = start_distance(pitch, height, vertical_bias, ahead), left
    offset[2], offset[3] = height, direction
    pitches[k] = pitch
