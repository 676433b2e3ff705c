"""Longitudes and latitudes as metres east and north: a transverse Mercator about one place.

SUMO's netconvert is given the same projection, so that streets and buildings fit.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.core import exact
from eyas.world.build.millimetres import rounded

__all__ = ["Projection"]

# The ellipsoid WGS 84: half axis [m], squared eccentricities.
_A = 6378137.0
_FLAT = 1 / 298.257223563
_E2 = _FLAT * (2 - _FLAT)
_EP2 = _E2 / (1 - _E2)

_Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Projection:
    """Metres around a place; exact to a millimetre within 10 km."""

    longitude: float
    """Of the origin, in degrees."""
    latitude: float
    """Of the origin, in degrees."""

    @property
    def text(self) -> str:
        """The projection in the words of the library PROJ."""
        place = f"+lat_0={self.latitude:.7f} +lon_0={self.longitude:.7f}"
        return f"+proj=tmerc {place} +k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m +no_defs"

    def metres(self, places: ArrayLike) -> _Numbers:
        """Return places as east and north at whole millimetres [m], shape (K, 2).

        Args:
            places: Longitude and latitude in degrees, shape (K, 2).
        """
        degrees = np.asarray(places, np.float64).reshape(-1, 2)
        phi = np.radians(degrees[:, 1])
        sine, cosine = exact.sin(phi), exact.cos(phi)
        t, c = np.square(sine / cosine), _EP2 * np.square(cosine)
        n = _A / np.sqrt(1 - _E2 * np.square(sine))
        a = np.radians(degrees[:, 0] - self.longitude) * cosine
        east = n * (
            a
            + (1 - t + c) * exact.power(a, 3) / 6
            + (5 - 18 * t + t * t + 72 * c) * exact.power(a, 5) / 120
        )
        bow = np.square(a) / 2 + (5 - t + 9 * c + 4 * c * c) * exact.power(a, 4) / 24
        start = _meridian(np.array([math.radians(self.latitude)]))
        north = _meridian(phi) - start + n * (sine / cosine) * bow
        return rounded(np.stack([east, north], axis=1))

    def degrees(self, points: ArrayLike) -> _Numbers:
        """Return the longitude and latitude of points, in degrees, shape (K, 2).

        Args:
            points: East and north [m], shape (K, 2).
        """
        goal = np.asarray(points, np.float64).reshape(-1, 2)
        scale = np.array([_A * exact.cos(math.radians(self.latitude)), _A]) * math.pi / 180
        found = np.array([self.longitude, self.latitude]) + goal / scale
        for _ in range(4):  # each step leaves about a thousandth of the error
            found = found + (goal - self.metres(found)) / scale
        return np.round(found, 8)


def _meridian(phi: _Numbers) -> _Numbers:
    """Return the lengths of the meridian from the equator to latitudes [rad], in metres."""
    e4, e6 = _E2 * _E2, _E2 * _E2 * _E2
    length = _A * (
        (1 - _E2 / 4 - 3 * e4 / 64 - 5 * e6 / 256) * phi
        - (3 * _E2 / 8 + 3 * e4 / 32 + 45 * e6 / 1024) * exact.sin(2 * phi)
        + (15 * e4 / 256 + 45 * e6 / 1024) * exact.sin(4 * phi)
        - (35 * e6 / 3072) * exact.sin(6 * phi)
    )
    return np.asarray(length, np.float64)
