"""Environments that nobody seeds are different, and say how to repeat them."""

from copy import deepcopy

import gymnasium
import numpy as np
import pytest

import eyas
from eyas.engine.core.config import updated
from eyas.engine.envs.pettingzoo import EyasParallelEnv
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.config import EyasConfig

BLIND = {"parts": ["sensors"]}
SHORT = {"done": {"total_steps": 8}}


def vector(mode):
    name = "eyas/citystreet-day-v0"
    return gymnasium.make_vec(name, 3, vectorization_mode=mode, observation=BLIND)


@pytest.mark.parametrize("mode", ["sync", "vector_entry_point"])
def test_no_environment_among_several_is_a_copy(mode):
    first, info = vector(mode).reset()
    again, _ = vector(mode).reset()
    assert len(np.unique(np.concatenate([first, again]), axis=0)) == 6
    assert len(np.unique(info["seed"])) == 3


def test_workers_of_stable_baselines_differ():
    from stable_baselines3.common.vec_env import DummyVecEnv

    env = DummyVecEnv([lambda: TrackingEnv(observation=BLIND)] * 3)
    assert len(np.unique(env.reset(), axis=0)) == 3
    ours = eyas.EyasVecEnv(2, observation=BLIND)
    first, seeds = ours.reset(), [info["seed"] for info in ours.reset_infos]
    ours.seed(seeds[0])
    assert seeds[1] == seeds[0] + 1
    assert np.array_equal(ours.reset(), first)


def test_the_reported_seed_repeats_all_episodes():
    env = TrackingEnv(SHORT, observation=BLIND)
    first, info = env.reset()
    second, later = env.reset()
    assert later["seed"] == info["seed"] == env.np_random_seed
    assert not np.array_equal(first, second)
    again = TrackingEnv(SHORT, observation=BLIND)
    assert np.array_equal(again.reset(seed=int(info["seed"]))[0], first)
    assert np.array_equal(again.reset()[0], second)
    assert again.step(6)[4]["seed"] == info["seed"]


def test_copies_of_an_environment_that_has_not_begun_differ():
    env = TrackingEnv(observation=BLIND)
    copied = deepcopy(env)
    assert env.reset()[1]["seed"] != copied.reset()[1]["seed"]
    drones = EyasParallelEnv(2, observation=BLIND)
    others = deepcopy(drones)
    assert drones.reset()[1]["drone_0"]["seed"] != others.reset()[1]["drone_0"]["seed"]


def test_a_seed_in_the_settings_is_kept():
    settings = updated(EyasConfig(), {"seed": 0})
    changed = updated(settings, {"env": {"action_repeat": 2}})
    for config in (settings, changed, {"seed": 0}):
        _, info = TrackingEnv(config, observation=BLIND).reset()
        assert info["seed"] == 0
    assert "seed" not in updated(EyasConfig(), {"env": {"action_repeat": 2}}).model_fields_set


def test_environments_that_begin_later_are_no_copies():
    env = EyasVectorEnv(3, SHORT, observation=BLIND)
    env.reset(seed=[7, None, None], options={"reset_mask": np.array([True, True, False])})
    _, info = env.reset()
    assert info["seed"][0] == 7
    assert len(set(info["seed"].tolist())) == 3
    assert 0 not in info["seed"]
