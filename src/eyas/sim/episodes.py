"""Episodes: the start time, target and start pose of each."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.errors import ConfigError, SpawnError
from eyas.core.rng import EpisodeKey
from eyas.core.variation import sample
from eyas.sim.config import SimConfig
from eyas.sim.light import LightChanges
from eyas.sim.worlds import Worlds
from eyas.state.snapshot import Snapshot
from eyas.targets.catalogue import MODELS, kind_of
from eyas.task.spawn import Start, choose_target, sample_start, start_pose
from eyas.traffic.source import TrafficSource

__all__ = ["Draw", "Episodes"]

Draw = Callable[[int, EpisodeKey], None]
"""Draws something for the episode of a tracker."""

_ATTEMPTS = 100
"""Number of start times that are tried."""

_TIMES = 10
"""Number of start times after which half the stay of a vehicle is enough."""


class Episodes:
    """Draws the episodes of N trackers.

    The random values of an episode depend only on the seed, the tracker and the episode's number
    (and, in a world of several trackers, on the targets of the others), not on the number of
    trackers.

    Args:
        config: The settings.
        traffic: The traffic with the possible targets.
        worlds: The worlds of the trackers.
        light: The light around them.
        snapshot: State of N trackers; this class sets its episodes and targets, and the
            fields of view of its cameras.
        draws: What else is drawn for an episode.
    """

    def __init__(
        self,
        config: SimConfig,
        traffic: TrafficSource,
        worlds: Worlds,
        light: LightChanges,
        snapshot: Snapshot,
        draws: Sequence[Draw] = (),
    ) -> None:
        self._config = config
        self._draws = tuple(draws)
        count = len(snapshot.episodes.number)
        self._seed = np.full(count, config.seed, np.int64)
        self._stream = np.arange(count)
        self._traffic = traffic
        self._worlds = worlds
        self._light = light
        self._episodes, self._targets = snapshot.episodes, snapshot.targets
        self._fields = snapshot.cameras.field_of_view
        self._last_tick = int(traffic.duration / PHYSICS_STEP)
        first = config.start.warm_up_steps
        if first + config.done.total_steps > self._last_tick:
            raise ConfigError(
                f"done.total_steps: {config.done.total_steps} (and {first} warm-up steps) is more "
                f"than the recording has; allowed: {self._last_tick - first}"
            )

    def reseed(self, seed: int) -> None:
        """Begin the sequence of episodes of another seed."""
        self._seed[:] = seed
        self._stream[:] = np.arange(len(self._stream))
        self._episodes.number[:] = -1

    def reseed_alone(self, trackers: NDArray[np.integer], seeds: NDArray[np.integer]) -> None:
        """Begin the episodes that the only tracker of a simulation has with each of these seeds."""
        assert not self._worlds.lasting[self._worlds.of[trackers]].any(), "a world of one's own"
        self._seed[trackers] = seeds
        self._stream[trackers] = 0
        self._episodes.number[trackers] = -1

    def continue_from(self, other: "Episodes") -> None:
        """Continue the sequences of episodes of another simulation with as many trackers."""
        self._seed[:], self._stream[:] = other._seed, other._stream
        self._episodes.number[:] = other._episodes.number

    @property
    def steps_left(self) -> int:
        """Physics steps until the end of the traffic, for the tracker whose time is latest."""
        return self._last_tick - int(self._episodes.tick.max())

    def rewind(self) -> None:
        """Begin the traffic anew; takes effect when all trackers are reset at once."""
        self._episodes.tick[:] = 0

    def begin(self, trackers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Set target, time and offset of trackers; return their camera pitches [rad].

        Raises:
            SpawnError: No target is free.
        """
        self._targets.actor[trackers] = -1
        pitch = np.zeros(len(trackers))
        for k, tracker in enumerate(trackers.tolist()):
            self._episodes.number[tracker] += 1
            pitch[k] = self._begin_one(tracker)
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
        targets, episodes = self._targets, self._episodes
        # Relative motion restarts here, since a change of target is not a motion.
        episodes.observations[tracker] = 0
        episodes.relative_velocity[tracker] = episodes.relative_acceleration[tracker] = 0.0
        model = self._worlds.model_of(tracker, actor)
        targets.actor[tracker] = actor
        targets.lost[tracker] = False
        targets.model[tracker] = model
        targets.size[tracker] = MODELS[model].size
        targets.rise[tracker] = MODELS[model].rise
        targets.ahead[tracker] = kind_of(model).ahead
        targets.slowest[tracker] = kind_of(model).slowest

    def key(self, tracker: int) -> EpisodeKey:
        """Return what the random values of a tracker's episode depend on."""
        return EpisodeKey(
            int(self._seed[tracker]),
            int(self._stream[tracker]),
            int(self._episodes.number[tracker]),
        )

    def _begin_one(self, tracker: int) -> float:
        key = self.key(tracker)
        self._worlds.sample_looks(tracker, key)
        self._light.sample(tracker, key)
        for draw in self._draws:
            draw(tracker, key)
        field = self._config.camera.field_of_view
        if not isinstance(field, float):  # a stream costs 30 us
            field = sample(field, key.stream("camera"))
        self._fields[tracker] = field
        rng = key.stream("episode")
        tick, actor = self._choose(tracker, rng)
        self._episodes.tick[tracker] = tick
        self.follow(tracker, actor)
        start = self._aside(tracker, sample_start(self._config.start, rng))
        # The target is at the origin, with a heading for which the tracker heads east, so that the
        # result is the offset in the tracker's heading frame.
        ahead = float(self._targets.ahead[tracker])
        offset, _ = start_pose(start, np.zeros(3), -start.direction, ahead)
        self._episodes.start_offset[tracker] = *offset, start.direction
        return start.pitch

    def _aside(self, tracker: int, start: Start) -> Start:
        """Return a start on the tracker's own side of a target that others follow, too."""
        if not self._config.same_target:
            return start
        others = self._worlds.trackers_of(tracker)
        turn = 2.0 * math.pi * others.tolist().index(tracker) / len(others)
        return replace(start, direction=start.direction + turn)

    def _choose(self, tracker: int, rng: np.random.Generator) -> tuple[int, int]:
        """Return the start time of an episode, and its target.

        If vehicles come and go, none may stay for a whole episode. Then other times are tried, and
        vehicles that stay for a shorter time; in a lasting world, whose time is given, only these.
        """
        others = self._worlds.trackers_of(tracker)
        lasting = bool(self._worlds.lasting[self._worlds.of[tracker]])
        used = set(self._targets.actor[others].tolist()) if lasting else set()
        if lasting and self._config.same_target:
            followed = self._followed(others)
            if followed is not None:
                return self._now(others), followed
        for attempt in range(_ATTEMPTS):
            tick = self._now(others) if lasting else self._any_time(rng)
            steps = self._config.done.total_steps >> (attempt if lasting else attempt // _TIMES)
            end = min(tick + steps, self._last_tick)
            available = self._traffic.available(tick * PHYSICS_STEP, end * PHYSICS_STEP)
            try:
                return tick, choose_target(available, used, rng)
            except SpawnError:
                if attempt == _ATTEMPTS - 1 or steps == 0:
                    raise
        raise AssertionError("the loop returns or raises")

    def _followed(self, trackers: NDArray[np.int64]) -> int | None:
        """Return the target of some trackers, if one has a target that is still in the world."""
        time = self._now(trackers) * PHYSICS_STEP
        available = self._traffic.available(time, time)
        followed = self._targets.actor[trackers]
        return next((a for a in followed.tolist() if a >= 0 and available[a]), None)

    def _any_time(self, rng: np.random.Generator) -> int:
        """Return a random time that leaves enough of the recording for a whole episode."""
        first = self._config.start.warm_up_steps
        return int(rng.integers(first, self._last_tick - self._config.done.total_steps + 1))

    def _now(self, trackers: NDArray[np.int64]) -> int:
        """Return the current time of the world of these trackers, or the first time."""
        return max(self._config.start.warm_up_steps, int(self._episodes.tick[trackers].max()))
