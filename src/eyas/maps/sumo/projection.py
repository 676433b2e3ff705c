"""Where a network of SUMO lies on earth: longitudes and latitudes as the metres of its file."""

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.projection import Projection


@dataclass(frozen=True, slots=True)
class NetProjection(Projection):
    """A transverse Mercator with a scale, shifted to the metres of a map."""

    scale: float = 1.0  # On the central meridian
    east: float = 0.0  # What is added to the scaled metres [m]
    north: float = 0.0

    def metres(self, places: ArrayLike) -> NDArray[np.float64]:
        """Return longitudes and latitudes in degrees as east and north [m], both (K, 2)."""
        # Not by `super()`, which a dataclass with slots has not.
        return rounded(Projection.metres(self, places) * self.scale + (self.east, self.north))

    def degrees(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return east and north [m] as longitudes and latitudes in degrees, both (K, 2)."""
        moved = (np.asarray(points, np.float64) - (self.east, self.north)) / self.scale
        return Projection.degrees(self, moved)


def projection_of_net(
    location: dict[str, str],  # Attributes of its <location>
    middle: tuple[float, float],  # In its own metres: what becomes 0, 0
) -> NetProjection | None:
    """Return the projection of a network, to the metres of a map about its middle; None: it lies
    nowhere, or in a projection other than UTM and the transverse Mercator.
    """
    words = dict(re.findall(r"\+(\w+)(?:=(\S+))?", location.get("projParameter", "")))
    try:
        offset = [float(each) for each in location.get("netOffset", "0,0").split(",")]
        west, south, east, north = (float(v) for v in location["origBoundary"].split(","))
        made = _KNOWN[words.get("proj", "")](words, 0.5 * (south + north))
    except (ValueError, KeyError):
        return None
    if not (-180.0 <= west < east <= 180.0 and -84.0 <= south < north <= 84.0):
        return None
    longitude, latitude, scale, x, y = made
    shift = (x + offset[0] - middle[0], y + offset[1] - middle[1])
    return NetProjection(longitude, latitude, scale, *shift)


_Made = tuple[float, float, float, float, float]


def _utm(words: dict[str, str], latitude: float) -> _Made:
    """Return origin, scale and what is added; the origin is near, where the series is exact."""
    longitude, scale = 6.0 * int(words["zone"]) - 183.0, 0.9996
    up = float(Projection(longitude, 0.0).metres((longitude, latitude))[0, 1])
    return longitude, latitude, scale, 5e5, scale * up + (1e7 if "south" in words else 0.0)


def _tmerc(words: dict[str, str], latitude: float) -> _Made:
    longitude, start = float(words.get("lon_0", "0")), float(words.get("lat_0", "0"))
    scale = float(words.get("k") or words.get("k_0") or "1")
    up = float(Projection(longitude, start).metres((longitude, latitude))[0, 1])
    x, y = float(words.get("x_0", "0")), float(words.get("y_0", "0"))
    return longitude, latitude, scale, x, scale * up + y


_KNOWN: dict[str, Callable[[dict[str, str], float], _Made]] = {"utm": _utm, "tmerc": _tmerc}
