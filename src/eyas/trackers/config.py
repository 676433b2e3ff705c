"""Settings of the tracker."""

from enum import StrEnum

from eyas.core.config import Config

__all__ = ["TrackerConfig", "TrackerKind"]


class TrackerKind(StrEnum):
    """What follows the target."""

    DRONE = "drone"
    """A quadrotor with a camera on a gimbal."""
    CAR = "car"
    """An ideal ground robot."""


class TrackerConfig(Config):
    """What follows, and how it obeys."""

    kind: TrackerKind = TrackerKind.DRONE
    """What follows the target."""
    supervised: bool = True
    """True: commands are obeyed exactly; False: a flight controller flies them."""
