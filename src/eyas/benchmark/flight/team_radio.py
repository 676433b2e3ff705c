"""What drones of a team tell each other."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.protocols.protocol import Protocol

MESSAGE = 6  # Numbers of a message, whose meaning is the policy's own

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


def mates(episodes: Sequence[EpisodeSpec], size: int) -> NDArray[np.int64]:
    """Return the rows of each drone's mates, shape (N, size - 1)."""
    count = len(episodes)
    assert count % size == 0, "a team is in one batch"
    first = np.arange(count) // size * size
    others = (np.arange(count)[:, None] + np.arange(1, size)) % size
    return np.sort(first[:, None] + others, axis=1)


class Radio:
    """Carries the messages of N drones: what one says at a look, its mates hear at the next."""

    def __init__(self, episodes: Sequence[EpisodeSpec], protocol: Protocol) -> None:
        self._mates = mates(episodes, len(protocol.variants))
        self._said = np.full((len(episodes), MESSAGE), np.nan)

    def heard(self) -> Floats:
        """Return the latest messages of the mates, NaN before any, shape (N, T - 1, `MESSAGE`)."""
        heard: Floats = self._said[self._mates]
        return heard

    def say(self, speaking: Mask, messages: Floats) -> None:
        """Let drones speak; `speaking` tells who does, shape (N,), messages are (N, `MESSAGE`)."""
        self._said[speaking] = messages[speaking]
