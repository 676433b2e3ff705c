"""Gusts against the statistics of Dryden's model (MIL-F-8785C)."""

import numpy as np
import pytest

from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Uniform
from eyas.engine.trackers.wind import WindMemory, begin_wind, blow
from eyas.lanes import compiled

COUNT, STEPS, SPARSE, TURBULENCE, HEIGHT, SPEED = 48, 60_000, 10, 12.0, 20.0, 15.0
FEET = HEIGHT / 0.3048
LENGTH = HEIGHT / (0.177 + 0.000823 * FEET) ** 1.2
SIGMA_UP = 0.1 * TURBULENCE
SIGMA = SIGMA_UP / (0.177 + 0.000823 * FEET) ** 0.4


@compiled
def _blown(memory, out, numbers):
    for k in range(out.shape[1]):
        for n in range(out.shape[0]):
            wind = (0.0, 0.0, 0.0)
            for _ in range(int(numbers[2])):
                wind = blow(memory, n, numbers[0], numbers[1], (0.0, 0.0, 0.0))
            for axis in range(3):
                out[n, k, axis] = wind[axis]


def blown(episodes, direction=0.0, steps=STEPS // SPARSE, sparse=SPARSE, turbulence=TURBULENCE):
    """Wind at some places, shape (N, K, 3), of episodes of the same seed."""
    memory = WindMemory.create(len(episodes))
    for n, episode in enumerate(episodes):
        begin_wind(memory, n, SPEED, direction, EpisodeKey(7, 0, episode))
    out = np.zeros((len(episodes), steps, 3))
    _blown(memory, out, (turbulence, HEIGHT, float(sparse)))
    return out


@pytest.fixture(scope="module")
def gusts():
    """Of wind towards the east: along, left, up, without the mean."""
    return blown(range(COUNT)) - [SPEED, 0.0, 0.0]


def test_gusts_are_as_strong_as_the_specification_says(gusts):
    assert np.abs(gusts.mean(axis=(0, 1))).max() < 0.15
    assert gusts.std(axis=(0, 1)) == pytest.approx([SIGMA, SIGMA, SIGMA_UP], rel=0.06)


def test_they_are_normally_distributed_from_the_first_step_on(gusts):
    for part in (gusts[:, 0], gusts[:, -1]):
        assert part.std(axis=0) == pytest.approx([SIGMA, SIGMA, SIGMA_UP], rel=0.35)
    kurtosis = (gusts**4).mean(axis=(0, 1)) / (gusts**2).mean(axis=(0, 1)) ** 2
    assert kurtosis == pytest.approx([3.0] * 3, abs=0.3)


def test_they_last_as_long_as_the_specification_says(gusts):
    """Autocorrelation: exp(-t / T) along the wind, (1 - t / 2 T) exp(-t / T) across it."""
    for seconds in (0.2, 1.0, 3.0):
        shift = round(seconds / (0.002 * SPARSE))
        product = (gusts[:, :-shift] * gusts[:, shift:]).mean(axis=(0, 1))
        seen = product / gusts.var(axis=(0, 1))
        along, up = seconds * SPEED / LENGTH, seconds * SPEED / HEIGHT
        across = [(1.0 - 0.5 * share) * np.exp(-share) for share in (along, up)]
        assert seen == pytest.approx([np.exp(-along), *across], abs=0.07)


def test_components_are_independent(gusts):
    assert np.abs(np.corrcoef(gusts.reshape(-1, 3).T) - np.eye(3)).max() < 0.07


def test_each_episode_has_its_own_gusts_and_repeats_them():
    first, again, other = (blown([episode], steps=50)[0] for episode in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.array_equal(first, blown([0, 3], steps=50)[1])


def test_wind_blows_where_it_is_told_to():
    north = blown([0], direction=np.pi / 2, steps=5, turbulence=0.0)
    assert north == pytest.approx(np.tile([0.0, SPEED, 0.0], (1, 5, 1)))
    memory = WindMemory.create(100)
    for n in range(100):
        begin_wind(memory, n, Uniform(uniform=(2.0, 4.0)), 0.0, EpisodeKey(1, n, 0))
    speeds = memory.mean[:, 0]
    assert 2.0 <= speeds.min() < 2.3
    assert 3.7 < speeds.max() <= 4.0
