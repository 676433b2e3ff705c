"""Street lamps where the map names them, or where they usually stand along streets."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Lamps, ObjectClass
from eyas.world.build.apart import Apart
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.roads.areas import streets
from eyas.world.street.lamps import BEYOND_KERB, LIGHT, POLE_HEIGHT, POLE_RADIUS, lamp_levels

__all__ = ["add_lamps_at", "usual_lamps"]

_AXIS = np.array([0.4, 0.0, -1.0]) / exact.hypot(0.4, 1.0)
"""Unit vector along the beam, with the arm along x."""

_EVERY = 62.0
"""From one lamp to the next along a kerb [m]."""
_APART = 24.0
"""Least distance between two lamps [m]."""
_FROM_END = 8.0
"""Least distance from the end of a street [m]."""


def usual_lamps(
    network: RoadNetwork, taken: shapely.Geometry, rng: np.random.Generator
) -> list[tuple[float, float]]:
    """Return places beside all kerbs, those of both sides in turn [m].

    Args:
        network: The streets.
        taken: Where no pole may stand [m].
        rng: Random numbers of the lamps.
    """
    shapely.prepare(taken)
    kept = Apart(_APART)
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        beside = shapely.offset_curve(kerb, -BEYOND_KERB)
        start = _FROM_END + float(rng.uniform(0.0, 0.5 * _EVERY))
        along = np.arange(start, kerb.length - _FROM_END, _EVERY)
        if beside.geom_type != "LineString" or not len(along):
            continue
        points = shapely.line_interpolate_point(beside, along)
        for point in points[~shapely.intersects(taken, shapely.buffer(points, 0.6))]:
            kept.add(round(point.x, 3), round(point.y, 3))
    return kept.points


def add_lamps_at(
    builder: SceneBuilder,
    network: RoadNetwork,
    places: Sequence[tuple[float, float]],
    taken: shapely.Geometry,
) -> Lamps:
    """Add street lamps at places; those where something else stands are left out.

    Args:
        builder: The builder to add to.
        network: The streets.
        places: Feet of the lamps [m].
        taken: Where no pole may stand [m].
    """
    prototype = builder.prototype("street lamp", lamp_levels)
    first = network.lane_first
    lanes = [shapely.LineString(network.lane_points[a:b]) for a, b in pairwise(first)]
    tree = shapely.STRtree(lanes)
    shapely.prepare(taken)
    position, axis = [], []
    for x, y in places:
        point = shapely.Point(x, y)
        if shapely.intersects(taken, point.buffer(POLE_RADIUS)):
            continue
        ends = shapely.get_coordinates(
            shapely.shortest_line(point, lanes[int(tree.nearest(point))])
        )
        turn = round(float(exact.atan2(*(ends[1] - ends[0])[::-1])), 6)
        onto_road = np.array([exact.cos(turn), exact.sin(turn)])
        owner = builder.add_copy(ObjectClass.POLE, prototype, (x, y, 0.0), turn, 1.0)
        builder.add_cylinder((x, y), POLE_RADIUS, FLOOR_HEIGHT, POLE_HEIGHT, owner)
        position.append([x + LIGHT[0] * onto_road[0], y + LIGHT[0] * onto_road[1], LIGHT[2]])
        axis.append([_AXIS[0] * onto_road[0], _AXIS[0] * onto_road[1], _AXIS[2]])
    return Lamps(
        np.array(position, np.float32).reshape(-1, 3), np.array(axis, np.float32).reshape(-1, 3)
    )
