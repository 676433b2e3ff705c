"""Every name for `gymnasium.make`: each map in each of its weathers."""

import itertools

import gymnasium
import numpy as np
import pytest

import eyas
from eyas.engine.core.errors import ConfigError
from eyas.engine.world.maps import MAPS


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "weathers"),
    [  # one of each kind of winter
        ("citystreet", MAPS.get("citystreet").weathers),
        ("village", ("day", "night", "snow")),
        pytest.param("village", MAPS.get("village").weathers, marks=pytest.mark.thorough),
    ],
)
def test_each_weather_of_a_map_is_an_environment_of_its_own(name, weathers):
    seen = {}
    for weather in weathers:
        env = gymnasium.make(f"eyas/{name}-{weather}-v0")
        first, _ = env.reset(seed=3)
        second, reward, terminated, truncated, info = env.step(0)
        assert env.observation_space.contains(first)
        assert env.observation_space.contains(second)
        assert not np.array_equal(first, second)
        assert np.isfinite(reward)
        assert not terminated
        assert not truncated
        assert info["step"] == 4
        seen[weather] = first.astype(float)
        env.close()
    for one, other in itertools.combinations(seen, 2):  # the same episode, so the same view
        assert np.abs(seen[one] - seen[other]).mean() > 1.0, (one, other)


def test_every_registered_environment_is_a_map_in_a_weather():
    known = {f"eyas/{m}-{weather}-v0" for m in MAPS.built_in for weather in MAPS.get(m).weathers}
    built_in = tuple(f"eyas/{m}-" for m in MAPS.built_in)
    assert {name for name in gymnasium.registry if name.startswith(built_in)} == known


@pytest.mark.parametrize("make", [eyas.make, eyas.make_vec])
def test_settings_in_the_place_of_a_name_are_refused_in_one_line(make):
    with pytest.raises(ConfigError, match=r"name: a dict is not allowed; .*the argument `config`"):
        make({"world": {"map": "village"}})


def test_whole_names_of_gymnasium_are_taken_too():
    assert eyas.make("eyas/citystreet-day-v0").spec.id == "eyas/citystreet-day-v0"
