"""Environments of several kinds in one vector environment."""

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.envs.vector_env import EyasVectorEnv

SMALL = {"width": 24, "height": 20}
KINDS = [
    {"weight": 2, "settings": {"world": {"weather": "day"}}},
    {"weight": 1, "settings": {"world": {"weather": "night"}, "camera": {"width": 400}}},
]


def test_each_environment_is_what_it_would_be_alone():
    env = EyasVectorEnv(5, mixture=KINDS, observation=SMALL, render_mode="rgb_array")
    weathers = [config.world.weather for config in env.get_attr("config")]
    assert weathers == ["day", "night", "day", "day", "night"]
    alone = [TrackingEnv(config) for config in env.get_attr("config")]
    first, _ = env.reset(seed=2)
    for index, single in enumerate(alone):
        assert np.array_equal(first[index], single.reset(seed=2 + index)[0])
    for action in range(7):
        seen, rewards, *_, info = env.step(np.full(5, action))
        for index, single in enumerate(alone):
            picture, reward, *_, told = single.step(action)
            assert np.array_equal(seen[index], picture)
            assert rewards[index] == reward
            assert np.array_equal(info["camera_pose"][index], told["camera_pose"])
            assert info["camera_width"][index] == told["camera_width"]
    assert [frame.shape[1] for frame in env.render()] == [320, 400, 320, 320, 400]


def test_the_kind_of_an_environment_does_not_depend_on_their_number():
    few, many = (EyasVectorEnv(count, mixture=KINDS, observation=SMALL) for count in (3, 9))
    weathers = [[c.world.weather for c in env.get_attr("config")] for env in (few, many)]
    assert weathers[1][:3] == weathers[0]
    assert weathers[1].count("night") == 3


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ({"settings": {"world": {"weather": "dya"}}}, "did you mean 'day'"),
        ({"settings": {"wrold": {}}}, r"^env\.mixture\.0\.settings\.wrold: unknown key"),
        ({"settings": {"env": {"action_repeat": 2}}}, r"^env\.mixture\.0\.settings\.env: not all"),
        ({"weight": 0}, r"^env\.mixture\.0\.weight: "),
    ],
)
def test_a_wrong_kind_is_one_clear_line(kind, message):
    with pytest.raises(EyasError, match=message) as caught:
        EyasVectorEnv(2, mixture=[kind])
    assert "\n" not in str(caught.value)


def test_a_single_environment_is_of_the_first_kind():
    kinds = [{"settings": {"world": {"weather": "night"}}}, {"weight": 0.5}]
    assert TrackingEnv(mixture=kinds).config.world.weather == "night"
