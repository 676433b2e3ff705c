"""The environment for PufferLib, which does not install everywhere: tried with its contract."""

import importlib
import sys
from types import ModuleType

import gymnasium
import numpy as np
import pytest

from eyas.core.errors import EyasError
from eyas.envs.vector_env import EyasVectorEnv

SMALL = {"observation": {"width": 24, "height": 20}}
SHORT = {"done": {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 500}}
"""Episodes of ten actions."""


class Contract:
    """What PufferLib 3.0 demands of an environment, and does to it."""

    def __init__(self, buf=None):
        assert not hasattr(self, "observation_space")
        assert not hasattr(self, "action_space")
        assert isinstance(self.single_observation_space, gymnasium.spaces.Box)
        assert isinstance(self.single_action_space, gymnasium.spaces.Discrete)
        for name, array in (buf or buffers(self)).items():
            setattr(self, name, array)


def buffers(env):
    """The arrays that PufferLib gives to one of several processes: parts of larger ones."""
    count, space = env.num_agents, env.single_observation_space
    arrays = {
        "observations": np.full((3, count, *space.shape), 7, space.dtype),
        "rewards": np.full((3, count), 7.0, np.float32),
        "terminals": np.ones((3, count), np.bool_),
        "truncations": np.ones((3, count), np.bool_),
        "masks": np.ones((3, count), np.bool_),
        "actions": np.zeros((3, count), np.int32),
    }
    return {name: array[1] for name, array in arrays.items()}


@pytest.fixture(params=["with PufferLib", "without"])
def puffer(request, monkeypatch):
    library = ModuleType("pufferlib")
    library.PufferEnv = Contract
    monkeypatch.setitem(sys.modules, "pufferlib", library if "with " in request.param else None)
    monkeypatch.delitem(sys.modules, "eyas.envs.puffer", raising=False)
    return importlib.import_module("eyas.envs.puffer")


def test_it_writes_into_the_given_arrays_what_the_vector_environment_gives(puffer):
    plain = EyasVectorEnv(3, SHORT, autoreset_mode="SameStep", **SMALL)
    given = buffers(puffer.EyasPufferEnv(3, SHORT, **SMALL))
    env = puffer.EyasPufferEnv(3, SHORT, buf=given, seed=9, **SMALL)
    assert env.num_agents == 3
    for seed, first in ((4, 12), (None, None)):
        seen, infos = env.reset(seed)
        assert seen is given["observations"]
        assert infos == []
        assert np.array_equal(seen, plain.reset(seed=first)[0])
        assert not given["rewards"].any()
        assert not given["terminals"].any()
        total = np.zeros(3)
        for step in range(10):
            actions = np.array([0, 1, 6], np.int32)
            *arrays, infos = env.step(actions)
            names = ("observations", "rewards", "terminals", "truncations")
            expected = plain.step(actions)
            total += expected[1]
            for name, array, wanted in zip(names, arrays, expected, strict=False):
                assert array is given[name]
                assert np.array_equal(array, wanted.astype(array.dtype))
            assert (len(infos) == 3) == (step == 9)
        assert [info["episode_return"] for info in infos] == pytest.approx(total.tolist())
        assert {info["episode_length"] for info in infos} == {10.0}
        assert given["truncations"].all()
    env.close()


def test_it_has_arrays_of_its_own_if_none_are_given(puffer):
    env = puffer.EyasPufferEnv(2, SHORT, render_mode="rgb_array", seed=3, **SMALL)
    first = env.reset()[0].copy()
    assert np.array_equal(first, EyasVectorEnv(2, SHORT, **SMALL).reset(seed=6)[0])
    assert env.observations.shape == (2, 20, 24, 3)
    assert env.render().shape == (240, 320, 3)
    assert env.masks.all()
    with pytest.raises(EyasError, match=r"^env.observation.parts: not allowed: one part"):
        puffer.EyasPufferEnv(2, observation={"parts": ["image", "sensors"]})


def test_pufferlibs_own_class_is_its_base_if_there_is_one(puffer):
    env = puffer.EyasPufferEnv(2, SHORT, **SMALL)
    assert isinstance(env, Contract) == (sys.modules["pufferlib"] is not None)
    assert isinstance(env.reset(1)[1], list)
