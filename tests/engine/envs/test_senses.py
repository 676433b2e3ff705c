"""Lidar, contacts and logs of environments."""

import logging

import gymnasium
import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.task.step_line import StepLine

LOW = {"start": {"height": 1.0, "pitch": 1.5, "horizontal_bias": 4.0}}
LIDAR = {"lidar": {"enabled": True}}
PARTS = {"env": {"observation": {"parts": ["image", "lidar"]}}}


def test_an_observation_may_hold_the_lidar():
    env = TrackingEnv({**LOW, **LIDAR, **PARTS, "done": {"min_height": -9.0}})
    assert isinstance(env.observation_space, gymnasium.spaces.Dict)
    seen, info = env.reset(seed=0)
    for _ in range(5):
        assert env.observation_space.contains(seen)
        expected = np.minimum(info["lidar"], 12.0).astype(np.float32)
        np.testing.assert_array_equal(seen["lidar"], expected)
        assert np.isfinite(info["lidar"]).any()
        seen, *_, info = env.step(6)


def test_a_lidar_that_is_not_there_cannot_be_observed():
    with pytest.raises(ConfigError, match=r"^env\.observation\.parts: 'lidar' needs a lidar"):
        TrackingEnv(PARTS)


def test_a_crash_tells_its_place_and_thing():
    config = {"done": {"crash": "end", "min_height": -9.0, "no_reward_steps": 10_000}}
    env = TrackingEnv({**config, "env": {"actions": "velocity"}})
    _, info = env.reset(seed=0)
    assert info["contact_class"] == "nothing"
    for _ in range(600):
        *_, terminated, _, info = env.step([0.0, 0.0, -5.0, 0.0])
        if terminated:
            break
    assert info["done_reason"] == "crash"
    assert info["crash"]
    assert info["contact_class"] != "nothing"
    assert info["contact"][2] <= info["position"][2]
    assert np.linalg.norm(info["contact"] - info["position"]) < 0.7
    _, info = TrackingEnv().reset(seed=0)
    assert "contact" not in info
    assert "lidar" not in info


def test_environments_with_and_without_a_lidar_may_be_mixed():
    parts = [{"settings": {}}, {"settings": {**LIDAR, "done": {"crash": "contact"}}}]
    envs = EyasVectorEnv(2, config={"env": {"mixture": parts}})
    _, info = envs.reset(seed=0)
    assert info["lidar"].shape == (2, 400)
    assert not info["lidar"][0].any()
    envs.close()


def test_logs_are_read_back_and_each_episode_is_told_once(tmp_path, caplog):
    caplog.set_level(logging.INFO, "eyas")
    done = {"total_steps": 40, "grace_steps": 0}
    config = {"verbose": True, "done": done, "env": {"log_folder": str(tmp_path / "logs")}}
    envs = EyasVectorEnv(2, config=config)
    envs.reset(seed=0)
    rewards = [envs.step([6, 0])[1] for _ in range(10)]
    envs.close()
    for agent in range(2):
        lines = (tmp_path / "logs" / f"Agent{agent}.log").read_text().splitlines()
        steps = [StepLine.parse(line) for line in lines]
        assert [step.step_count for step in steps] == [4 * k for k in range(1, 11)]
        assert {step.name for step in steps} == {f"DRONE{agent}"}
        assert [step.done for step in steps] == [False] * 9 + [True]
        assert [step.reward for step in steps] == pytest.approx(
            [row[agent] for row in rewards], rel=1e-5
        )
        assert np.diff([step.time for step in steps]) == pytest.approx(0.008, abs=1e-4)
        assert {step.done_state for step in steps} == {"none"}
    told = [r.getMessage() for r in caplog.records if ": episode " in r.getMessage()]
    assert len(told) == 2
    for agent, line in enumerate(sorted(told)):
        total = sum(row[agent] for row in rewards)
        assert line == (
            f"DRONE{agent}: episode 0: 40 steps (0.080 s), sum of rewards {total:.6g}. "
            "The episode has reached its number of steps."
        )
