"""Settings of the tracker."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from eyas.core.config import Config

__all__ = ["TrackerConfig", "TrackerKind"]


class TrackerKind(StrEnum):
    """Kinds of trackers."""

    DRONE = "drone"
    """A quadrotor with a camera on a gimbal."""
    CAR = "car"
    """An ideal ground robot."""


class TrackerConfig(Config):
    """Kind of the tracker, and how it follows its commands."""

    kind: TrackerKind = TrackerKind.DRONE
    """Kind of the tracker."""
    supervised: bool = True
    """True: commands are followed exactly; False: a flight controller carries them out."""
    inertial_time_constant: Annotated[float, Field(ge=0, le=10)] = 0.1
    """Time constant of the two low-passes through which accelerometer and gyroscope read the motion
    [s]; 0: the differences of 2 ms, which reach thousands of m/s^2."""
