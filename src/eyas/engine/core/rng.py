"""Random numbers: one seed, and one named stream for each tracker and room."""

import secrets
import zlib
from typing import Any, NamedTuple

import numpy as np

from eyas.engine.core.errors import ConfigError

TEST_SEEDS = 900_000_000
"""Seeds of maps and of traffic from here on are kept for tests: nothing is taught with them."""


def room_key(room: str) -> int:
    """Return the number of a room's name in its streams; bytes of all results depend on it."""
    return zlib.crc32(room.encode())


def stream(seed: int, room: str, *indices: int) -> np.random.Generator:
    """Return the generator of a room.

    Streams of different rooms or indices are independent, so sampling more in one
    changes nothing in another.

    Args:
        seed: Seed of the run, >= 0.
        room: Name of the room that samples.
        *indices: Tracker, episode or other numbers that distinguish the streams of a room.
    """
    key = (room_key(room), *indices)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))


def checked_seed(seed: Any) -> int:  # noqa: ANN401  # whatever a caller gives
    """Return a seed that a caller gives.

    Raises:
        ConfigError: It is not a whole number from 0 to 2**63 - 1.
    """
    whole = isinstance(seed, int | np.integer) and not isinstance(seed, bool)
    if not whole or not 0 <= int(seed) < 2**63:
        raise ConfigError(f"seed: {seed!r} is not allowed: a whole number from 0 to 2**63 - 1")
    return int(seed)


def fresh_seed() -> int:
    """Return a seed drawn from the system's entropy, below 2**53: exact in JSON and as float64."""
    return secrets.randbits(53)


class EpisodeKey(NamedTuple):
    """Numbers on which the random values of an episode depend."""

    seed: int  # Seed of the run
    tracker: int  # Number of the tracker among those with this seed
    episode: int  # Number of the episode, from 0

    def stream(self, room: str) -> np.random.Generator:
        """Return the generator of a room in this episode."""
        return stream(self.seed, room, self.tracker, self.episode)
