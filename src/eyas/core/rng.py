"""Random numbers: one seed, and one named stream for each tracker and room."""

import zlib

import numpy as np

__all__ = ["stream"]


def stream(seed: int, room: str, *indices: int) -> np.random.Generator:
    """Return the generator of a room.

    Streams of different rooms or indices are independent, so drawing more in one
    changes nothing in another.

    Args:
        seed: Seed of the run, >= 0.
        room: Name of the room that draws.
        *indices: Tracker, episode or other numbers that distinguish the streams of a room.
    """
    key = (zlib.crc32(room.encode()), *indices)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
