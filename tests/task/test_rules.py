import math

import pytest

from eyas.sensors.config import CameraConfig
from eyas.task.config import DoneConfig, RewardConfig, RewardMode, RewardType
from eyas.task.rules import make_rules


def test_rewarded_rectangle_is_the_share_of_the_picture():
    camera = CameraConfig(width=640, height=320, field_of_view=1.0)
    rules = make_rules(RewardConfig(view_range=0.5), DoneConfig(), camera, -0.1)
    assert rules.half_width == pytest.approx(0.5 * math.tan(0.5))
    assert rules.half_height == pytest.approx(0.25 * math.tan(0.5))
    assert rules.ground == -0.1


def test_every_limit_is_taken_from_the_field_of_its_name():
    done = DoneConfig(
        max_height=41.0, min_height=3.0, velocity=5.0, yaw_rate=6.0, roll=0.7, pitch=0.8,
        distance_error=9.0, total_steps=10, grace_steps=11, no_reward_steps=12,
    )  # fmt: skip
    reward = RewardConfig(
        type=RewardType.DISTANCE, mode=RewardMode.DISCRETE,
        cut_off=0.1, distance_scale=0.2, distance_range=0.3, view_scale=0.4,
    )  # fmt: skip
    rules = make_rules(reward, done, CameraConfig(), 0.0)
    assert rules.distance is rules.discrete is True
    for settings in (done, reward):
        for name in type(settings).model_fields:
            if name not in ("type", "mode", "view_range"):
                assert getattr(rules, name) == getattr(settings, name), name
