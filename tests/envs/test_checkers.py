"""Environments against the checkers of the libraries that use them."""

import warnings

import gymnasium
import pytest
from gymnasium.utils.env_checker import check_env

import eyas  # noqa: F401  # makes the environments known
from eyas.envs.pettingzoo import EyasParallelEnv
from eyas.world.maps import MAPS

stable_baselines3 = pytest.importorskip("stable_baselines3.common.env_checker")

SHORT = {"done": {"total_steps": 40}}
"""Episodes of ten actions."""


def pytest_generate_tests(metafunc):
    """All take minutes: without `--every-map`, those of citystreet and one of each other place."""
    if metafunc.config.getoption("--every-map"):
        places = [(name, MAPS.get(name).weathers) for name in MAPS.built_in]
    else:
        names = [n for n in MAPS.built_in if n.partition("-")[2] in ("", "grass", "bare")]
        some = {"citystreet": None}
        places = [(n, MAPS.get(n).weathers[: some.get(n, 1)]) for n in names]
    metafunc.parametrize(("name", "weathers"), places, ids=[name for name, _ in places])


@pytest.mark.slow
def test_checkers_find_nothing_wrong_on_a_map(name, weathers, official):
    for weather in weathers:
        env = gymnasium.make(f"eyas/{name}-{weather}-v0", render_mode="rgb_array")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            check_env(env.unwrapped)
            stable_baselines3.check_env(env.unwrapped)
        env.close()
    drones = EyasParallelEnv(2, SHORT | {"world": {"map": name, "weather": weathers[0]}})
    official.parallel_api_test(drones, num_cycles=12)
