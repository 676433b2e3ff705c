"""Crossings of the streets of a town, at traffic lights and where it is told, and their paint."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import dot, length, rounded, unit
from eyas.engine.world.roads.areas import Street, streets
from eyas.maps.osm.features import PaintColour, Survey
from eyas.maps.roads.markings import frame_of, placed
from eyas.maps.roads.painting import Stripe, stripes

_HALF = 1.6  # Half the width of a crossing [m]
_ACROSS = 20.0  # Farthest kerb from where a street is crossed [m]
_ROUND = 6.0
"""Kerbs are at most so much farther apart, at each end, than SUMO's crossings are long [m]."""
_OFF = 8.0  # Farthest lane from a mapped crossing: it may lie within a junction [m]
_FROM_END = 2.2  # Distance from the middle of a crossing to the end of its street, at least [m]
_ISLAND = 8.0  # Widest ground between two carriageways that are crossed as one [m]
_BESIDE = 1.0  # Distance from a kerb to the middle of its pavement [m]
_SAME = 7.0  # Crossings in one direction that are nearer to each other are one [m]
_ALIKE = 0.8  # Least cosine between two crossings in one direction

_SHORTEST = 9.0  # Shorter streets have no lines [m]
_SLOWEST = 7.0  # On slower streets nothing is painted: drives and yards [m/s]
_LINE, _DASH = 0.16, (3.0, 6.0)
_EDGE = 0.28  # Distance from the kerb to the edge line [m]
_STOP_LINE = 0.4
_STOP_BACK = 0.6  # Distance from the end of a lane back to the stop line [m]
_BAR = 0.5

Line = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Crosswalk:
    """A crossing."""

    line: Line  # Distance from kerb to kerb [m], shape (2, 2)
    light: str = ""  # Name of its light in the network; empty: it has none


def crosswalks_of(
    network: RoadNetwork,
    roads: shapely.Geometry,  # Their asphalt [m]
    walked: shapely.Geometry,  # Sidewalks and the corners between them [m]
    features: Survey,  # The crossings that are mapped, and those at traffic lights
) -> tuple[list[Crosswalk], shapely.Geometry]:
    """Return all crossings, and the islands in their course [m]."""
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
            islands += [shapely.buffer(line, _HALF, cap_style="flat") for line in across]
    return kept, shapely.difference(shapely.union_all(islands), roads)


def kept_free(crosswalks: Sequence[Crosswalk]) -> shapely.Geometry:
    """Return the crossings and the pavement at their ends, where nothing is put [m]."""
    lines = [shapely.LineString(walk.line) for walk in crosswalks]
    return shapely.union_all(shapely.buffer(lines, _BESIDE + _HALF, quad_segs=4))


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

    Where one end is not a pavement but the other carriageway is near, it is crossed, too.
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


def town_paint(
    network: RoadNetwork,
    roads: shapely.Geometry,
    crosswalks: Sequence[Crosswalk],
    signalled: Collection[str],
    crossings: PaintColour = "yellow",
    middles: PaintColour = "white",
) -> tuple[list[Stripe], list[Stripe]]:
    """Return the white and the yellow paint of all streets and their crossings.

    Args:
        network: The streets.
        roads: Their asphalt [m].
        crosswalks: Their crossings.
        signalled: Edges that end at a traffic light.
        crossings: Colour of the bars of crossings.
        middles: Colour of the line between the two directions of a street.

    Real streets have ends, one-way parts and lanes that begin and end, so every street is painted
    by itself.
    """
    every = streets(network)
    ways = {(street.start, street.end) for street in every}
    speeds = {int(edge): network.lane_speed[lane] for lane, edge in enumerate(network.lane_edge)}
    lines: list[Stripe] = []
    between: list[Stripe] = []
    for index, street in enumerate(every):
        if len(street.right) < 2 or len(street.left) < 2 or speeds[index] < _SLOWEST:
            continue
        both = (street.end, street.start) in ways
        if shapely.LineString(street.right).length > _SHORTEST:
            lines += _lines(street, both=both)
            between += _middle(street) if both else []
        if network.edges[index] in signalled:
            lines.append(_stop_line(street))
    zebras = _zebras(roads, crosswalks)
    bars = [bar for several in zebras for bar in several]
    white, yellow = _cut(lines, zebras), list[Stripe]()
    (yellow if middles == "yellow" else white).extend(_cut(between, zebras))
    (yellow if crossings == "yellow" else white).extend(bars)
    return white, yellow


def _lines(street: Street, *, both: bool) -> list[Stripe]:
    """Return the lines along a street, but that between its two directions."""
    made: list[Stripe] = []
    several = len(street.dividers) > 0
    for divider in street.dividers:
        if len(divider) >= 2:
            made += stripes(divider, _LINE, _DASH)
    if several:
        edges = [(street.right, _EDGE)] + ([] if both else [(street.left, -_EDGE)])
        for line, aside in edges:
            moved = shapely.offset_curve(shapely.LineString(line), street.side * aside)
            if moved.geom_type == "LineString" and not moved.is_empty:
                made += stripes(shapely.get_coordinates(moved), _LINE)
    return made


def _middle(street: Street) -> list[Stripe]:
    """Return the line between two directions, which one of them draws."""
    if tuple(street.left[0]) >= tuple(street.left[-1]):
        return []
    return stripes(street.left, _LINE, None if len(street.dividers) else _DASH)


def _stop_line(street: Street) -> Stripe:
    ends = [(-_STOP_BACK, 0.15), (-_STOP_BACK, max(frame_of(street)[3] - 0.15, 0.5))]
    return Stripe(placed(street, ends), _STOP_LINE)


def _zebras(roads: shapely.Geometry, crosswalks: Sequence[Crosswalk]) -> list[list[Stripe]]:
    """Return the bars of all crossings; where two meet at a corner, those of the first."""
    made: list[list[Stripe]] = []
    free = [_zebra(walk, roads) for walk in crosswalks]
    areas = [[bar.area for bar in bars] for bars in free]
    every = np.array([area for bars in areas for area in bars], object)
    owner = np.repeat(np.arange(len(areas)), [len(bars) for bars in areas])
    one, two = shapely.STRtree(every).query(every, predicate="dwithin", distance=_BAR / 2)
    later = np.zeros(len(every), np.bool_)
    later[one[owner[two] < owner[one]]] = True
    for number, bars in enumerate(free):
        kept = [bar for bar, off in zip(bars, later[owner == number], strict=True) if not off]
        if kept:
            made.append(kept)
    return made


def _cut(lines: list[Stripe], zebras: list[list[Stripe]]) -> list[Stripe]:
    """Return lines without their parts on crossings."""
    outlines = [
        shapely.convex_hull(shapely.union_all([bar.area for bar in bars])) for bars in zebras
    ]
    tree = shapely.STRtree(outlines)
    made: list[Stripe] = []
    for stripe in lines:
        line = shapely.LineString(stripe.middle)
        met = tree.query(line, predicate="intersects")
        if not len(met):
            made.append(stripe)
            continue
        rest = shapely.difference(line, shapely.union_all([outlines[k] for k in met.tolist()]))
        parts = [part for part in shapely.get_parts(rest) if part.length > stripe.width]
        made += [Stripe(rounded(shapely.get_coordinates(part)), stripe.width) for part in parts]
    return made


def _zebra(walk: Crosswalk, roads: shapely.Geometry) -> list[Stripe]:
    """Return the bars of a crossing, where there is asphalt."""
    start, end = walk.line
    across = unit(end - start)
    onwards = np.array([-across[1], across[0]])
    count = int((length(end - start) - 0.4) // (2 * _BAR))
    middles = (start + end) / 2 + (np.arange(count) - (count - 1) / 2)[:, None] * 2 * _BAR * across
    bars = [Stripe(rounded(np.stack([m - _HALF * onwards, m + _HALF * onwards])), _BAR)
            for m in middles]  # fmt: skip
    return [bar for bar in bars if shapely.covers(roads, bar.area)]
