import numpy as np
import pytest

from eyas.core.errors import NotInThisVersionError
from eyas.envs.actions import ContinuousActions, DiscreteActions, action_table
from eyas.envs.config import EnvSpeeds
from eyas.envs.tracking_env import TrackingEnv
from eyas.modes.video.config import VideoConfig

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
