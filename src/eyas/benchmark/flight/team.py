"""Drones that follow one target together, and what they tell each other.

Each flies in a copy of the same world, so that they see the same traffic but not each other, and
cannot collide.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.flight.meter import LOOK
from eyas.benchmark.flight.scenario import Scenario
from eyas.benchmark.flight.team_radio import mates
from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.rng import stream
from eyas.engine.policies.sight import visible_shares

SEARCH_LIMIT = 15.0  # Longest time that is waited for a drone to see the target again [s]
_LIDS = (5.0, 10.0, 15.0)  # How long a camera is covered [s]
_STEADY = 0.5  # How long the target must be seen without a gap to count as seen again [s]

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


class TeamScenario(Scenario):
    """Covers the camera of one drone of each team for a while, and measures what the team sees."""

    def __init__(
        self,
        batch: EpisodeBatch,
        protocol: Protocol,  # Their protocol; its variants are the drones of a team
        episodes: Sequence[EpisodeSpec],
    ) -> None:
        super().__init__(batch.count)
        self._batch, self._size, self._period = batch, len(protocol.variants), protocol.period
        self._rows = np.concatenate(
            [mates(episodes, self._size), np.arange(batch.count)[:, None]], axis=1
        )
        self._looks = protocol.steps // LOOK
        self._sees = np.zeros((batch.count, self._looks), np.bool_)
        self._flown = np.zeros(batch.count, np.int64)
        self._lid = np.array(
            [lid_of(episode, protocol, self._size) for episode in episodes], np.int64
        )
        """First covered control step of each, and the first after it, shape (N, 2)."""

    def covered(self, step: int) -> Mask:
        """Return whose camera is covered."""
        lids: Mask = (self._lid[:, 0] <= step) & (step < self._lid[:, 1])
        return lids

    def measure(self, step: int, active: Mask) -> None:
        """Remember at every look who sees the target."""
        self._flown[active] = step + 1
        if (step + 1) % LOOK == 0:
            open_ = active & ~self.covered(step)
            seen = visible_shares(self._batch.pixels()) > 0.0
            self._sees[:, step // LOOK] = open_ & seen

    def over(self, active: Mask) -> Mask:
        """Return whose team has ended as a whole."""
        whole: Mask = ~active[self._rows].any(axis=1)
        return whole

    def figures(self, row: int) -> dict[str, float | None]:
        """Return what the team has seen, and how a covered drone came back."""
        team = self._sees[self._rows[row]].any(axis=0)
        time = self._handover(row)
        return {
            "team_seen": float(team.mean()),
            "alone_seen": float(self._sees[row].mean()),
            "handed_over": None if time is None else float(time < SEARCH_LIMIT),
            "handover_time": time,
        }

    def _handover(self, row: int) -> float | None:
        """Return the time from the end of the lid until a drone sees the target again, at most
        `SEARCH_LIMIT` [s]; None: it was not covered.
        """
        end = int(self._lid[row, 1])
        if end <= 0:
            return None
        first, least = -(-end // LOOK), round(_STEADY / (LOOK * self._period))
        limit = round(SEARCH_LIMIT / (LOOK * self._period))
        sees = self._sees[row, first : first + limit + least]
        for start in range(min(limit, len(sees) - least + 1)):
            if sees[start : start + least].all():
                return start * LOOK * self._period
        return SEARCH_LIMIT


def lid_of(episode: EpisodeSpec, protocol: Protocol, size: int) -> tuple[int, int]:
    """Return the first covered control step and the first after; (0, 0): not this drone's."""
    random = stream(episode.seed, "lid")
    blind = int(random.integers(size))
    last = protocol.steps * protocol.period - _LIDS[-1] - SEARCH_LIMIT - 1.0
    length = _LIDS[int(random.integers(len(_LIDS)))]
    start = random.uniform(5.0, last)
    if tuple(protocol.variants)[blind] != episode.variant:
        return 0, 0
    return round(start / protocol.period), round((start + length) / protocol.period)
