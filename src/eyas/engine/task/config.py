"""Settings of the task: start, reward, end."""

import math
from enum import StrEnum
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.core.variation import Uniform, Variation, within
from eyas.engine.traffic.config import VehicleType

Positive = Annotated[float, Field(gt=0, le=1e9)]
Height = Annotated[float, Field(ge=-1e6, le=1e6)]
Weight = Annotated[float, Field(ge=-1e9, le=1e9)]
Steps = Annotated[int, Field(ge=0, le=2**31 - 1)]


class RewardType(StrEnum):
    """Quantity that the reward depends on."""

    VIEW = "view"  # Place of the target in the ground quadrilateral that the camera sees
    DISTANCE = "distance"  # Distance of the target from the ground point that the camera looks at


class RewardMode(StrEnum):
    """Values that the reward takes."""

    CONTINUOUS = "continuous"
    DISCRETE = "discrete"


class Crash(StrEnum):
    """What counts as a crash."""

    ORIGINAL = "original"
    """As in the original, which knows no contacts: too far from the commanded position, or turning
    too fast. Costs nothing."""
    CONTACT = "contact"
    """The body touches a building, a tree with its crown, the ground, a vehicle or another tracker;
    the episode goes on."""
    END = "end"  # The same, and the episode ends


class StartVelocity(StrEnum):
    """How fast a tracker is when its episode begins."""

    TARGET = "target"  # As fast as its target, horizontally, in steady flight
    REST = "rest"  # It hovers, as in the original


class StartConfig(Config):
    """Start of the tracker, relative to its target. Variations are sampled anew at each reset. A
    start inside a tree, a building, the ground or another tracker is drawn again, with another
    target and time; in a world that trackers share, it may be above the thing instead.
    """

    pitch: Annotated[Variation, AfterValidator(within(0.1, 3.0))] = 1.0
    """Camera pitch, positive down [rad]; the gimbal limits it to 0.5 to 1.5, but the start
    position is computed from the full value. Camera paths fly at the distance from which it is
    needed, 60 m at most."""
    height: Annotated[Variation, AfterValidator(within(0.1, 1e4))] = Uniform(uniform=(13.0, 25.0))
    """Height above the target [m]; of camera paths (`video.flight`), too."""
    direction: Annotated[Variation, AfterValidator(within(-2 * math.pi, 2 * math.pi))] = 0.0
    """Heading relative to the target's [rad]."""
    horizontal_bias: Annotated[Variation, AfterValidator(within(-1e4, 1e4))] = 0.0
    """Sideways offset of the tracker, positive left, which moves the target right in view [m]."""
    vertical_bias: Annotated[Variation, AfterValidator(within(-1e4, 1e4))] = 0.0
    """Forward offset of the tracker, so that the target appears lower in the picture [m]."""
    velocity: StartVelocity = StartVelocity.TARGET
    """How fast a flown drone begins: as fast as its target, in steady flight, or hovering, as in
    the original. What follows its commands at once (a supervised drone, a car) begins at rest in
    any case. A file of the original means `rest`."""
    warm_up_steps: Annotated[int, Field(ge=0, le=5_000_000)] = 310
    """2 ms steps of traffic before the trackers start."""
    vehicles: Annotated[tuple[VehicleType, ...], Field(min_length=1)] | None = None
    """Classes of the vehicles that may be followed, among those of `traffic.vehicle_type`; None:
    all."""


class RewardConfig(Config):
    """Settings of the reward."""

    type: RewardType = RewardType.VIEW
    """`view`: by the target's position in the ground area that the camera sees; `distance`: by
    its distance from the ground point at which the camera looks."""
    mode: RewardMode = RewardMode.CONTINUOUS
    """Whether the built-in reward is continuous or discrete."""
    weight: Weight = 1.0
    """Factor on the built-in reward."""
    terms: Annotated[dict[str, Weight], NAMES_CODE] = Field(default_factory=dict)
    """Terms to add, and the factor on each: the name of a published one (`e2e`, `d_vat`,
    `d_vat_3d`, `speed`, `effort`), or the path of a function, `package.module:function`, which
    takes a `Snapshot`, or the quantities that its parameters name, and returns a number for each
    tracker."""
    cut_off: Annotated[float, Field(ge=0, le=1)] = 0.001
    """Reward at or below which a step counts as one without reward, 0 to 1."""
    distance_scale: Positive = 0.01
    """Decay of the continuous distance reward [1/m^3]."""
    distance_range: Positive = 7.0
    """Largest rewarded distance [m]."""
    view_scale: Positive = 4.0
    """Steepness of the continuous view reward, a factor without unit."""
    view_range: Annotated[float, Field(gt=0, le=10)] = 0.7
    """Share of the picture's width and height within which the target is rewarded; above 1, this
    part extends beyond the picture."""


class DoneConfig(Config):
    """When an episode ends."""

    max_height: Height = 50.0
    """Highest allowed position of the tracker [m]."""
    min_height: Height = 2.0
    """Lowest allowed position of the tracker [m]."""
    velocity: Positive = 10000.0
    """Horizontal speed at or above which the episode ends [m/s]."""
    yaw_rate: Positive = 6.283
    """Largest allowed yaw rate [rad/s]."""
    roll: Positive = 1.22
    """Largest allowed roll [rad]."""
    pitch: Positive = 1.22
    """Largest allowed pitch of the body [rad]."""
    distance_error: Positive = 50.0
    """Largest allowed horizontal distance between commanded and true position [m]."""
    total_steps: Annotated[int, Field(ge=1, le=2**31 - 1)] = 1500
    """Length of an episode in steps of 2 ms."""
    grace_steps: Steps = 100
    """2 ms steps after a reset during which the episode does not end."""
    no_reward_steps: Steps = 100
    """2 ms steps without reward after which the episode ends."""
    crash: Crash = Crash.ORIGINAL
    """What counts as a crash. `original`: too far from the commanded position, or turning too
    fast, as in the original, which knows no contacts. `contact`: the body touches a building, a
    tree with its crown, the ground, a vehicle or another tracker. `end`: the same, and it ends
    the episode. See Sensors (docs/sensors.md)."""

    @model_validator(mode="after")
    def _heights_in_order(self) -> Self:
        if self.min_height >= self.max_height:
            raise ValueError(f"min_height must be below max_height, which is {self.max_height:g} m")
        return self
