import math

import numpy as np
import pytest

from eyas.engine.core.errors import ActionError
from eyas.engine.envs.actions import Discrete, Shares, Velocity, action_table
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.settings.env import EnvSpeeds
from eyas.engine.settings.video import VideoConfig
from eyas.engine.task.done import DoneReason

SPEEDS = {
    "forward_speed": 5.0,
    "backward_speed": -1.0,
    "left_speed": 3.0,
    "right_speed": -2.0,
    "counter_clockwise_rate": 0.5,
    "clockwise_rate": -0.25,
}


def test_numbers_of_actions_mean_the_same_to_an_agent_and_in_a_recording():
    discrete = Discrete(EnvSpeeds(**SPEEDS))
    recorded = action_table(VideoConfig(**SPEEDS))
    assert discrete.commands(range(6)).tolist() == recorded.tolist()


def test_each_number_moves_along_its_axis():
    discrete = Discrete(EnvSpeeds(**SPEEDS))
    assert discrete.commands(range(7)).tolist() == [
        [5, 0, 0, 0],
        [-1, 0, 0, 0],
        [0, 3, 0, 0],
        [0, -2, 0, 0],
        [0, 0, 0, 0.5],
        [0, 0, 0, -0.25],
        [0, 0, 0, 0],
    ]


def test_shares_are_those_of_the_speed_of_their_direction():
    continuous = Shares(EnvSpeeds(**SPEEDS, vertical_speed=0.02))
    shares = np.array([np.ones(4), np.full(4, -1.0), [0.5, -0.5, 0, -9]], np.float32)
    assert continuous.commands(shares).tolist() == [
        [5, 3, 0.02, 0.5],
        [-1, -2, -0.02, -0.25],
        [2.5, -1, 0, -0.25],
    ]


def test_velocities_are_in_physical_units_and_clipped_to_the_speeds():
    velocity = Velocity(EnvSpeeds(**SPEEDS, vertical_speed=0.02))
    assert velocity.space.low.tolist() == [-1, -2, -10, -0.25]
    assert velocity.space.high.tolist() == [5, 3, 10, 0.5]
    commands = velocity.commands(np.array([[2.5, -1.0, 5.0, 0.125], [9, -9, -99, -9]]))
    assert commands.tolist() == [[2.5, -1.0, 0.01, 0.125], [5, -2, -0.02, -0.25]]


@pytest.mark.parametrize(
    "action",
    [-1, 7, 3.5, math.nan, np.float32(3.5), None, "left", [2], np.array([2]), 10**30, np.nan],
    ids=str,
)
def test_an_action_that_is_none_of_the_seven_is_one_clear_line(action):
    with pytest.raises(
        ActionError, match=r"^action: .* is not allowed: a whole number from 0 to 6$"
    ):
        Discrete(EnvSpeeds()).commands([action])


@pytest.mark.parametrize("action", [3, np.int64(3), np.uint8(3), np.array(3), np.array(3, np.int8)])
def test_whole_numbers_of_any_kind_are_taken(action):
    assert Discrete(EnvSpeeds(**SPEEDS)).commands([action]).tolist() == [[0, -2, 0, 0]]


@pytest.mark.parametrize(
    "action",
    [[math.nan, 0, 0, 0], [0, 0, 0, math.inf], [0, 0, 0], [0] * 5, 0, None, "left", [[0] * 4]],
    ids=str,
)
def test_an_action_that_is_not_four_finite_numbers_is_one_clear_line(action):
    allowed = "four finite numbers, each from -1 to 1"
    with pytest.raises(ActionError, match=f"^action: .* is not allowed: {allowed}$") as caught:
        Shares(EnvSpeeds()).commands([action])
    assert "\n" not in str(caught.value)


def test_a_refused_action_leaves_the_episode_as_it_was():
    env, other = TrackingEnv(), TrackingEnv()
    env.reset(seed=3), other.reset(seed=3)
    for wrong in (-1, 7, 3.5, math.nan):
        with pytest.raises(ActionError):
            env.step(wrong)
    assert np.array_equal(env.step(0)[0], other.step(0)[0])


def test_below_the_environment_not_a_number_keeps_its_reason():
    env = TrackingEnv()
    env.reset(seed=3)
    result = env._batch._simulation.advance(np.array([[math.nan, 0.0, 0.0, 0.0]]))
    assert result.reason.tolist() == [DoneReason.NOT_A_NUMBER]


def test_an_environment_takes_its_speeds_from_the_settings_or_the_call():
    still = {"env": {"speeds": {"forward_speed": 0.0}}}
    called = TrackingEnv(still, speeds=EnvSpeeds(backward_speed=0.0))
    places = []
    for env, action in ((TrackingEnv(still), 0), (called, 1), (TrackingEnv(), 0)):
        env.reset(seed=3)
        for _ in range(9):
            *_, info = env.step(action)
        places.append(info["camera_pose"])
    assert np.array_equal(places[0], places[1])
    assert not np.array_equal(places[0], places[2])
    assert called.config.env.speeds == EnvSpeeds(backward_speed=0.0)
