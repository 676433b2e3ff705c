"""Latencies, and late commands: the delays of a radio link or an autopilot.

They are whole physics steps of 2 ms, sampled for each tracker and episode. No time is lost where
the settings have no delay.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Variation, bounds, sample

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_NEVER = np.iinfo(np.int64).max


def is_always_0(latency: Variation) -> bool:
    """Return whether a latency is always 0."""
    return bounds(latency) == (0.0, 0.0)


class Latency:
    """A latency of N trackers, sampled at each reset.

    Attributes:
        steps: The latency of each tracker in physics steps, shape (N,).
        most: The longest that is possible.

    Args:
        latency: Physics steps.
        name: Name of its random numbers.
        count: N.
    """

    def __init__(self, latency: Variation, name: str, count: int) -> None:
        self._latency, self._name = latency, name
        self.steps: Integers = np.zeros(count, np.int64)
        self.most = round(bounds(latency)[1])

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Sample the latency of a tracker's episode."""
        self.steps[tracker] = round(sample(self._latency, key.stream(self._name)))


class LateCommands:
    """Commands of N trackers that take effect some time after they are given.

    Until the first one does, trackers hover.

    Args:
        latency: Physics steps.
        count: N.
    """

    def __init__(self, latency: Variation, count: int) -> None:
        self._latency = Latency(latency, "action_latency", count)
        # One command may come in each step: those under way, the one in force, and the new one.
        slots = self._latency.most + 2
        self._commands = np.zeros((slots, count, 4))
        self._since: Integers = np.full((slots, count), _NEVER)
        self._next = 0

    @classmethod
    def of(cls, latency: Variation, count: int) -> "LateCommands | None":
        """Return late commands; None if they are always in time."""
        return None if is_always_0(latency) else cls(latency, count)

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Sample the latency of a tracker's episode, and forget the commands of the last one."""
        self._latency.sample(tracker, key)
        self._since[:, tracker] = _NEVER
        self._commands[self._next, tracker] = 0.0
        self._since[self._next, tracker] = -1  # before any that is given

    def pieces(self, commands: Floats, steps: int, clock: Integers) -> Iterator[tuple[Floats, int]]:
        """Yield the commands in force during the next steps, and for how many steps.

        Args:
            commands: The new commands, shape (N, 4) or (N, 8).
            steps: Number of physics steps.
            clock: Physics steps of each tracker since its reset, shape (N,).
        """
        self._next = (self._next + 1) % len(self._since)
        more = commands.shape[1] - self._commands.shape[2]
        if more > 0:  # the first that turn cameras
            self._commands = np.pad(self._commands, ((0, 0), (0, 0), (0, more)))
        self._commands[self._next] = 0.0
        self._commands[self._next, :, : commands.shape[1]] = commands
        self._since[self._next] = clock + self._latency.steps
        times = clock + np.arange(steps)[:, np.newaxis]
        given = np.where(self._since <= times[:, np.newaxis], self._since, -2)
        slot = given.argmax(axis=1)
        first = 0
        every = np.arange(slot.shape[1])
        for last in range(1, steps + 1):
            if last == steps or (slot[last] != slot[first]).any():
                yield self._commands[slot[first], every], last - first
                first = last
