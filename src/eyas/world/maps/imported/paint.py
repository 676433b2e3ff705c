"""Paint on imported streets: lines between lanes, stop lines at signals, crossings.

Real streets have ends, one-way parts and lanes that begin and end, so every street is painted by
itself.
"""

from collections.abc import Collection

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.state.roads import RoadNetwork
from eyas.world.build.millimetres import dot, length, rounded, unit
from eyas.world.maps.imported.crosswalks import HALF, Crosswalk
from eyas.world.maps.imported.plan import Plan
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
_BAR = 0.5

Line = NDArray[np.float64]


def road_paint(network: RoadNetwork, plan: Plan, signalled: Collection[str]) -> RoadPaint:
    """Return the paint of all streets.

    Args:
        network: The streets.
        plan: Their asphalt and crossings.
        signalled: The streets that end at signals.
    """
    every = streets(network)
    ways = {(street.start, street.end) for street in every}
    speeds = {int(edge): network.lane_speed[lane] for lane, edge in enumerate(network.lane_edge)}
    lines: list[Stripe] = []
    for index, street in enumerate(every):
        if len(street.right) < 2 or len(street.left) < 2 or speeds[index] < _SLOWEST:
            continue
        both = (street.end, street.start) in ways
        if shapely.LineString(street.right).length > _SHORTEST:
            lines += _lines(street, both=both)
        if network.edges[index] in signalled:
            lines.append(_stop_line(street))
    zebras = _zebras(plan)
    return RoadPaint(_cut(lines, zebras), [], zebras)


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
    return rounded(exact.product(np.array(points), np.stack([onwards, leftwards])) + origin)


def _stop_line(street: Street) -> Stripe:
    ends = [(-_STOP_BACK, 0.15), (-_STOP_BACK, max(_frame(street)[3] - 0.15, 0.5))]
    return Stripe(_placed(street, ends), _STOP_LINE)


def _zebras(plan: Plan) -> list[list[Stripe]]:
    """Return the bars of all crossings; where two meet at a corner, those of the first."""
    shapely.prepare(plan.roads)
    made: list[list[Stripe]] = []
    free = [_zebra(walk, plan.roads) for walk in plan.crosswalks]
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
    bars = [Stripe(rounded(np.stack([m - HALF * onwards, m + HALF * onwards])), _BAR)
            for m in middles]  # fmt: skip
    return [bar for bar in bars if shapely.covers(roads, bar.area)]
