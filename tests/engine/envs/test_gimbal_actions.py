"""Agents that turn their camera."""

import math
from dataclasses import fields

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from eyas.engine.core.errors import ActionError, ConfigError
from eyas.engine.envs.actions import make_actions, turn_rates
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv
from eyas.engine.settings.env import ActionKind, EnvConfig
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.drone import DRONE
from eyas.engine.trackers.gimbal_command import with_gimbal
from eyas.engine.trackers.tracker import Tracker

SMALL = {"width": 16, "height": 16}
KINDS = [kind for kind in ActionKind if kind.gimbal]


def env_of(actions, **settings):
    return TrackingEnv(settings, actions=actions, observation=SMALL)


def angles(env):
    """Return commanded pitch and yaw of the camera [rad]."""
    return env._batch._simulation.snapshot.trackers.commanded_gimbal[0].copy()


def test_numbers_are_followed_by_the_cameras_rates():
    actions = make_actions(EnvConfig(actions="velocity+gimbal"))
    assert actions.space.shape == (6,)
    commands = actions.commands([[1.0, 2.0, 0.5, 0.1, 0.5, -9.0], [0.0] * 6])
    assert commands[0].tolist() == [1.0, 2.0, 0.001, 0.1, 1.5, -1.7, 0.5, 2.5]
    assert commands[1, [0, 1, 2, 3, 6, 7]].tolist() == [0.0] * 6
    assert turn_rates(commands, EnvConfig().gimbal).tolist() == [[0.5, -2.5], [0.0, 0.0]]


def test_shares_are_those_of_the_rates():
    env = EnvConfig(actions="shares+gimbal", gimbal={"pitch_rate": 2.0, "yaw_rate": 4.0})
    commands = make_actions(env).commands(np.array([[0, 0, 0, 0, -0.5, 0.25]], np.float32))
    assert commands[0, 4:].tolist() == [-0.5, 1.7, 1.0, 1.0]


def test_the_first_seven_numbers_are_those_without_a_gimbal():
    plain, turning = (
        make_actions(EnvConfig(actions=f"discrete{more}")) for more in ("", "+gimbal")
    )
    assert turning.space.n == 11
    commands = turning.commands(range(11))
    assert commands[:7, :4].tolist() == plain.commands(range(7)).tolist()
    assert commands[7:, :4].tolist() == [[0.0] * 4] * 4
    rates = turn_rates(commands, EnvConfig().gimbal)
    assert rates.tolist() == [[0.0, 0.0]] * 7 + [[1.5, 0.0], [-1.5, 0.0], [0.0, 2.5], [0.0, -2.5]]


@pytest.mark.parametrize("wrong", [[0.0] * 4, [0.0] * 5 + [math.nan], 3, None])
def test_what_is_not_six_finite_numbers_is_one_clear_line(wrong):
    with pytest.raises(ActionError, match=r"^action: .* not allowed: six finite numbers: .* left"):
        make_actions(EnvConfig(actions="velocity+gimbal")).commands([wrong])


def test_the_camera_turns_at_the_rate_and_stops_at_the_range():
    env = env_of("velocity+gimbal", env={"gimbal": {"most_pitch": 1.2, "most_yaw": 0.25}})
    env.reset(seed=3)
    begun = angles(env)
    env.step([0.0, 0.0, 0.0, 0.0, -0.5, 1.0])
    assert angles(env) - begun == pytest.approx([-0.5 * 0.008, 0.008])
    for _ in range(60):
        env.step([0.0, 0.0, 0.0, 0.0, 1.5, 1.0])
    assert angles(env) == pytest.approx([1.2, 0.25])
    for _ in range(60):
        *_, info = env.step([0.0] * 6)
    assert angles(env) == pytest.approx([1.2, 0.25])
    assert env._batch._simulation.snapshot.trackers.gimbal[0, 1:] == pytest.approx([1.2, 0.25])
    assert np.isfinite(info["camera_pose"]).all()


@pytest.mark.parametrize("supervised", [True, pytest.param(False, marks=pytest.mark.thorough)])
def test_a_camera_that_is_not_turned_changes_nothing(supervised):
    settings = {"tracker": {"supervised": supervised}}
    plain, turning = env_of("velocity", **settings), env_of("velocity+gimbal", **settings)
    for env in (plain, turning):
        env.reset(seed=4)
    rng = np.random.default_rng(1)
    for _ in range(12):
        action = rng.normal(size=4) * 5.0
        a, b = plain.step(action), turning.step([*action, 0.0, 0.0])
        assert np.array_equal(a[0], b[0])
        assert a[1] == b[1]
        assert np.array_equal(a[4]["camera_pose"], b[4]["camera_pose"])


def test_the_same_actions_give_the_same_pictures_in_any_number_of_environments():
    rng = np.random.default_rng(2)
    actions = rng.normal(size=(10, 2, 6)).astype(np.float32)
    both = EyasVectorEnv(2, actions="shares+gimbal", observation=SMALL)
    both.reset(seed=[5, 6])
    alone = env_of("shares+gimbal")
    alone.reset(seed=6)
    for action in actions:
        seen = both.step(action)[0]
        assert np.array_equal(seen[1], alone.step(action[1])[0])
    both.close()


def test_late_commands_turn_the_camera_late():
    env = env_of("velocity+gimbal", control={"action_latency_steps": 8})
    env.reset(seed=3)
    begun = angles(env)
    turns = []
    for _ in range(4):
        env.step([0.0, 0.0, 0.0, 0.0, -1.0, 0.0])
        turns.append(round(float((angles(env) - begun)[0]), 6))
    assert turns == [0.0, 0.0, -0.008, -0.016]


@pytest.mark.filterwarnings("ignore:.*symmetric and normalized")
@pytest.mark.parametrize("kind", KINDS)
def test_environments_pass_gymnasiums_checks(kind):
    check_env(env_of(kind), skip_render_check=True)


def test_they_are_made_by_name_and_learnt_from():
    pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.env_checker import check_env as check

    import eyas  # noqa: F401  # registers the environments

    env = gymnasium.make("eyas/citystreet-day-v0", actions="velocity+gimbal", observation=SMALL)
    check(env.unwrapped, warn=False)


@pytest.mark.thorough
def test_the_same_on_a_device():
    usual, ours = (
        EyasVectorEnv(2, actions="discrete+gimbal", observation=SMALL, device=device)
        for device in (None, "host")
    )
    for env in (usual, ours):
        env.reset(seed=1)
    for action in ([7, 9], [8, 10], [0, 7], [10, 6]):
        a, b = usual.step(np.array(action)), ours.step(np.array(action))
        assert np.array_equal(a[0], np.asarray(b[0]))
        assert np.array_equal(a[1], np.asarray(b[1]))
    usual.close(), ours.close()


def test_a_copy_goes_on_where_the_other_is():
    import copy

    env = env_of("velocity+gimbal")
    env.reset(seed=3)
    env.step([1.0, 0.0, 0.0, 0.0, -1.0, 1.0])
    other = copy.deepcopy(env)
    for _ in range(3):
        a, b = (each.step([1.0, 0.0, 0.0, 0.0, -1.0, 1.0]) for each in (env, other))
        assert np.array_equal(a[0], b[0])


def test_a_camera_fixed_to_the_body_cannot_be_turned():
    with pytest.raises(ConfigError, match=r"'velocity\+gimbal' is not allowed: must be without"):
        env_of("velocity+gimbal", camera={"mount": {}})
    with pytest.raises(ConfigError, match="least_pitch"):
        env_of("velocity+gimbal", env={"gimbal": {"least_pitch": 1.0, "most_pitch": 0.5}})


class Own(Tracker):
    """A tracker of a user's own is made of settings."""

    def __init__(self, config):
        super().__init__(**{field.name: getattr(DRONE, field.name) for field in fields(Tracker)})


def test_a_tracker_of_ones_own_turns_its_camera_too():
    turning = with_gimbal(Own(TrackerConfig()))
    assert turning.advance is with_gimbal(DRONE).advance
    assert turning.start is DRONE.start
