"""Rows of parking bays in car parks of any shape."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact
from eyas.maps.buildings.lots import frame_angle, turned

__all__ = ["bays_in"]

_MODULE = 16.4  # Depth of two rows of bays and the aisle between them [m]
_BAY_LENGTH, _BAY_WIDTH = 5.1, 2.6
_EDGE = 0.4  # From the edge of the car park to the bays [m]
_PAINT = 0.12  # Width of a line between bays [m]

Bays = NDArray[np.float64]


def bays_in(area: shapely.Geometry) -> tuple[Bays, list[shapely.Polygon]]:
    """Return bays that lie within a car park, and the paint between them.

    Args:
        area: The car park in plan view [m].

    Returns:
        Centre of each bay [m] and heading of a car in it [rad], shape (K, 3); lines [m].
    """
    if area.is_empty:
        return np.zeros((0, 3)), []
    hull = shapely.convex_hull(area)
    angle = frame_angle(hull) if hull.geom_type == "Polygon" else 0.0
    room = shapely.buffer(turned(area, -angle), -_EDGE, join_style="mitre")
    if room.is_empty:
        return np.zeros((0, 3)), []
    west, south, east, north = room.bounds
    columns = west + _BAY_WIDTH * np.arange(int((east - west) // _BAY_WIDTH))
    modules = south + _MODULE * np.arange(int((north - south) // _MODULE) + 1)
    rows = np.concatenate([modules, modules + _MODULE - _BAY_LENGTH - _EDGE])
    x, y = (axis.ravel() for axis in np.meshgrid(columns, np.sort(rows), indexing="ij"))
    boxes = shapely.box(x, y, x + _BAY_WIDTH, y + _BAY_LENGTH)
    inside = shapely.contains_properly(room, boxes)
    x, y = x[inside], y[inside]
    sides = np.unique(np.round(np.concatenate([np.c_[x, y], np.c_[x + _BAY_WIDTH, y]]), 2), axis=0)
    paint = shapely.box(sides[:, 0] - _PAINT / 2, sides[:, 1], sides[:, 0] + _PAINT / 2,
                        sides[:, 1] + _BAY_LENGTH)  # fmt: skip
    middles = np.stack([x + _BAY_WIDTH / 2, y + _BAY_LENGTH / 2], axis=1)
    cosine, sine = exact.cos(angle), exact.sin(angle)
    places = rounded(exact.product(middles, np.array([[cosine, sine], [-sine, cosine]])))
    heading = np.full((len(places), 1), angle + np.pi / 2)
    return np.concatenate([places, heading], axis=1), [turned(line, angle) for line in paint]
