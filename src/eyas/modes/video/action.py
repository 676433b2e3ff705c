"""What moves the trackers of a recording: exact following, or seeded random actions."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import physics_steps
from eyas.core.rng import stream
from eyas.envs.actions import action_table
from eyas.settings.config import EyasConfig
from eyas.sim.simulation import Simulation

__all__ = ["FOLLOWING", "Following", "Mover", "RandomActions", "mover_of"]

FOLLOWING = -1
"""Action number in the marks when a target is followed exactly."""


class Mover(Protocol):
    """Moves all trackers by one 2 ms step."""

    action: NDArray[np.int32]
    """Number of each tracker's action, shape (N,)."""

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""


class Following:
    """Each tracker keeps its place relative to its target."""

    def __init__(self, count: int) -> None:
        self.action = np.full(count, FOLLOWING, np.int32)

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""
        sim.carry(1)


class RandomActions:
    """One of six actions, drawn anew at each control period and held in between.

    Args:
        config: Seed, control frequency and the six speeds.
        count: Number of trackers.
    """

    def __init__(self, config: EyasConfig, count: int) -> None:
        self.action = np.zeros(count, np.int32)
        self._seed = config.seed
        self._period = physics_steps(config.control.frequency)
        self._vectors = action_table(config.video)
        self._streams: list[np.random.Generator | None] = [None] * count

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""
        for tracker in np.flatnonzero(
            sim.snapshot.episodes.step_count % self._period == 0
        ).tolist():
            self.action[tracker] = self._draw(sim, tracker)
        sim.advance(self._vectors[self.action], 1)

    def _draw(self, sim: Simulation, tracker: int) -> int:
        rng = self._streams[tracker]
        if rng is None or sim.snapshot.episodes.step_count[tracker] == 0:
            rng = stream(self._seed, "video", tracker, int(sim.snapshot.episodes.number[tracker]))
            self._streams[tracker] = rng
        return int(rng.integers(len(self._vectors)))


def mover_of(config: EyasConfig, count: int) -> Mover:
    """Return the mover that the settings ask for."""
    return RandomActions(config, count) if config.video.random_action else Following(count)
