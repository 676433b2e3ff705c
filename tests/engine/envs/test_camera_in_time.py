"""Environments whose cameras have a shutter, vibration and a sensor of events."""

import copy
import pickle

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.config import EyasConfig

CAMERA = {
    "width": 64,
    "height": 48,
    "shutter": {"blur": True, "exposure": {"uniform": [0.005, 0.02]}, "readout": 0.02},
    "vibration": {"angle": 0.001},
    "events": {"enabled": True, "bins": 2, "shot": 1.0},
}
PARTS = {"parts": ["image", "depth", "events"], "width": 64, "height": 48}


def config_of(**env) -> EyasConfig:
    return EyasConfig.model_validate({"camera": CAMERA, "env": {"observation": PARTS | env}})


def same(one, other) -> None:
    for part in one:
        np.testing.assert_array_equal(one[part], other[part])


def test_observations_are_in_their_space_and_repeat():
    env = TrackingEnv(config_of())
    assert env.observation_space["events"].shape == (48, 64, 4)
    first, _ = env.reset(seed=3)
    assert not first["events"].any()
    seen = [env.step(5) for _ in range(4)]
    assert all(env.observation_space.contains(each[0]) for each in seen)
    events = seen[-1][4]["events"]
    counts = seen[-1][0]["events"]
    assert len(events) == counts.sum()  # none is above 255
    rows, columns = np.nonzero(counts.sum(axis=-1))
    assert {(y, x) for x, y, *_ in events.tolist()} == {
        *zip(rows.tolist(), columns.tolist(), strict=True)
    }
    env.reset(seed=3)
    for each in seen:
        same(env.step(5)[0], each[0])


def test_channels_come_first_where_that_is_asked():
    env = TrackingEnv(config_of(layout="chw"))
    last = TrackingEnv(config_of())
    for each in (env, last):
        each.reset(seed=3)
    counts, other = (each.step(5)[0]["events"] for each in (env, last))
    assert counts.shape == (4, 48, 64)
    assert counts.any()
    np.testing.assert_array_equal(np.moveaxis(counts, 0, -1), other)


def test_copies_go_on_where_an_environment_is():
    env = TrackingEnv(config_of())
    env.reset(seed=5)
    for _ in range(3):
        env.step(5)
    copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    for _ in range(3):
        observation = env.step(4)[0]
        for each in copies:
            same(each.step(4)[0], observation)


def test_environments_do_not_depend_on_their_number():
    env, several = TrackingEnv(config_of()), EyasVectorEnv(3, config_of())
    env.reset(seed=11)
    several.reset(seed=[11, 12, 13])
    for _ in range(3):
        one = env.step(5)[0]
        many = several.step(np.array([5, 4, 2]))[0]
        same(one, {part: many[part][0] for part in one})


def test_events_need_their_sensor():
    with pytest.raises(ConfigError, match=r"camera\.events\.enabled is false"):
        TrackingEnv(EyasConfig.model_validate({"env": {"observation": {"parts": ["events"]}}}))


def test_the_interface_is_gymnasiums():
    check_env(TrackingEnv(config_of(parts=["image", "events"])), skip_render_check=True)
