"""The settings of the reward and the end of an episode, as plain numbers for kernels."""

import math
from enum import IntEnum
from typing import NamedTuple

from eyas.engine.camera.config import CameraConfig
from eyas.engine.task.config import DoneConfig, RewardConfig, RewardMode, RewardType


class BuiltinReward(IntEnum):
    """The built-in rewards; `eyas.engine.task.reward` has a function of the same name for all but
    the constant one, which is 1.
    """

    VIEW_CONTINUOUS = 0
    VIEW_DISCRETE = 1
    DISTANCE_CONTINUOUS = 2
    DISTANCE_DISCRETE = 3
    CONSTANT = 4


BUILTIN_REWARDS = {
    (RewardType.VIEW, RewardMode.CONTINUOUS): BuiltinReward.VIEW_CONTINUOUS,
    (RewardType.VIEW, RewardMode.DISCRETE): BuiltinReward.VIEW_DISCRETE,
    (RewardType.DISTANCE, RewardMode.CONTINUOUS): BuiltinReward.DISTANCE_CONTINUOUS,
    (RewardType.DISTANCE, RewardMode.DISCRETE): BuiltinReward.DISTANCE_DISCRETE,
}


class Rules(NamedTuple):
    """Settings for the task's kernels; lengths in metres, angles in radians."""

    view_range: float  # Share of the picture's width and height within which the target is rewarded
    aspect: float  # Height of the picture over its width
    reward: int  # `BuiltinReward`
    cut_off: float
    distance_scale: float
    distance_range: float
    view_scale: float
    max_height: float
    min_height: float
    velocity: float
    yaw_rate: float
    roll: float
    pitch: float
    distance_error: float
    total_steps: int
    grace_steps: int
    no_reward_steps: int


def exact(rules: Rules) -> Rules:
    """Return the rules with each value converted to the type of its field.

    Kernels are compiled for the types of the values: `max_height=30` would compile them anew.
    """
    types = Rules.__annotations__.values()
    return Rules(*(kind(value) for kind, value in zip(types, rules, strict=True)))


def lenient(rules: Rules) -> Rules:
    """Return rules by which the reward is 1 and no limit of the body ends an episode."""
    return rules._replace(
        reward=int(BuiltinReward.CONSTANT),
        max_height=math.inf,
        min_height=-math.inf,
        velocity=math.inf,
        yaw_rate=math.inf,
        roll=math.inf,
        pitch=math.inf,
        distance_error=math.inf,
    )


def make_rules(
    reward: RewardConfig,  # Settings of the reward
    done: DoneConfig,  # Settings of the end of an episode
    camera: CameraConfig,  # Camera whose picture the view reward uses
) -> Rules:
    """Return the settings as numbers."""
    return Rules(
        view_range=reward.view_range,
        aspect=camera.height / camera.width,
        reward=int(BUILTIN_REWARDS[reward.type, reward.mode]),
        cut_off=reward.cut_off,
        distance_scale=reward.distance_scale,
        distance_range=reward.distance_range,
        view_scale=reward.view_scale,
        max_height=done.max_height,
        min_height=done.min_height,
        velocity=done.velocity,
        yaw_rate=done.yaw_rate,
        roll=done.roll,
        pitch=done.pitch,
        distance_error=done.distance_error,
        total_steps=done.total_steps,
        grace_steps=done.grace_steps,
        no_reward_steps=done.no_reward_steps,
    )
