"""Random streams: by seed, room, tracker and episode; the same on every machine."""

import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import EpisodeKey, checked_seed, fresh_seed, room_key, stream


def test_each_room_tracker_episode_and_seed_has_a_stream_of_its_own():
    keys = [EpisodeKey(0, 0, 0), EpisodeKey(1, 0, 0), EpisodeKey(0, 1, 0), EpisodeKey(0, 0, 1)]
    first = [key.stream(room).random() for key in keys for room in ("start", "light")]
    assert len(set(first)) == len(first)
    assert EpisodeKey(0, 0, 1).stream("start").random() == stream(0, "start", 0, 1).random()


def test_streams_are_those_of_recordings_that_ship():
    # The numbers of this version: another stream changes every episode there is.
    assert room_key("start") == 0x9F79558F
    assert EpisodeKey(3, 1, 2).stream("start").integers(1 << 32, size=2).tolist() == [
        4141233433,
        3929840874,
    ]


@pytest.mark.parametrize("seed", [-1, 2**63, 1.0, True, "1", None])
def test_seeds_are_whole_numbers_of_63_bits(seed):
    with pytest.raises(ConfigError, match=r"^seed: .* is not allowed: a whole number from 0 to"):
        checked_seed(seed)


def test_allowed_seeds_stay_and_fresh_ones_are_exact_in_json():
    assert [checked_seed(seed) for seed in (0, 2**63 - 1)] == [0, 2**63 - 1]
    seeds = {fresh_seed() for _ in range(50)}
    assert len(seeds) == 50
    assert all(int(float(seed)) == checked_seed(seed) for seed in seeds)
