"""Random numbers by their number: kernels read any of them, in any order, without a state.

The noise of a reading depends only on the seed of its stream, which is sampled for each episode
(`eyas.engine.core.rng.EpisodeKey`), and on the number of the reading; so neither other sensors nor
the length of a control step change it.
"""

import math

from eyas.lanes import kernel
from eyas.lanes.elementary import cos, log

SEEDS = 1 << 32  # Seeds are whole numbers from 0 up to below this

_WORD = 0xFFFFFFFF


@kernel
def mixed(word: int) -> int:
    """Return 32 bits that look random, for 32 bits: Wellons' `lowbias32` hash."""
    word = ((word ^ (word >> 16)) * 0x7FEB352D) & 0xFFFFFFFF
    word = ((word ^ (word >> 15)) * 0x846CA68B) & 0xFFFFFFFF
    return word ^ (word >> 16)


@kernel
def uniform(
    seed: int,  # Seed of the stream, see `SEEDS`
    number: int,  # Number of the reading, from -2^31 to 2^31
    channel: int,  # Which of its random numbers
) -> float:
    """Return a number between 0 and 1, both excluded."""
    word = mixed(mixed(mixed(seed) ^ (number & _WORD)) ^ (channel & _WORD))
    return (word + 0.5) / 4294967296.0


@kernel
def normal(seed: int, number: int, channel: int) -> float:
    """Return a normally distributed number of mean 0 and deviation 1 (Box and Muller, 1958)."""
    length = math.sqrt(-2.0 * log(uniform(seed, number, 2 * channel)))
    return length * cos(2.0 * math.pi * uniform(seed, number, 2 * channel + 1))
