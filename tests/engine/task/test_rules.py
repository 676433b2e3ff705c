import math

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.task.config import DoneConfig, RewardConfig, RewardMode, RewardType
from eyas.engine.task.reward import rewarded_size
from eyas.engine.task.rules import BuiltinReward, exact, make_rules


def test_rewarded_rectangle_is_the_share_of_the_picture():
    camera = CameraConfig(width=640, height=320)
    rules = make_rules(RewardConfig(view_range=0.5), DoneConfig(), camera)
    half_width, half_height = rewarded_size(1.0, rules)
    assert half_width == pytest.approx(0.5 * math.tan(0.5))
    assert half_height == pytest.approx(0.25 * math.tan(0.5))


def test_every_limit_is_taken_from_the_field_of_its_name():
    done = DoneConfig(
        max_height=41.0, min_height=3.0, velocity=5.0, yaw_rate=6.0, roll=0.7, pitch=0.8,
        distance_error=9.0, total_steps=10, grace_steps=11, no_reward_steps=12,
    )  # fmt: skip
    reward = RewardConfig(
        type=RewardType.DISTANCE, mode=RewardMode.DISCRETE,
        cut_off=0.1, distance_scale=0.2, distance_range=0.3, view_scale=0.4,
    )  # fmt: skip
    rules = make_rules(reward, done, CameraConfig())
    assert rules.reward == BuiltinReward.DISTANCE_DISCRETE
    for settings in (done, reward):
        for name in type(settings).model_fields:
            if name not in ("type", "mode", "view_range", "weight", "terms", "crash"):
                assert getattr(rules, name) == getattr(settings, name), name


@pytest.mark.parametrize("type_", RewardType)
@pytest.mark.parametrize("mode", RewardMode)
def test_each_reward_is_the_one_of_its_name(type_, mode):
    rules = make_rules(RewardConfig(type=type_, mode=mode), DoneConfig(), CameraConfig())
    assert BuiltinReward(rules.reward).name.lower() == f"{type_}_{mode}"


def test_exact_rules_have_the_types_that_kernels_are_compiled_for():
    rules = make_rules(RewardConfig(), DoneConfig(), CameraConfig())
    changed = exact(rules._replace(max_height=30, total_steps=5.0))
    assert [type(value) for value in changed] == [type(value) for value in rules]
    assert (changed.max_height, changed.total_steps) == (30.0, 5)
