import math
import timeit

import numpy as np
import pytest

from eyas.core.errors import ActionError, NotInThisVersionError
from eyas.envs.actions import ContinuousActions, DiscreteActions, action_table
from eyas.envs.config import EnvSpeeds
from eyas.envs.tracking_env import TrackingEnv
from eyas.modes.video.config import VideoConfig
from eyas.task.done import DoneReason

SPEEDS = {
    "forward_speed": 5.0,
    "backward_speed": -1.0,
    "left_speed": 3.0,
    "right_speed": -2.0,
    "counter_clockwise_rate": 0.5,
    "clockwise_rate": -0.25,
}


def test_numbers_of_actions_mean_the_same_to_an_agent_and_in_a_recording():
    discrete = DiscreteActions(EnvSpeeds(**SPEEDS))
    recorded = action_table(VideoConfig(**SPEEDS))
    assert [discrete.command(number)[0].tolist() for number in range(6)] == recorded.tolist()


def test_each_number_moves_along_its_axis():
    discrete = DiscreteActions(EnvSpeeds(**SPEEDS))
    commands = [discrete.command(number)[0].tolist() for number in range(7)]
    assert commands == [
        [5, 0, 0, 0],
        [-1, 0, 0, 0],
        [0, 3, 0, 0],
        [0, -2, 0, 0],
        [0, 0, 0, 0.5],
        [0, 0, 0, -0.25],
        [0, 0, 0, 0],
    ]


def test_continuous_actions_are_shares_of_the_speed_of_their_direction():
    continuous = ContinuousActions(EnvSpeeds(**SPEEDS, vertical_speed=0.02))
    assert continuous.command(np.ones(4)).tolist() == [[5, 3, 0.02, 0.5]]
    assert continuous.command(np.full(4, -1.0)).tolist() == [[-1, -2, -0.02, -0.25]]
    assert continuous.command(np.array([0.5, -0.5, 0, -9])).tolist() == [[2.5, -1, 0, -0.25]]


@pytest.mark.parametrize(
    "action",
    [-1, 7, 3.5, math.nan, np.float32(3.5), None, "left", [2], np.array([2]), 10**30, np.nan],
    ids=str,
)
def test_an_action_that_is_none_of_the_seven_is_one_clear_line(action):
    with pytest.raises(
        ActionError, match=r"^action: .* is not allowed: a whole number from 0 to 6$"
    ):
        DiscreteActions(EnvSpeeds()).command(action)


@pytest.mark.parametrize("action", [3, np.int64(3), np.uint8(3), np.array(3), np.array(3, np.int8)])
def test_whole_numbers_of_any_kind_are_taken(action):
    assert DiscreteActions(EnvSpeeds(**SPEEDS)).command(action).tolist() == [[0, -2, 0, 0]]


@pytest.mark.parametrize(
    "action",
    [[math.nan, 0, 0, 0], [0, 0, 0, math.inf], [0, 0, 0], [0] * 5, 0, None, "left", [[0] * 4]],
    ids=str,
)
def test_an_action_that_is_not_four_finite_numbers_is_one_clear_line(action):
    allowed = "four finite numbers, each from -1 to 1"
    with pytest.raises(ActionError, match=f"^action: .* is not allowed: {allowed}$") as caught:
        ContinuousActions(EnvSpeeds()).command(action)
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
    result = env._simulation.advance(np.array([[math.nan, 0.0, 0.0, 0.0]]))
    assert result.reason.tolist() == [DoneReason.NOT_A_NUMBER]


@pytest.mark.parametrize(("continuous", "action"), [(False, 6), (True, np.zeros(4, np.float32))])
def test_a_command_takes_less_than_a_hundredth_of_a_step(continuous, action):
    env = TrackingEnv(continuous=continuous)
    env.reset(seed=3)
    step = min(timeit.repeat(lambda: env.step(action), number=1, repeat=20))
    command = min(timeit.repeat(lambda: env._actions.command(action), number=100, repeat=20)) / 100
    assert command < 0.01 * step


def test_an_environment_takes_its_speeds_from_the_settings_or_the_call():
    still = {"env": {"speeds": {"forward_speed": 0.0}}}
    called = TrackingEnv(still, speeds=EnvSpeeds(backward_speed=0.0))
    places = []
    for env, action in ((TrackingEnv(still), 0), (called, 1), (TrackingEnv(), 0)):
        env.reset(seed=3)
        for _ in range(9):
            *_, info = env.step(action)
        places.append(info["camera_pose"])
    assert places[0] == places[1]
    assert places[0] != places[2]
    assert called.config.env.speeds == EnvSpeeds(backward_speed=0.0)


def test_an_environment_names_what_is_not_in_this_version_in_both_notations():
    with pytest.raises(NotInThisVersionError, match=r"tracker\.kind \(Tracker_Def\): 'car'"):
        TrackingEnv({"tracker": {"kind": "car"}})
