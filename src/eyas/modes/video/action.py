"""Movement of the trackers of a recording: exact following, or seeded random actions."""

from typing import Protocol

import numpy as np

from eyas.core.clock import physics_steps
from eyas.core.rng import stream
from eyas.envs.actions import action_table
from eyas.exports.frame import RecordedAction
from eyas.settings.config import EyasConfig
from eyas.sim.simulation import Simulation

__all__ = ["Following", "Mover", "RandomActions", "mover_of"]

_FOLLOWING = RecordedAction(number=-1, command=None)


class Mover(Protocol):
    """Moves all trackers by one 2 ms step."""

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""

    def action(self, tracker: int) -> RecordedAction:
        """Return a tracker's action in the last step."""


class Following:
    """Each tracker keeps its place relative to its target."""

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""
        sim.carry(1)

    def action(self, tracker: int) -> RecordedAction:
        """Return an action without a command."""
        return _FOLLOWING


class RandomActions:
    """One of six actions, drawn at the start of each control period and held during it.

    Args:
        config: Seed, control frequency and the six speeds.
        count: Number of trackers.
    """

    def __init__(self, config: EyasConfig, count: int) -> None:
        self._numbers = np.zeros(count, np.int32)
        self._seed = config.seed
        self._period = physics_steps(config.control.frequency)
        self._vectors = action_table(config.video)
        self._streams: list[np.random.Generator | None] = [None] * count

    def move(self, sim: Simulation) -> None:
        """Advance the simulation by one 2 ms step."""
        for tracker in np.flatnonzero(
            sim.snapshot.episodes.step_count % self._period == 0
        ).tolist():
            self._numbers[tracker] = self._draw(sim, tracker)
        sim.advance(self._vectors[self._numbers], 1)

    def action(self, tracker: int) -> RecordedAction:
        """Return a tracker's action in the last step."""
        number = int(self._numbers[tracker])
        return RecordedAction(number, self._vectors[number])

    def _draw(self, sim: Simulation, tracker: int) -> int:
        rng = self._streams[tracker]
        if rng is None or sim.snapshot.episodes.step_count[tracker] == 0:
            rng = stream(self._seed, "video", tracker, int(sim.snapshot.episodes.number[tracker]))
            self._streams[tracker] = rng
        return int(rng.integers(len(self._vectors)))


def mover_of(config: EyasConfig, count: int) -> Mover:
    """Return the mover that the settings select."""
    return RandomActions(config, count) if config.video.random_action else Following()
