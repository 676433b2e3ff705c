"""Where streets of imported towns are crossed: at traffic lights, and where the map says so."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.state.roads import RoadNetwork
from eyas.state.scene import Footways
from eyas.world.build.millimetres import dot, length, rounded, unit
from eyas.world.osm.features import Features
from eyas.world.roads.areas import polygons_of

__all__ = ["HALF", "Crosswalk", "crosswalks_of", "footways", "kept_free"]

HALF = 1.6
"""Half the width of a crossing [m]."""
_ACROSS = 20.0
"""Farthest kerb from where a street is crossed [m]."""
_ROUND = 6.0
"""Kerbs are at most so much farther apart, at each end, than SUMO's crossings are long [m]."""
_OFF = 8.0
"""Farthest lane from a mapped crossing: it may lie within a junction [m]."""
_FROM_END = 2.2
"""From the middle of a crossing to the end of its street, at least [m]."""
_ISLAND = 8.0
"""Widest ground between two carriageways that are crossed as one [m]."""
_BESIDE = 1.0
"""From a kerb to the middle of its pavement [m]."""
_SAME = 7.0
"""Crossings in one direction that are nearer to each other are one [m]."""
_ALIKE = 0.8
"""Least cosine between two crossings in one direction."""

Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Crosswalk:
    """A crossing."""

    line: Line
    """From kerb to kerb [m], shape (2, 2)."""
    light: str = ""
    """Name of its light in the network; empty: it has none."""


def crosswalks_of(
    network: RoadNetwork, roads: shapely.Geometry, walked: shapely.Geometry, features: Features
) -> tuple[list[Crosswalk], shapely.Geometry]:
    """Return all crossings, and the islands in their course [m].

    Args:
        network: The streets.
        roads: Their asphalt [m].
        walked: Sidewalks and the corners between them [m].
        features: The crossings that are mapped, and those at traffic lights.
    """
    shapely.prepare(roads)
    shapely.prepare(walked)
    wanted = [
        (name, *_middle_and_direction(shapely.get_coordinates(line)[[0, -1]]),
         0.5 * line.length + _ROUND)
        for name, line in features.lit_crossings.items()
        if line.length > 2 * _BESIDE
    ]  # fmt: skip
    wanted += [("", *place, _ACROSS - 0.5) for place in _mapped(network, features.crossings)]
    kept: list[Crosswalk] = []
    islands: list[shapely.Geometry] = []
    for light, here, leftwards, farthest in wanted:
        low, high, gaps = _extent(roads, walked, here, leftwards)
        if max(-low, high) > farthest:
            continue
        line = rounded(here + np.array([[low], [high]]) * leftwards)
        if high > low and (light or not any(_same(line, other.line) for other in kept)):
            kept.append(Crosswalk(line, light))
            across = [shapely.LineString(here + np.array(gap)[:, None] * leftwards) for gap in gaps]
            islands += [shapely.buffer(line, HALF, cap_style="flat") for line in across]
    return kept, shapely.difference(shapely.union_all(islands), roads)


def footways(roads: shapely.Geometry, crosswalks: Sequence[Crosswalk]) -> Footways:
    """Return where people walk.

    Args:
        roads: Asphalt of the streets [m].
        crosswalks: The crossings.
    """
    parts = [shapely.geometry.polygon.orient(part) for part in polygons_of(roads)]
    rings = [
        shapely.get_coordinates(ring) for part in parts for ring in (part.exterior, *part.interiors)
    ]
    return Footways(
        kerb_points=np.concatenate([np.zeros((0, 2)), *rings]),
        kerb_first=np.cumsum([0, *map(len, rings)]).astype(np.int32),
        crossings=np.array([walk.line for walk in crosswalks], np.float64).reshape(-1, 2, 2),
        lights=tuple(walk.light for walk in crosswalks),
    )


def kept_free(crosswalks: Sequence[Crosswalk]) -> shapely.Geometry:
    """Return the crossings and the pavement at their ends, where nothing is put [m]."""
    lines = [shapely.LineString(walk.line) for walk in crosswalks]
    return shapely.union_all(shapely.buffer(lines, _BESIDE + HALF, quad_segs=4))


def _middle_and_direction(line: Line) -> tuple[Line, Line]:
    return line.mean(axis=0), unit(line[1] - line[0])


def _mapped(network: RoadNetwork, places: Sequence[tuple[float, float]]) -> list[tuple[Line, Line]]:
    """Return where lanes are crossed [m], and the directions to their left."""
    lanes = [shapely.LineString(network.lane_points[a:b]) for a, b in pairwise(network.lane_first)]
    tree, made = shapely.STRtree(lanes), []
    for point in shapely.points(np.reshape(places, (-1, 2))):
        lane = lanes[int(tree.nearest(point))]
        if lane.distance(point) > _OFF or lane.length < 2 * _FROM_END:
            continue
        along = float(np.clip(lane.project(point), _FROM_END, lane.length - _FROM_END))
        near = [along - 0.25, along + 0.25]
        here, there = shapely.get_coordinates(shapely.line_interpolate_point(lane, near))
        onwards = unit(there - here)
        made.append(((here + there) / 2, np.array([-onwards[1], onwards[0]])))
    return made


def _extent(
    roads: shapely.Geometry, walked: shapely.Geometry, here: Line, leftwards: Line
) -> tuple[float, float, list[tuple[float, float]]]:
    """Return how far a crossing reaches to the right and to the left, and the islands in it [m].

    Where one end is no pavement but the other carriageway is near, it is crossed, too.
    """
    across = shapely.LineString([here - _ACROSS * leftwards, here + _ACROSS * leftwards])
    spans = []
    for part in shapely.get_parts(shapely.intersection(across, roads)):
        ends = sorted(dot(end - here, leftwards) for end in shapely.get_coordinates(part))
        if ends:
            spans.append((ends[0], ends[-1]))
    own = next((span for span in spans if span[0] <= 0.0 <= span[1]), None)
    if own is None:
        return 0.0, 0.0, []
    (low, high), gaps = own, []
    for start, end in sorted(spans):
        if high < start < high + _ISLAND and not _paved(walked, here, leftwards, high + _BESIDE):
            gaps.append((high, start))
            high = end
    for start, end in sorted(spans, reverse=True):
        if low - _ISLAND < end < low and not _paved(walked, here, leftwards, low - _BESIDE):
            gaps.append((end, low))
            low = start
    return low, high, gaps


def _paved(walked: shapely.Geometry, here: Line, leftwards: Line, aside: float) -> bool:
    return bool(shapely.intersects_xy(walked, *(here + aside * leftwards)))


def _same(line: Line, other: Line) -> bool:
    (_, one), (_, two) = _middle_and_direction(line), _middle_and_direction(other)
    away = shapely.distance(shapely.LineString(line), shapely.LineString(other))
    return abs(dot(one, two)) > _ALIKE and float(away) < _SAME and length(line[1] - line[0]) > 0.0
