"""Episodes: when, with which target and from where each begins."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.errors import ConfigError, SpawnError
from eyas.core.rng import stream
from eyas.sim.config import SimConfig
from eyas.sim.fleet import Fleet
from eyas.sim.light import LightChanges
from eyas.sim.worlds import Worlds
from eyas.targets.catalogue import VEHICLES
from eyas.task.direction import TARGET_COMPENSATION
from eyas.task.spawn import choose_target, draw_start, place
from eyas.traffic.replay import Replay

__all__ = ["Episodes"]

_ATTEMPTS = 100
"""Times at which a start is tried."""


class Episodes:
    """Draws the episodes of N trackers.

    What an episode draws depends only on the seed, the tracker and the episode's number (and, in a
    shared world, on which targets the others follow), never on how many trackers there are.

    Attributes:
        number: Of each tracker's episode, -1 before the first, shape (N,).

    Args:
        config: The settings.
        replay: The traffic.
        worlds: What moves around the trackers.
        light: The light around them.
        count: N.
    """

    def __init__(
        self, config: SimConfig, replay: Replay, worlds: Worlds, light: LightChanges, count: int
    ) -> None:
        self.number = np.full(count, -1, np.int64)
        self._config = config
        self._seed = config.seed
        self._replay = replay
        self._worlds = worlds
        self._light = light
        self._last_tick = int(replay.duration / PHYSICS_STEP)
        first = config.start.warm_up_steps
        if first + config.done.total_steps > self._last_tick:
            raise ConfigError(
                f"done.total_steps: {config.done.total_steps} (and {first} warm-up steps) is more "
                f"than the recording has; allowed: {self._last_tick - first}"
            )

    def reseed(self, seed: int) -> None:
        """Begin the sequence of episodes of another seed."""
        self._seed = seed
        self.number[:] = -1

    def draw(self, trackers: NDArray[np.int64], fleet: Fleet) -> NDArray[np.float64]:
        """Set target, time and offset of trackers; return their camera pitches [rad].

        Raises:
            SpawnError: No target is free.
        """
        fleet.target_actor[trackers] = -1
        pitch = np.zeros(len(trackers))
        for k, tracker in enumerate(trackers):
            self.number[tracker] += 1
            pitch[k] = self._draw_one(int(tracker), fleet)
        return pitch

    def _draw_one(self, tracker: int, fleet: Fleet) -> float:
        episode = int(self.number[tracker])
        self._worlds.draw_looks(tracker, self._seed, episode)
        self._light.draw(tracker, self._seed, episode)
        rng = stream(self._seed, "episode", tracker, episode)
        tick, actor = self._choose(tracker, fleet, rng)
        start = draw_start(self._config.start, rng)
        # A target at the origin that heads so that the tracker heads east: what comes back is the
        # offset in the tracker's own heading frame.
        offset, _ = place(start, np.zeros(3), -start.direction, TARGET_COMPENSATION)
        fleet.tick[tracker] = tick
        fleet.target_actor[tracker] = actor
        fleet.target_position[tracker, 2] = VEHICLES[
            self._worlds.model_of(tracker, actor)
        ].wheel_radius
        fleet.offset[tracker, :3] = offset
        fleet.offset[tracker, 3] = start.direction
        return start.pitch

    def _choose(self, tracker: int, fleet: Fleet, rng: np.random.Generator) -> tuple[int, int]:
        """Return when an episode begins, and with which actor.

        Where vehicles come and go there may be no one who stays for a whole episode; then other
        times are tried, or in a shared world, whose time is given, those who stay a shorter while.
        """
        used = set(fleet.target_actor.tolist()) if self._worlds.shared else set()
        for attempt in range(_ATTEMPTS):
            tick = self._start_tick(tracker, fleet, rng)
            steps = self._config.done.total_steps >> (attempt if self._worlds.shared else 0)
            end = min(tick + steps, self._last_tick)
            available = self._replay.available(tick * PHYSICS_STEP, end * PHYSICS_STEP)
            try:
                return tick, choose_target(available, used, rng)
            except SpawnError:
                if attempt == _ATTEMPTS - 1 or steps == 0:
                    raise
        raise AssertionError("the loop returns or raises")

    def _start_tick(self, tracker: int, fleet: Fleet, rng: np.random.Generator) -> int:
        """Return the time at which an episode begins: now in a shared world, else at random."""
        first = self._config.start.warm_up_steps
        if not self._worlds.shared:
            return int(rng.integers(first, self._last_tick - self._config.done.total_steps + 1))
        return max(first, int(fleet.tick[tracker]))
