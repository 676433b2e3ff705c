"""Episodes: the start time, target and start pose of each."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import ConfigError, SpawnError
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import rule_of
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.episode_sampling import (
    Call,
    EpisodeSampling,
    ModelTable,
    SamplingRules,
    Streams,
    follow,
    sample_episodes,
)
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.starts import FreeStarts
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.targets.catalogue import MODELS, kind_index, kind_of
from eyas.engine.traffic.config import VehicleType
from eyas.engine.traffic.replay import check_time
from eyas.engine.traffic.source import Stays, TrafficSource
from eyas.lanes import PackedBundle, interpreted
from eyas.lanes.pcg64 import STATE

Sampler = Callable[[int, EpisodeKey], None]  # Draws something for the episode of a tracker

_follow = interpreted(follow)

_ATTEMPTS = 100  # Starts that are tried for an episode

_ATTEMPT = 1 << 24
"""More than the episodes of a tracker: added to their number, it gives another stream."""


class Episodes:
    """Draws the episodes of N trackers.

    The random values of an episode depend only on the seed, the tracker and the episode's number
    (and, in a world of several trackers, on the targets of the others), not on the number of
    trackers.

    Attributes:
        models: What targets of each model have in common.

    Args:
        config: The settings.
        traffic: The traffic with the possible targets.
        worlds: The worlds of the trackers.
        light: The light around them.
        snapshot: State of N trackers; this class sets its episodes and targets, and the
            fields of view of its cameras.
        samplers: Sample what else is random in an episode.
        starts: Tells which starts are inside something, and are drawn again; None: none.
    """

    def __init__(
        self,
        config: SimConfig,
        traffic: TrafficSource,
        worlds: Worlds,
        light: LightChanges,
        snapshot: Snapshot,
        samplers: Sequence[Sampler] = (),
        starts: FreeStarts | None = None,
    ) -> None:
        self._samplers, self._starts = tuple(samplers), starts
        count = len(snapshot.episodes.number)
        self._streams = Streams(np.full(count, config.seed, np.int64), np.arange(count))
        self._traffic, self._worlds = traffic, worlds
        self._episodes, self._targets = snapshot.episodes, snapshot.targets
        self.models = _model_table()
        self._rules = _rules(config, int(traffic.duration / PHYSICS_STEP))
        self._may_follow = _followed_kinds(config, traffic)
        self._sides = _sides(config, worlds)
        self._draw = PackedBundle(
            EpisodeSampling(
                snapshot,
                worlds.of,
                worlds.leader,
                worlds.lasting,
                self._sides,
                worlds.looks,
                worlds.look_table,
                self.models,
                light.rules,
                self._rules,
                self._streams,
                free=np.zeros(traffic.actors, np.bool_),
                state=np.zeros(STATE, np.int64),
            )
        )
        self._call = PackedBundle(Call.create(count))
        self._bind()

    def _bind(self) -> None:
        """Bind the sampling of episodes to what is known of the traffic."""
        stays = self._traffic.stays()
        if self._may_follow is not None:
            kept = self._may_follow[stays.actor]
            actor, enters, leaves, known = stays
            stays = Stays(actor[kept], enters[kept], leaves[kept], known)
        self._drawn = sample_episodes.bind(self._draw, stays, self._call)

    def reseed(self, seed: int) -> None:
        """Begin the sequence of episodes of another seed."""
        self._streams.seed[:] = seed
        self._streams.number[:] = np.arange(len(self._streams.number))
        self._episodes.number[:] = -1

    def reseed_alone(self, trackers: NDArray[np.integer], seeds: NDArray[np.integer]) -> None:
        """Begin the episodes that the only tracker of a simulation has with each of these seeds."""
        assert not self._worlds.lasting[self._worlds.of[trackers]].any(), "a world of one's own"
        self._streams.seed[trackers] = seeds
        self._streams.number[trackers] = 0
        self._episodes.number[trackers] = -1

    def turn_starts(self, angles: NDArray[np.float64]) -> None:
        """Add angles to the start directions of all trackers [rad], shape (N,)."""
        self._sides[:] = angles

    def continue_from(self, other: "Episodes") -> None:
        """Continue the sequences of episodes of another simulation with as many trackers."""
        for mine, others in zip(self._streams, other._streams, strict=True):
            mine[:] = others
        self._episodes.number[:] = other._episodes.number

    @property
    def steps_left(self) -> int:
        """Physics steps until the end of the traffic, for the tracker whose time is latest."""
        return self._rules.last_tick - int(self._episodes.tick.max())

    def rewind(self) -> None:
        """Begin the traffic anew; takes effect when all trackers are reset at once."""
        self._episodes.tick[:] = 0

    def begin(self, trackers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Set target, time and offset of trackers; return their camera pitches [rad].

        A start that is inside something is drawn again. Where time and target are given, in a
        world that trackers share, it may have to be higher instead.

        Raises:
            SpawnError: No target is free, or no start.
            ConfigError: The traffic of a shared world has ended.
        """
        lasting = self._worlds.lasting[self._worlds.of[trackers]]
        if lasting.any():
            time = int(self._episodes.tick[trackers[lasting]].max()) * PHYSICS_STEP
            check_time(time, self._traffic.duration)
        pitch = self._sample(trackers)
        if self._starts is not None:
            self._sample_again(trackers, pitch, self._starts)
        for sampler in self._samplers:
            for tracker in trackers.tolist():
                sampler(tracker, self.key(tracker))
        return pitch

    def _sample_again(
        self, trackers: NDArray[np.int64], pitch: NDArray[np.float64], starts: FreeStarts
    ) -> None:
        """Draw those starts again that are inside something."""
        number, lifts = self._episodes.number, starts.lifts(trackers)
        for attempt in range(1, _ATTEMPTS):
            inside = np.flatnonzero(lifts)
            if not len(inside):
                return
            again = trackers[inside]
            episode = number[again]
            number[again] += attempt * _ATTEMPT - 1  # which sampling counts up
            try:
                pitch[inside] = self._sample(again)
            finally:
                number[again] = episode
            lifts[inside] = starts.lifts(again)
        shared = self._worlds.lasting[self._worlds.of[trackers]]
        if (lifts[~shared] != 0.0).any():
            raise SpawnError(
                f"start: {_ATTEMPTS} starts were drawn, and all are inside a tree, a building or "
                "the ground; allowed: a height, pitch, direction and biases that leave some free"
            )
        self._episodes.start_offset[trackers, 2] += lifts

    def _sample(self, trackers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Draw target, time and offset of trackers; return their camera pitches [rad]."""
        call, pitch, begun = self._call.bundle, np.empty(len(trackers)), 0
        while begun < len(trackers):
            left = len(trackers) - begun
            call.starts[0] = left
            call.chosen[:left] = trackers[begun:]
            self._drawn()
            stopped, here, more = call.problem.tolist()
            done = left if stopped < 0 else call.chosen[:left].tolist().index(stopped)
            pitch[begun : begun + done] = call.pitch[:done]
            begun += done
            if here >= 0 and stopped >= 0:
                raise _no_target(here, more)
            if stopped >= 0:
                self._traffic.prepare(more * PHYSICS_STEP)
                self._bind()
        return pitch

    def follow(self, tracker: int, actor: int) -> None:
        """Make an actor the target of a tracker.

        Raises:
            SpawnError: There is no such actor.
        """
        if not 0 <= actor < self._traffic.actors:
            raise SpawnError(
                f"target: there is no actor {actor}; allowed: 0 to {self._traffic.actors - 1}"
            )
        model = self._worlds.model_of(tracker, actor)
        _follow(self._targets, self._episodes, self.models, tracker, actor, model)

    def restart_count(self, tracker: int) -> None:
        """Count a tracker's steps, and those without reward, from 0 again."""
        self._episodes.step_count[tracker] = self._episodes.no_reward_count[tracker] = 0

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seed of the sequence of episodes of each tracker, shape (N,)."""
        return self._streams.seed.copy()

    def key(self, tracker: int) -> EpisodeKey:
        """Return what the random values of a tracker's episode depend on."""
        return EpisodeKey(
            int(self._streams.seed[tracker]),
            int(self._streams.number[tracker]),
            int(self._episodes.number[tracker]),
        )


def _rules(config: SimConfig, last_tick: int) -> SamplingRules:
    """Return how episodes are sampled from traffic that ends at a physics step.

    Raises:
        ConfigError: The traffic is shorter than an episode.
    """
    start, first, steps = config.start, config.start.warm_up_steps, config.done.total_steps
    if first + steps > last_tick:
        raise ConfigError(
            f"done.total_steps: {steps} (and {first} warm-up steps) is more "
            f"than the recording has; allowed: {last_tick - first}"
        )
    field = config.camera.field_of_view
    return SamplingRules(
        rule_of(start.pitch),
        rule_of(start.horizontal_bias),
        rule_of(start.vertical_bias),
        rule_of(start.height),
        rule_of(start.direction),
        rule_of(field),
        varied_field=int(not isinstance(field, float)),
        same_target=int(config.same_target),
        first_tick=first,
        times=last_tick - steps - first + 1,
        last_tick=last_tick,
        steps=steps,
    )


def _followed_kinds(config: SimConfig, traffic: TrafficSource) -> NDArray[np.bool_] | None:
    """Return whether each actor is of a class that may be followed, shape (A,); None: all may.

    Raises:
        ConfigError: The traffic has no vehicle of these classes.
    """
    classes = config.start.vehicles
    if classes is None:
        return None
    mine = np.isin(traffic.motion.kind, [kind_index(name) for name in classes])
    if not mine.any():
        there = [name for name in VehicleType if kind_index(name) in traffic.motion.kind]
        raise ConfigError(
            f"start.vehicles: the traffic has no {' or '.join(classes)}; allowed: "
            f"{', '.join(there)}, or another traffic.vehicle_type"
        )
    return mine


def _model_table() -> ModelTable:
    """Return what targets of each model of the catalogue have in common."""
    kinds = [kind_of(model) for model in range(len(MODELS))]
    return ModelTable(
        size=np.array([model.size for model in MODELS], np.float64),
        rise=np.array([model.rise for model in MODELS], np.float64),
        ahead=np.array([kind.ahead for kind in kinds], np.float64),
        slowest=np.array([kind.slowest for kind in kinds], np.float64),
        flies=np.array([kind.flies for kind in kinds], np.bool_),
    )


def _sides(config: SimConfig, worlds: Worlds) -> NDArray[np.float64]:
    """Return on which side of a shared target each tracker starts [rad], shape (N,)."""
    sides = np.zeros(len(worlds.of))
    if config.same_target:
        for world in range(len(worlds.leader)):
            among = worlds.trackers_of(int(worlds.leader[world]))
            sides[among] = 2.0 * math.pi * np.arange(len(among)) / len(among)
    return sides


def _no_target(here: int, followed: int) -> SpawnError:
    """Return the error of a tracker for which no target is free."""
    enough = "at least as many targets as trackers, or same_target"
    # Those who come and go may not have come yet, or have all gone.
    sooner = "some at any time: see traffic.group_interval and route_count, or objects.interval"
    return SpawnError(
        f"start: no target is free: {here} in the world, {followed} followed; "
        f"allowed: {enough if here else sooner}"
    )
