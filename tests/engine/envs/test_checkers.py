"""Environments against the checkers of the libraries that use them."""

import warnings

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env

import eyas  # noqa: F401  # makes the environments known
from eyas.engine.envs.pettingzoo import EyasParallelEnv
from eyas.engine.world.maps import MAPS

stable_baselines3 = pytest.importorskip("stable_baselines3.common.env_checker")

SHORT = {"done": {"total_steps": 40}}
"""Episodes of ten actions."""


SOME = {"citystreet": ("day", "night"), "desert-bare": ("day",), "simpleway-grass": ("day",)}
"""Of each kind of place one; what a checker looks at depends on neither map nor weather."""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "weathers"), SOME.items(), ids=SOME)
def test_checkers_find_nothing_wrong(name, weathers, official):
    checked(name, weathers, official)


@pytest.mark.thorough
@pytest.mark.parametrize("name", MAPS.built_in)
def test_checkers_find_nothing_wrong_on_any_map_in_any_weather(name, official):
    checked(name, MAPS.get(name).weathers, official)


def checked(name, weathers, official):
    for weather in weathers:
        env = gymnasium.make(f"eyas/{name}-{weather}-v0", render_mode="rgb_array")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            check_env(env.unwrapped)
            stable_baselines3.check_env(env.unwrapped)
        env.close()
    drones = EyasParallelEnv(2, SHORT | {"world": {"map": name, "weather": weathers[0]}})
    official.parallel_api_test(drones, num_cycles=12)
