"""Wind: constant, and with gusts by the model of Dryden at low altitude (MIL-F-8785C, 3.7.3).

White noise passes a filter for each of the three components; the filters are those of the
specification, exact in time for the one along the wind, and to 0.1 % for the others. The noise is
uniform, which saves a logarithm and a cosine: after the filters, which average over seconds, the
gusts are normally distributed.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Variation, sample
from eyas.lanes import exact, kernel
from eyas.lanes.elementary import exp, power

_FOOT = 0.3048  # [m]
_LOWEST, _HIGHEST = 10.0 * _FOOT, 1000.0 * _FOOT
"""Heights for which the model is made; others count as the nearest [m]."""
_SLOWEST = 1.0
"""Least speed at which gusts pass the drone [m/s]: the model is made for what flies through."""

_SHIFTS = (np.uint64(12), np.uint64(25), np.uint64(27), np.uint64(11))
_FACTOR = np.uint64(2685821657736338717)
_UNIT = 2.0**-53
_DEVIATION = math.sqrt(12.0)
"""One over the standard deviation of a number sampled uniformly from 0 to 1."""


class WindMemory(NamedTuple):
    """The wind around N drones."""

    mean: NDArray[np.float64]  # Velocity without gusts, towards east and north [m/s], shape (N, 2)
    along: NDArray[np.float64]
    """Direction of the mean wind, cosine and sine from east, shape (N, 2)."""
    gust: NDArray[np.float64]
    """Filters: one for the gusts along the wind, two for those to its left, two for those up,
    shape (N, 5)."""
    random: NDArray[np.uint64]  # State of the random numbers, shape (N,)

    @classmethod
    def create(cls, count: int) -> "WindMemory":
        """Return the memory of calm air."""
        pair = (count, 2)
        filters = np.zeros((count, 5))
        return cls(np.zeros(pair), np.zeros(pair), filters, np.ones(count, np.uint64))


def mean_wind(
    speed: Variation,  # Of the mean wind [m/s]
    direction: Variation,  # Towards which it blows, counter-clockwise from east [rad]
    rng: np.random.Generator,  # The episode's random numbers for the wind: its first ones
) -> tuple[float, tuple[float, float]]:
    """Return speed [m/s] and direction, cosine and sine from east, of an episode's wind."""
    angle = sample(direction, rng)
    return sample(speed, rng), (float(exact.cos(angle)), float(exact.sin(angle)))


def begin_wind(
    memory: WindMemory,  # The wind of tracker `n` is set
    n: int,  # Index of the tracker
    speed: Variation,  # Of the mean wind [m/s]
    direction: Variation,  # Towards which it blows, counter-clockwise from east [rad]
    key: EpisodeKey,
) -> None:
    """Draw the wind of an episode, with gusts as if it had blown for long."""
    rng = key.stream("wind")
    mean, memory.along[n] = mean_wind(speed, direction, rng)
    memory.mean[n] = mean * memory.along[n]
    memory.random[n] = rng.integers(1, 2**63)
    first = exact.normal(rng, size=5)
    # Stationary: the first filter of a pair has the variance 1/2, the second 1/4, both together
    # the covariance 1/4.
    memory.gust[n, 0] = first[0]
    for pair in (1, 3):
        memory.gust[n, pair] = math.sqrt(0.5) * first[pair]
        memory.gust[n, pair + 1] = 0.5 * memory.gust[n, pair] + math.sqrt(0.125) * first[pair + 1]


@kernel
def blow(
    memory: WindMemory,  # The wind of tracker `n`; its gusts are advanced
    n: int,  # Index of the tracker
    turbulence: float,  # Wind 20 ft above the ground that makes the gusts [m/s]; 0: none
    height: float,  # Of the drone above the ground [m]
    velocity: tuple[float, float, float],  # Of the drone, world frame [m/s]
) -> tuple[float, float, float]:
    """Return the wind in the next physics step of 2 ms, world frame [m/s]."""
    mean, gust = memory.mean[n], memory.gust[n]
    if turbulence <= 0.0:
        return mean[0], mean[1], 0.0
    height = min(max(height, _LOWEST), _HIGHEST)
    base = 0.177 + 0.000823 * height / _FOOT
    # The length of gusts along and across the wind; that of gusts up is `height`.
    length = height / power(base, 1.2)
    rise = 0.1 * turbulence
    strength = rise / power(base, 0.4)
    x, y, z = velocity[0] - mean[0], velocity[1] - mean[1], velocity[2]
    speed = max(math.sqrt(x * x + y * y + z * z), _SLOWEST)
    keep = exp(-PHYSICS_STEP * speed / length)
    keep_up = exp(-PHYSICS_STEP * speed / height)
    gust[0] = keep * gust[0] + math.sqrt(1.0 - keep * keep) * _noise(memory.random, n)
    along = strength * gust[0]
    left = strength * _second_order(memory, n, 1, keep)
    up = rise * _second_order(memory, n, 3, keep_up)
    east, north = memory.along[n, 0], memory.along[n, 1]
    return mean[0] + east * along - north * left, mean[1] + north * along + east * left, up


@kernel
def _second_order(memory: WindMemory, n: int, first: int, keep: float) -> float:
    """Return the output of two filters in a row, with a variance of 1.

    Its transfer function is that of the specification, (1 + sqrt(3) T s) / (1 + T s)^2.
    """
    gust = memory.gust[n]
    gust[first + 1] += (1.0 - keep) * (gust[first] - gust[first + 1])
    noise = _noise(memory.random, n)
    gust[first] = keep * gust[first] + math.sqrt(0.5 * (1.0 - keep * keep)) * noise
    third = math.sqrt(3.0)
    return float(third * gust[first] + (1.0 - third) * gust[first + 1])


@kernel
def _noise(random: NDArray[np.uint64], n: int) -> float:
    """Return a random number of mean 0 and variance 1.

    By xorshift64* (Vigna, "An experimental exploration of Marsaglia's xorshift generators,
    scrambled", ACM Transactions on Mathematical Software 42, 2016).
    """
    state = random[n]
    state ^= state >> _SHIFTS[0]
    state ^= state << _SHIFTS[1]
    state ^= state >> _SHIFTS[2]
    random[n] = state
    return _DEVIATION * (float((state * _FACTOR) >> _SHIFTS[3]) * _UNIT - 0.5)
