"""Late commands and late sight: the delays of a radio link, a camera, an autopilot.

Both are whole physics steps of 2 ms, drawn for each tracker and episode. Nothing of this file is
used, and no time is lost, where the settings have no delay.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from eyas.core.rng import EpisodeKey
from eyas.core.variation import Variation, bounds, sample
from eyas.state.snapshot import Snapshot

__all__ = ["LateCommands", "LateSight"]

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_NEVER = np.iinfo(np.int64).max


def _is_off(latency: Variation) -> bool:
    """Return whether a latency is always 0."""
    return bounds(latency) == (0.0, 0.0)


class _Drawn:
    """A latency of N trackers, drawn at each reset.

    Attributes:
        steps: The latency of each tracker in physics steps, shape (N,).
    """

    def __init__(self, latency: Variation, name: str, count: int) -> None:
        self._latency, self._name = latency, name
        self.steps: Integers = np.zeros(count, np.int64)
        self.most = round(bounds(latency)[1])

    def draw(self, tracker: int, key: EpisodeKey) -> None:
        self.steps[tracker] = round(sample(self._latency, key.stream(self._name)))


class LateCommands:
    """Commands of N trackers that take effect some time after they are given.

    Until the first one does, trackers hover.

    Args:
        latency: Physics steps.
        count: N.
    """

    def __init__(self, latency: Variation, count: int) -> None:
        self._drawn = _Drawn(latency, "action_latency", count)
        # One command may come in each step: those under way, the one in force, and the new one.
        slots = self._drawn.most + 2
        self._commands = np.zeros((slots, count, 4))
        self._since: Integers = np.full((slots, count), _NEVER)
        self._next = 0

    @classmethod
    def of(cls, latency: Variation, count: int) -> "LateCommands | None":
        """Return late commands; None if they are always in time."""
        return None if _is_off(latency) else cls(latency, count)

    def draw(self, tracker: int, key: EpisodeKey) -> None:
        """Draw the latency of a tracker's episode, and forget the commands of the last one."""
        self._drawn.draw(tracker, key)
        self._since[:, tracker] = _NEVER
        self._commands[self._next, tracker] = 0.0
        self._since[self._next, tracker] = -1  # before any that is given

    def pieces(self, commands: Floats, steps: int, clock: Integers) -> Iterator[tuple[Floats, int]]:
        """Yield the commands in force during the next steps, and for how many steps.

        Args:
            commands: The new commands, shape (N, 4).
            steps: Number of physics steps.
            clock: Physics steps of each tracker since its reset, shape (N,).
        """
        self._next = (self._next + 1) % len(self._since)
        self._commands[self._next] = commands
        self._since[self._next] = clock + self._drawn.steps
        times = clock + np.arange(steps)[:, np.newaxis]
        given = np.where(self._since <= times[:, np.newaxis], self._since, -2)
        slot = given.argmax(axis=1)
        first = 0
        every = np.arange(slot.shape[1])
        for last in range(1, steps + 1):
            if last == steps or (slot[last] != slot[first]).any():
                yield self._commands[slot[first], every], last - first
                first = last


class LateSight:
    """What N trackers saw some time ago.

    Attributes:
        snapshot: Their state at that time; written in place.
        told: What their sensors with errors told then; None: none has errors.

    Args:
        latency: Physics steps.
        now: The present state.
        told: What sensors with errors tell now, shape (N, ...); None: none has errors.
    """

    def __init__(self, latency: Variation, now: Snapshot, told: Floats | None) -> None:
        count = len(now.light)
        self.snapshot = Snapshot.create(count)
        self._drawn = _Drawn(latency, "observation_latency", count)
        self._now, self._seen = _arrays(now), _arrays(self.snapshot)
        self.told = None if told is None else told.copy()
        if told is not None and self.told is not None:
            self._now.append(told)
            self._seen.append(self.told)
        self._past = [np.stack([array] * (self._drawn.most + 1)) for array in self._now]
        self._row = 0
        self._every = np.arange(count)
        self._clock = now.episodes.step_count

    @classmethod
    def of(cls, latency: Variation, now: Snapshot, told: Floats | None) -> "LateSight | None":
        """Return a late sight; None if it is always in time."""
        return None if _is_off(latency) else cls(latency, now, told)

    def draw(self, tracker: int, key: EpisodeKey) -> None:
        """Draw the latency of a tracker's episode."""
        self._drawn.draw(tracker, key)

    def record(self) -> None:
        """Remember the present state, after a physics step."""
        self._row = (self._row + 1) % (self._drawn.most + 1)
        for past, now in zip(self._past, self._now, strict=True):
            past[self._row] = now

    def begin(self, trackers: Integers) -> None:
        """Remember the present state of trackers whose episodes have begun."""
        for past, now in zip(self._past, self._now, strict=True):
            past[self._row, trackers] = now[trackers]
        self.see()

    def see(self) -> None:
        """Set `snapshot`; nothing from before the reset is seen."""
        late = np.minimum(self._drawn.steps, self._clock)
        rows = (self._row - late) % (self._drawn.most + 1)
        for seen, past in zip(self._seen, self._past, strict=True):
            seen[...] = past[rows, self._every]


def _arrays(snapshot: Snapshot) -> list[NDArray[np.generic]]:
    """Return all arrays of a snapshot."""
    *records, light = snapshot
    return [*(array for record in records for array in record), light]
