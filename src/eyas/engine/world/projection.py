"""Longitudes and latitudes as metres east and north: a transverse Mercator about one place.

SUMO's netconvert is given the same projection, so that streets and buildings fit.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact

# The ellipsoid WGS 84: half axis [m], squared eccentricities.
_A = 6378137.0
_FLAT = 1 / 298.257223563  # Flattening of the ellipsoid WGS 84
_E2 = _FLAT * (2 - _FLAT)  # Square of its first eccentricity
_EP2 = _E2 / (1 - _E2)  # Square of its second eccentricity
_RADIAN = math.pi / 180

_Numbers = NDArray[np.float64]
_Some = Any  # A number, or as many as there are places


@dataclass(frozen=True, slots=True)
class Projection:
    """Metres around a place; exact to a millimetre within 10 km."""

    longitude: float  # Longitude of the origin [degrees]
    latitude: float  # Latitude of the origin [degrees]

    @property
    def text(self) -> str:
        """The projection in the words of the library PROJ."""
        place = f"+lat_0={self.latitude:.7f} +lon_0={self.longitude:.7f}"
        return f"+proj=tmerc {place} +k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m +no_defs"

    def metres(
        self,
        places: ArrayLike,  # Longitude and latitude in degrees, shape (K, 2)
    ) -> _Numbers:
        """Return places as east and north at whole millimetres [m], shape (K, 2)."""
        degrees = np.asarray(places, np.float64).reshape(-1, 2)
        return rounded(np.stack(self._metres(degrees[:, 0], degrees[:, 1]), axis=1))

    def _metres(self, longitude: _Some, latitude: _Some) -> tuple[_Some, _Some]:
        """Return east and north [m] of a place, or of many, not rounded."""
        phi = latitude * _RADIAN
        sine, cosine = exact.sin(phi), exact.cos(phi)
        slope = sine / cosine
        t, c = slope * slope, _EP2 * (cosine * cosine)
        n = _A / np.sqrt(1 - _E2 * (sine * sine))
        away = longitude - self.longitude
        away = away - 360.0 * np.round(away / 360.0)  # the shorter way round the earth
        a = away * _RADIAN * cosine
        square = a * a
        east = n * (
            a
            + (1 - t + c) * (a * square) / 6
            + (5 - 18 * t + t * t + 72 * c) * (a * (square * square)) / 120
        )
        bow = square / 2 + (5 - t + 9 * c + 4 * c * c) * (square * square) / 24
        return east, _meridian(phi) - _start(self.latitude) + n * slope * bow

    def degrees(
        self,
        points: ArrayLike,  # East and north [m], shape (K, 2)
    ) -> _Numbers:
        """Return the longitude and latitude of points, in degrees, shape (K, 2)."""
        goal = np.asarray(points, np.float64).reshape(-1, 2)
        if len(goal) == 1:  # arrays of one number are slow to compute with
            return np.array([self._degrees(*goal[0].tolist())])
        return np.stack(self._degrees(goal[:, 0], goal[:, 1]), axis=1)

    def _degrees(self, east: _Some, north: _Some) -> tuple[_Some, _Some]:
        """Return longitude and latitude [degrees] of a place, or of many."""
        across, along = _A * exact.cos(self.latitude * _RADIAN) * math.pi / 180, _A * math.pi / 180
        longitude, latitude = self.longitude + east / across, self.latitude + north / along
        for _ in range(4):  # each step leaves about a thousandth of the error
            x, y = self._metres(longitude, latitude)
            longitude = longitude + (east - rounded(x)) / across
            latitude = latitude + (north - rounded(y)) / along
        return np.round(longitude, 8), np.round(latitude, 8)


@cache
def _start(latitude: float) -> float:
    """Return the length of the meridian from the equator to a latitude [degrees], in metres."""
    return float(_meridian(latitude * _RADIAN))


def _meridian(phi: _Some) -> _Some:
    """Return the length of the meridian from the equator to latitudes [rad], in metres."""
    e4, e6 = _E2 * _E2, _E2 * _E2 * _E2
    return _A * (
        (1 - _E2 / 4 - 3 * e4 / 64 - 5 * e6 / 256) * phi
        - (3 * _E2 / 8 + 3 * e4 / 32 + 45 * e6 / 1024) * exact.sin(2 * phi)
        + (15 * e4 / 256 + 45 * e6 / 1024) * exact.sin(4 * phi)
        - (35 * e6 / 3072) * exact.sin(6 * phi)
    )
