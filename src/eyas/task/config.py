"""Settings of the task: start, reward, end."""

import math
from enum import StrEnum
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.core.config import Config
from eyas.core.variation import Uniform, Variation, within

__all__ = ["DoneConfig", "RewardConfig", "RewardMode", "RewardType", "StartConfig"]

Positive = Annotated[float, Field(gt=0, le=1e9)]
Height = Annotated[float, Field(ge=-1e6, le=1e6)]
Weight = Annotated[float, Field(ge=-1e9, le=1e9)]
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

    pitch: Annotated[Variation, AfterValidator(within(0.1, 3.0))] = 1.0
    """Camera pitch, positive down [rad]; the gimbal holds it within 0.5 to 1.5, the place is drawn
    for the full value."""
    height: Annotated[Variation, AfterValidator(within(0.1, 1e4))] = Uniform(uniform=(13.0, 25.0))
    """Height above the target [m]."""
    direction: Annotated[Variation, AfterValidator(within(-2 * math.pi, 2 * math.pi))] = 0.0
    """Heading relative to the target's [rad]."""
    horizontal_bias: Annotated[Variation, AfterValidator(within(-1e4, 1e4))] = 0.0
    """Sideways offset of the tracker, positive left, so that the target appears right [m]."""
    vertical_bias: Annotated[Variation, AfterValidator(within(-1e4, 1e4))] = 0.0
    """Forward offset of the tracker, so that the target appears lower [m]."""
    warm_up_steps: Annotated[int, Field(ge=0, le=5_000_000)] = 310
    """2 ms steps of traffic before the trackers start."""


class RewardConfig(Config):
    """The built-in rewards."""

    type: RewardType = RewardType.VIEW
    """Which error is rewarded."""
    mode: RewardMode = RewardMode.CONTINUOUS
    """Which values the reward takes."""
    weight: Weight = 1.0
    """Factor on the built-in reward."""
    terms: dict[str, Weight] = Field(default_factory=dict)
    """Terms of your own that are added: the path of a function, `package.module:function`, which
    takes a `Snapshot` and returns a number for each tracker, and the factor on it."""
    cut_off: Annotated[float, Field(ge=0, le=1)] = 0.001
    """0 to 1; at or below this reward the no-reward counter runs."""
    distance_scale: Positive = 0.01
    """Decay of the continuous distance reward [1/m^3]."""
    distance_range: Positive = 7.0
    """Largest rewarded distance [m]."""
    view_scale: Positive = 4.0
    """Steepness of the continuous view reward, a factor without unit."""
    view_range: Annotated[float, Field(gt=0, le=10)] = 0.7
    """Share of the picture's width and height within which the target is rewarded; above 1 it
    reaches beyond the picture."""


class DoneConfig(Config):
    """When an episode ends."""

    max_height: Height = 50.0
    """Highest allowed position of the tracker [m]."""
    min_height: Height = 2.0
    """Lowest allowed position of the tracker [m]."""
    velocity: Positive = 10000.0
    """Horizontal speed from which on the episode ends [m/s]."""
    yaw_rate: Positive = 6.283
    """Highest allowed yaw rate [rad/s]."""
    roll: Positive = 1.22
    """Highest allowed roll [rad]."""
    pitch: Positive = 1.22
    """Highest allowed pitch of the body [rad]."""
    distance_error: Positive = 50.0
    """Largest allowed horizontal distance between commanded and true position [m]."""
    total_steps: Annotated[int, Field(ge=1, le=2**31 - 1)] = 1500
    """2 ms steps in an episode."""
    grace_steps: Steps = 100
    """2 ms steps after a reset in which no end is reported."""
    no_reward_steps: Steps = 100
    """2 ms steps without reward after which the episode ends."""

    @model_validator(mode="after")
    def _heights_in_order(self) -> Self:
        if self.min_height >= self.max_height:
            raise ValueError(f"min_height must be below max_height, which is {self.max_height:g} m")
        return self
