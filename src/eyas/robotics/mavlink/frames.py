"""Between Eyas' frames and those of MAVLink. Numbers are the same on every processor.

| | Eyas | MAVLink |
|---|---|---|
| world | x east, y north, z up | x north, y east, z down |
| body | x forward, y left, z up | x forward, y right, z down |
| heading | counter-clockwise from east | clockwise from north |
| pitch | positive down | positive up |

Latitudes and longitudes are those of an azimuthal equidistant projection of a sphere of 6,371 km
about the origin of the world, as in PX4 (src/lib/geo/geo.cpp, `MapProjection`).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

_RADIUS = 6_371_000.0
_HALF = math.sqrt(0.5)


def swapped(vector: NDArray[np.float64] | Vector) -> Vector:
    """Return a vector of the world, east-north-up, as north-east-down, or the reverse."""
    return float(vector[1]), float(vector[0]), -float(vector[2])


def to_frd(vector: NDArray[np.float64] | Vector) -> Vector:
    """Return a vector of the body, forward-left-up, as forward-right-down, or the reverse."""
    return float(vector[0]), -float(vector[1]), -float(vector[2])


def wrapped(angle: float) -> float:
    """Return the same direction within -pi to pi [rad]."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


def compass(yaw: float) -> float:
    """Return a heading counter-clockwise from east as one clockwise from north, or the reverse,
    within -pi to pi [rad].
    """
    return wrapped(0.5 * math.pi - yaw)


def of_body(orientation: NDArray[np.float64]) -> Quaternion:
    """Return the attitude of a body, forward-left-up to east-north-up, as forward-right-down to
    north-east-down; w, x, y, z, with w not below 0.
    """
    w, x, y, z = (float(part) for part in orientation)
    # Half a turn about the axis between north and east, from the left; one about x, from the right.
    turned = (_HALF * (w + z), _HALF * (x + y), _HALF * (x - y), _HALF * (w - z))
    return turned if turned[0] >= 0.0 else tuple(-part for part in turned)  # type: ignore[return-value]


def of_angles(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the quaternion of roll, pitch and yaw [rad]; w, x, y, z."""
    sr, cr = exact.sin(0.5 * roll), exact.cos(0.5 * roll)
    sp, cp = exact.sin(0.5 * pitch), exact.cos(0.5 * pitch)
    sy, cy = exact.sin(0.5 * yaw), exact.cos(0.5 * yaw)
    return (
        float(cr * cp * cy + sr * sp * sy),
        float(sr * cp * cy - cr * sp * sy),
        float(cr * sp * cy + sr * cp * sy),
        float(cr * cp * sy - sr * sp * cy),
    )


def camera_angles(
    rotation: NDArray[np.float64],  # Camera to world; columns forward, left, up, shape (3, 3)
) -> Vector:
    """Return roll to the right, pitch up and yaw clockwise from north of a camera [rad]."""
    east, north, up = (float(part) for part in rotation[:, 0])
    pitch = float(exact.asin(min(max(up, -1.0), 1.0)))
    roll = float(exact.atan2(rotation[2, 1], rotation[2, 2]))
    return roll, pitch, float(exact.atan2(east, north))


def usable(number: float) -> bool:
    """Return whether a number of a set point is believed [m, m/s, rad, rad/s]."""
    return abs(number) <= 1e5  # not NaN, nor what is finite but absurd


def on_earth(latitude: float, longitude: float, altitude: float) -> bool:
    """Return whether a place is one on the earth; not if it has numbers that are none."""
    return abs(latitude) <= 90.0 and abs(longitude) <= 180.0 and abs(altitude) <= 1e5


class Geodesy(NamedTuple):
    """Position of the world's origin on the earth."""

    latitude: float  # [degrees]
    longitude: float  # [degrees]
    altitude: float  # Above mean sea level [m]

    def degrees(self, east: float, north: float) -> tuple[float, float]:
        """Return latitude and longitude of a place of the world [degrees]."""
        x, y = north / _RADIUS, east / _RADIUS
        away = float(exact.hypot(x, y))
        if away == 0.0:
            return self.latitude, self.longitude
        start = math.radians(self.latitude)
        sine, cosine = exact.sin(away), exact.cos(away)
        s, c = exact.sin(start), exact.cos(start)
        latitude = exact.asin(cosine * s + x * sine * c / away)
        longitude = exact.atan2(y * sine, away * c * cosine - x * s * sine)
        return math.degrees(latitude), self.longitude + math.degrees(longitude)

    def place(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return the place of a latitude and a longitude: east, north [m]."""
        start, end = math.radians(self.latitude), math.radians(latitude)
        turn = math.radians(longitude - self.longitude)
        s, c, sine, cosine = exact.sin(start), exact.cos(start), exact.sin(end), exact.cos(end)
        along = min(max(float(s * sine + c * cosine * exact.cos(turn)), -1.0), 1.0)
        x, y = c * sine - s * cosine * exact.cos(turn), cosine * exact.sin(turn)
        aside = float(exact.hypot(x, y))  # the sine of the angle between both: exact where small
        if aside == 0.0:
            return 0.0, 0.0
        scale = float(exact.atan2(aside, along)) / aside * _RADIUS
        return float(scale * y), float(scale * x)
