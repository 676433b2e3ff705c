"""Set points of position or velocity, and the velocity that they ask for, in Eyas' frames."""

import math
from typing import NamedTuple, Protocol

from eyas.lanes import exact
from eyas.robotics.mavlink.frames import Vector, wrapped

_GAIN = 1.2  # Speed for a distance [1/s]
_YAW_GAIN = 2.0  # Yaw rate for an error of the heading [1/s]
_FASTEST_TURN = math.radians(90.0)  # [rad/s]


class CommandedPlace(Protocol):
    """Commanded place of a vehicle."""

    @property
    def commanded(self) -> Vector:
        """Place [m]."""

    @property
    def commanded_yaw(self) -> float:
        """Heading [rad]."""

    @property
    def yaw(self) -> float:
        """Heading of the body [rad]."""


class SpeedLimits(NamedTuple):
    """Largest speeds [m/s]."""

    cruise: float  # Horizontal, on the way to a place
    most: float  # Horizontal, of any kind
    up: float
    down: float
    acceleration: float  # Horizontal, with which it may be braked [m/s^2]


class Wanted(NamedTuple):
    """What is to be followed."""

    position: Vector  # [m]
    velocity: Vector  # [m/s]
    time: float  # When it was there [s]


class Goal(NamedTuple):
    """A set point; None is left free, and numbers that are none (NaN) are, too.

    With a place and a velocity, the velocity is that of the place.
    """

    position: Vector | None = None  # World frame [m]
    velocity: Vector | None = None  # [m/s]
    yaw: float | None = None  # [rad]
    yaw_rate: float | None = None  # [rad/s]
    body: bool = False  # Whether the velocity is forward, left, up; else east, north, up


def toward(goal: Goal, place: CommandedPlace, limits: SpeedLimits) -> tuple[Vector, float]:
    """Return the velocity east, north, up [m/s] and the yaw rate [rad/s] that lead to a goal."""
    given = goal.velocity or (0.0, 0.0, 0.0)
    x, y, z = (0.0 if math.isnan(part) else part for part in given)
    if goal.body:
        cosine, sine = float(exact.cos(place.yaw)), float(exact.sin(place.yaw))
        x, y = cosine * x - sine * y, sine * x + cosine * y
    if goal.position is not None:
        away = [
            0.0 if math.isnan(to) else to - at
            for to, at in zip(goal.position, place.commanded, strict=True)
        ]
        distance = float(exact.hypot(away[0], away[1]))
        share = _approach(distance, limits) / max(distance, 1e-9)
        x, y, z = x + share * away[0], y + share * away[1], z + _GAIN * away[2]
    x, y = _shortened(x, y, limits.most)
    return (x, y, min(max(z, -limits.down), limits.up)), _turn(goal, place)


def _approach(distance: float, limits: SpeedLimits) -> float:
    """Return the speed at a distance from a place: as large as can be braked, then in proportion
    to the distance.
    """
    brake = 0.6 * limits.acceleration
    near = brake / (_GAIN * _GAIN)
    speed = _GAIN * distance
    if distance > near:
        speed = math.sqrt(2.0 * brake * (distance - 0.5 * near))
    return min(speed, limits.cruise)


def _shortened(x: float, y: float, most: float) -> tuple[float, float]:
    length = float(exact.hypot(x, y))
    share = most / length if length > most else 1.0
    return share * x, share * y


def _turn(goal: Goal, place: CommandedPlace) -> float:
    rate = goal.yaw_rate or 0.0
    if goal.yaw is not None and not math.isnan(goal.yaw):
        rate = _YAW_GAIN * wrapped(goal.yaw - place.commanded_yaw)
    return min(max(rate, -_FASTEST_TURN), _FASTEST_TURN)
