"""Settings of the tracker."""

from enum import StrEnum

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
