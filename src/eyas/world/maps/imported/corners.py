"""Corners of imported streets: cars that turn cut them, so kerbs are rounder than SUMO's."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.core import exact
from eyas.state.roads import RoadNetwork
from eyas.world.roads.areas import polygons_of
from eyas.world.roads.curves import TURN

__all__ = ["rounded_corners", "sharp_bends"]

_REACH = 6.0
"""From junctions and bends to where the rounding of their corners begins, at most [m]."""
_WIDTH = 2.0
"""Width of the pavement round a corner [m]."""
_SHARP = 0.5
"""Angle of a sharp bend of a street, at least [rad]."""
_BEND = 7.0
"""Radius of the surroundings of a bend [m]."""
_SLIVER = 0.3
"""Smaller additions are none [m^2]."""


def rounded_corners(
    roads: shapely.Geometry,
    places: shapely.Geometry,
    walked: shapely.Geometry,
    houses: Sequence[shapely.Polygon],
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Return streets with rounder corners, where houses leave room for them and a pavement.

    Args:
        roads: Asphalt [m].
        places: Junctions and sharp bends [m].
        walked: Sidewalks and the corners between them [m].
        houses: Footprints of the buildings [m].

    Returns:
        The asphalt, and the pavements round those corners that have one [m].
    """
    closed = shapely.buffer(shapely.buffer(roads, TURN, quad_segs=8), -TURN, quad_segs=8)
    near = shapely.buffer(places, _REACH, quad_segs=4)
    added = shapely.difference(shapely.intersection(closed, near), roads)
    tree = shapely.STRtree(houses)
    kept = [
        part
        for part in polygons_of(added)
        if part.area > _SLIVER and not len(tree.query(part, predicate="dwithin", distance=_WIDTH))
    ]
    round_ones = shapely.union_all([roads, *kept])
    paved = [part for part in kept if shapely.intersection(part, walked).area > _SLIVER]
    beside = shapely.buffer(shapely.union_all(paved), _WIDTH, quad_segs=4)
    return round_ones, shapely.difference(beside, round_ones)


def sharp_bends(network: RoadNetwork) -> shapely.Geometry:
    """Return the surroundings of the bends of streets between junctions [m]."""
    lane = np.repeat(np.arange(len(network.lane_width)), np.diff(network.lane_first))
    step = np.diff(network.lane_points, axis=0)
    heading = exact.atan2(step[:, 1], step[:, 0])
    turn = np.abs(np.remainder(np.diff(heading) + np.pi, 2.0 * np.pi) - np.pi)
    bent = (turn > _SHARP) & (lane[2:] == lane[:-2])
    return shapely.union_all(
        shapely.buffer(shapely.points(network.lane_points[1:-1][bent]), _BEND, quad_segs=4)
    )
