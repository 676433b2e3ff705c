"""Settings of the task: start, reward, end."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.core.config import Config
from eyas.core.variation import Uniform, Variation

__all__ = ["DoneConfig", "RewardConfig", "RewardMode", "RewardType", "StartConfig"]

Positive = Annotated[float, Field(gt=0)]
Steps = Annotated[int, Field(ge=0, le=2**31 - 1)]


class RewardType(StrEnum):
    """Which error is rewarded."""

    VIEW = "view"
    """Where the target stands in the ground quadrilateral that the camera sees."""
    DISTANCE = "distance"
    """How far the target is from the ground point that the camera looks at."""


class RewardMode(StrEnum):
    """Which values the reward takes."""

    CONTINUOUS = "continuous"
    DISCRETE = "discrete"


class StartConfig(Config):
    """Where the tracker starts, relative to its target. Each is drawn anew at a reset."""

    pitch: Variation = 1.0
    """Camera pitch, positive down [rad]; held within 0.5 to 1.5."""
    height: Variation = Uniform(uniform=(13.0, 25.0))
    """Height above the target [m]."""
    direction: Variation = 0.0
    """Heading relative to the target's [rad]."""
    horizontal_bias: Variation = 0.0
    """Sideways offset of the tracker, positive left, so that the target appears right [m]."""
    vertical_bias: Variation = 0.0
    """Forward offset of the tracker, so that the target appears lower [m]."""
    warm_up_steps: Steps = 310
    """2 ms steps of traffic before the trackers start."""


class RewardConfig(Config):
    """The built-in rewards."""

    type: RewardType = RewardType.VIEW
    """Which error is rewarded."""
    mode: RewardMode = RewardMode.CONTINUOUS
    """Which values the reward takes."""
    cut_off: Annotated[float, Field(ge=0, le=1)] = 0.001
    """At or below this reward the no-reward counter runs."""
    distance_scale: Positive = 0.01
    """Decay of the continuous distance reward [1/m^3]."""
    distance_range: Positive = 7.0
    """Largest rewarded distance [m]."""
    view_scale: Positive = 4.0
    """Steepness of the continuous view reward."""
    view_range: Annotated[float, Field(gt=0, le=10)] = 0.7
    """Share of the picture's width and height within which the target is rewarded."""


class DoneConfig(Config):
    """When an episode ends."""

    max_height: float = 50.0
    """Highest allowed position of the tracker [m]."""
    min_height: float = 2.0
    """Lowest allowed position of the tracker [m]."""
    velocity: Positive = 10000.0
    """Speed at which the episode ends [m/s]."""
    yaw_rate: Positive = 6.283
    """Highest allowed yaw rate [rad/s]."""
    roll: Positive = 1.22
    """Highest allowed roll [rad]."""
    pitch: Positive = 1.22
    """Highest allowed pitch of the body [rad]."""
    distance_error: Positive = 50.0
    """Largest allowed distance between commanded and true position [m]."""
    total_steps: Annotated[int, Field(ge=1, le=2**31 - 1)] = 1500
    """2 ms steps in an episode."""
    grace_steps: Steps = 100
    """2 ms steps after a reset in which no end is reported."""
    no_reward_steps: Steps = 100
    """2 ms steps without reward after which the episode ends."""
