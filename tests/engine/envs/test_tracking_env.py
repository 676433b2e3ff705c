"""The Gymnasium environment, against the checkers of the libraries that use it."""

import logging
import math
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import eyas  # noqa: F401  # makes the environments known
from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv

NAME = "eyas/citystreet-day-v0"


@pytest.mark.parametrize("actions", ["discrete", "shares"])
def test_gymnasium_finds_nothing_wrong(actions):
    env = gymnasium.make(NAME, actions=actions, render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)


@pytest.mark.parametrize("actions", ["discrete", "shares"])
def test_stable_baselines_finds_nothing_wrong(actions):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    env = gymnasium.make(NAME, actions=actions, render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(env.unwrapped)


def test_physical_units_are_what_is_remarked_of_velocities():
    with pytest.warns(UserWarning, match="symmetric and normalized"):
        check_env(TrackingEnv(actions="velocity"), skip_render_check=True)


def test_a_seeded_episode_repeats_and_the_next_one_differs():
    env = gymnasium.make(NAME)
    first, _ = env.reset(seed=3)
    second, _ = env.reset()
    again, _ = env.reset(seed=3)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, second)
    assert first.shape == (84, 84, 3)
    assert first.dtype == np.uint8


def test_observations_share_no_memory():
    env = gymnasium.make(NAME)
    first, _ = env.reset(seed=0)
    kept = first.copy()
    env.step(0)
    assert np.array_equal(first, kept)


def test_an_episode_ends_truncated_at_the_step_limit():
    done = {"total_steps": 40, "grace_steps": 0, "no_reward_steps": 10_000}
    env = gymnasium.make(NAME, config={"done": done})
    _, info = env.reset(seed=0)
    assert info["step"] == 0
    for _ in range(9):
        *_, terminated, truncated, _ = env.step(6)
        assert not terminated
        assert not truncated
    *_, terminated, truncated, info = env.step(6)
    assert truncated
    assert not terminated
    assert info["done_reason"] == "step_limit"


def test_an_episode_ends_terminated_without_reward():
    done = {"grace_steps": 0, "no_reward_steps": 20}
    env = gymnasium.make(NAME, config={"done": done})
    env.reset(seed=0)
    for _ in range(300):
        _, reward, terminated, truncated, info = env.step(1)  # backward: the target is left behind
        if terminated or truncated:
            break
    assert terminated
    assert reward == 0
    assert info["done_reason"] == "no_reward"


def test_a_violated_limit_is_told_and_logged_in_the_originals_words(caplog):
    caplog.set_level(logging.INFO, "eyas.steps")
    done = {"yaw_rate": 1.5, "grace_steps": 0}
    env = TrackingEnv({"done": done, "verbose": True})
    _, info = env.reset(seed=0)
    assert info["done_state"] == "none"
    for _ in range(10):
        *_, terminated, _, info = env.step(4)
        if terminated:
            break
    assert (info["done_reason"], info["done_state"]) == ("yaw_rate", "yaw velocity")
    line = caplog.records[-1].getMessage()
    assert line.startswith("id: DRONE0 done: 1 reward: ")
    assert line.endswith("doneState: yaw velocity")


def test_an_error_names_the_originals_key_if_the_setting_came_from_its_file(tmp_path):
    path = tmp_path / "env_config.json"
    path.write_text('{"Train_Total_Steps": 1000000}')
    with pytest.raises(EyasError, match=r"^done\.total_steps \(Train_Total_Steps\): 1000000 "):
        TrackingEnv(path)


def test_the_reward_packet_comes_by_name():
    env = gymnasium.make(NAME)
    env.reset(seed=0)
    *_, info = env.step(6)
    assert info["camera_width"] == 320
    assert len(info["camera_pose"]) == 16
    assert info["target_type"].endswith("Simple")


def test_the_sensors_come_by_name():
    env = TrackingEnv()
    _, start = env.reset(seed=0)
    assert start["felt_acceleration"] == pytest.approx((0.0, 0.0, 9.81))
    assert not start["velocity"].any()
    assert not start["angular_velocity"].any()
    for _ in range(125):
        *_, info = env.step(0)
    moved = math.dist(info["position"], start["position"])
    assert moved == pytest.approx(40.0, abs=0.5)
    assert math.hypot(*info["velocity"]) == pytest.approx(40.0)
    assert 9.81 < math.hypot(*info["felt_acceleration"]) < 11.0
    w, _, _, z = info["orientation"]
    assert info["euler"] == pytest.approx((0.0, 0.0, 2.0 * math.atan2(z, w)))
    # The basic packet's reward and end are where Gymnasium has them.
    assert not {"reward", "done", "step_count"} & info.keys()


def test_render_gives_the_configured_camera():
    env = gymnasium.make(NAME, render_mode="rgb_array")
    env.reset(seed=0)
    assert env.render().shape == (240, 320, 3)


def test_wrong_settings_say_what_is_wrong_in_one_line():
    with pytest.raises(EyasError, match="did you mean 'citystreet'") as caught:
        gymnasium.make(NAME, map="citystret")
    assert "\n" not in str(caught.value)
    with pytest.raises(EyasError, match="render_mode"):
        TrackingEnv(render_mode="screen")


def test_the_overlay_is_rendered_and_never_observed():
    plain, overlaid = (
        gymnasium.make(NAME, render_mode="rgb_array", overlay=overlay) for overlay in (False, True)
    )
    for step in range(4):
        seen = [env.reset(seed=5)[0] if step == 0 else env.step(6)[0] for env in (plain, overlaid)]
        clean, drawn = plain.render(), overlaid.render()
        assert np.array_equal(*seen)
        assert (clean != drawn).any(axis=-1).mean() > 0.2


def test_terms_of_one_s_own_are_rewarded_and_told_by_name(tmp_path, monkeypatch):
    (tmp_path / "speed_term.py").write_text(
        "def speed(snapshot):\n    return snapshot.targets.speed"
    )
    monkeypatch.syspath_prepend(tmp_path)
    reward = {"weight": 0.5, "terms": {"speed_term:speed": 0.25}}
    env, plain = TrackingEnv({"reward": reward}), TrackingEnv()
    for each in (env, plain):
        _, info = each.reset(seed=5)
        assert not any(name.startswith("reward/") for name in info)
    for _ in range(3):
        _, total, *_, info = env.step(6)
        _, builtin, *_, told = plain.step(6)
        speed = info["reward/speed_term:speed"]
        assert speed > 0.0
        assert told["reward/builtin"] == info["reward/builtin"] == builtin
        assert "reward/speed_term:speed" not in told
        assert total == pytest.approx(0.5 * builtin + 0.25 * speed)
        assert isinstance(total, float)


def test_a_term_that_is_not_there_is_one_line():
    with pytest.raises(
        EyasError, match=r"^reward\.terms: 'nowhere:f': there is no module 'nowhere'"
    ) as caught:
        TrackingEnv({"reward": {"terms": {"nowhere:f": 1.0}}})
    assert "\n" not in str(caught.value)


def test_an_action_that_outlasts_its_episode_is_rewarded_until_the_end():
    ends = {"done": {"total_steps": 10, "grace_steps": 0, "no_reward_steps": 500}}
    once, held = TrackingEnv(ends, action_repeat=1), TrackingEnv(ends, action_repeat=5)
    once.reset(seed=3), held.reset(seed=3)
    rewards, ended = [], False
    while not ended:
        _, reward, terminated, truncated, _ = once.step(6)
        rewards.append(reward)
        ended = terminated or truncated
    _, reward, _, truncated, _ = held.step(6)
    assert (len(rewards) < 5, truncated) == (True, True)
    assert reward == pytest.approx(sum(rewards), rel=1e-12)
