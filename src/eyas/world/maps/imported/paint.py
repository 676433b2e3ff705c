"""Paint on imported streets: lines between lanes, stop lines at signals, crossings.

Real streets have ends, one-way parts and lanes that begin and end, so every street is painted by
itself.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.state.roads import RoadNetwork
from eyas.world.build.millimetres import dot, rounded, unit
from eyas.world.osm.features import Features
from eyas.world.roads.areas import Street, streets
from eyas.world.roads.painting import RoadPaint, Stripe, stripes

__all__ = ["road_paint"]

_SHORTEST = 9.0
"""Shorter streets have no lines [m]."""
_SLOWEST = 7.0
"""On slower streets nothing is painted: drives and yards [m/s]."""
_LINE, _DASH = 0.16, (3.0, 6.0)
_EDGE = 0.28
"""From the kerb to the edge line [m]."""
_STOP_LINE = 0.4
_STOP_BACK = 0.6
"""From the end of a lane back to the stop line [m]."""
_ZEBRA = (0.9, 4.1)
"""Range of a crossing beyond a stop line [m]."""
_BAR = 0.5
_ACROSS = 16.0
"""Widest half of a street with a crossing in its course [m]."""

Line = NDArray[np.float64]


def road_paint(network: RoadNetwork, roads: shapely.Geometry, features: Features) -> RoadPaint:
    """Return the paint of all streets.

    Args:
        network: The streets.
        roads: Their asphalt [m].
        features: Crossings, and the streets that end at signals.
    """
    every = streets(network)
    ways = {(street.start, street.end) for street in every}
    speeds = {int(edge): network.lane_speed[lane] for lane, edge in enumerate(network.lane_edge)}
    lines: list[Stripe] = []
    zebras: list[list[Stripe]] = []
    signalled = set(features.signals)
    for index, street in enumerate(every):
        if len(street.right) < 2 or len(street.left) < 2 or speeds[index] < _SLOWEST:
            continue
        both = (street.end, street.start) in ways
        if shapely.LineString(street.right).length > _SHORTEST:
            lines += _lines(street, both=both)
        if network.edges[index] in signalled:
            lines.append(_stop_line(street))
            zebras.append(_zebra(street, both=both))
    zebras += _crossings(network, roads, features)
    return RoadPaint(lines, [], [bars for bars in zebras if bars])


def _lines(street: Street, *, both: bool) -> list[Stripe]:
    """Return the lines along a street; one of two directions draws the line between them."""
    made: list[Stripe] = []
    several = len(street.dividers) > 0
    if both and tuple(street.left[0]) < tuple(street.left[-1]):
        made += stripes(street.left, _LINE, None if several else _DASH)
    for divider in street.dividers:
        if len(divider) >= 2:
            made += stripes(divider, _LINE, _DASH)
    if several:
        edges = [(street.right, _EDGE)] + ([] if both else [(street.left, -_EDGE)])
        for line, aside in edges:
            moved = shapely.offset_curve(shapely.LineString(line), aside)
            if moved.geom_type == "LineString" and not moved.is_empty:
                made += stripes(shapely.get_coordinates(moved), _LINE)
    return made


def _frame(street: Street) -> tuple[Line, Line, Line, float]:
    """Return the right end of a street, the directions onwards and left, and its width [m]."""
    onwards = unit(street.right[-1] - street.right[-2])
    leftwards = np.array([-onwards[1], onwards[0]])
    return street.right[-1], onwards, leftwards, dot(street.left[-1] - street.right[-1], leftwards)


def _placed(street: Street, points: list[tuple[float, float]]) -> Line:
    """Return points given onwards and leftwards from the right end of a street [m]."""
    origin, onwards, leftwards, _ = _frame(street)
    return rounded(np.array(points) @ np.stack([onwards, leftwards]) + origin)


def _stop_line(street: Street) -> Stripe:
    ends = [(-_STOP_BACK, 0.15), (-_STOP_BACK, max(_frame(street)[3] - 0.15, 0.5))]
    return Stripe(_placed(street, ends), _STOP_LINE)


def _zebra(street: Street, *, both: bool) -> list[Stripe]:
    """Return the bars of the crossing beyond a stop line, over both directions of the street."""
    road = _frame(street)[3] * (2.0 if both else 1.0)
    count = int((road - 0.4) // (2 * _BAR))
    first = (road - (2 * count - 1) * _BAR) / 2 + _BAR / 2
    low, high = _ZEBRA
    return [
        Stripe(_placed(street, [(low, y), (high, y)]), _BAR)
        for y in first + 2 * _BAR * np.arange(count)
    ]


def _crossings(
    network: RoadNetwork, roads: shapely.Geometry, features: Features
) -> list[list[Stripe]]:
    """Return the bars of crossings in the course of streets."""
    if not features.crossings:
        return []
    first = network.lane_first
    lanes = [
        shapely.LineString(network.lane_points[first[k] : first[k + 1]])
        for k in range(len(first) - 1)
    ]
    tree = shapely.STRtree(lanes)
    made = []
    for place in features.crossings:
        point = shapely.Point(place)
        lane = lanes[int(tree.nearest(point))]
        along = float(lane.project(point))
        # Those at the ends of streets are painted with the signals there.
        if lane.distance(point) < 6.0 and 6.0 < along < lane.length - 6.0:
            made.append(_bars(lane, along, roads))
    return made


def _bars(lane: shapely.LineString, along: float, roads: shapely.Geometry) -> list[Stripe]:
    here, there = (shapely.get_coordinates(lane.interpolate(s))[0] for s in (along, along + 0.5))
    onwards = unit(there - here)
    leftwards = np.array([-onwards[1], onwards[0]])
    across = shapely.LineString([here - _ACROSS * leftwards, here + _ACROSS * leftwards])
    parts = shapely.get_parts(shapely.intersection(across, roads))
    own = [part for part in parts if part.distance(shapely.Point(here)) < 0.1]
    if not own:
        return []
    low, high = sorted(
        dot(end - here, leftwards) for end in shapely.get_coordinates(own[0])[[0, -1]]
    )
    count = int((high - low - 0.4) // (2 * _BAR))
    start = (low + high) / 2 - (count - 0.5) * _BAR + _BAR / 2 - _BAR / 2
    middles = [here + (start + 2 * _BAR * k) * leftwards for k in range(count)]
    return [
        Stripe(rounded(np.stack([m - 1.6 * onwards, m + 1.6 * onwards])), _BAR) for m in middles
    ]
