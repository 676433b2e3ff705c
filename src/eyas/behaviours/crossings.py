"""Where pavements are joined by painted crossings."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.behaviours.obstacles import Obstacles
from eyas.behaviours.pavements import LANES, Way
from eyas.state.scene import ObjectClass, Scene
from eyas.world.roads.areas import joints, streets

__all__ = ["Crossing", "crossings_of"]

_BEYOND: Final = 3.0
"""From the stop line to the line on which one crosses: within the bars of all maps [m]."""

_PAVED: Final = 9.0
"""How far from the kerb pavements are sought: corners are round [m]."""

_BEYOND_KERB: Final = 4.0
"""The same on imported maps, which tell where each crossing ends [m]."""

_ASIDES: Final = (0.0, 0.9, -0.9)
"""There, one crosses beside the middle if something stands at the end of it [m]."""

_BESIDE: Final = 1.2
"""There, pavements may end so far beside the middle of a crossing [m]."""

_STEP: Final = 0.2
"""Distance between the points at which paint is sought [m]."""

_PAINTED: Final = 0.3
"""Least share of them that is painted: bars cover half of a crossing."""

Floats = NDArray[np.float64]


class Crossing(NamedTuple):
    """From one way on a pavement over a road to another."""

    way: int
    along: float
    """Where on the way it begins, from its first corner [m]."""
    other: int
    other_along: float
    line: Floats
    """Where it begins and ends [m], shape (2, 2)."""
    number: int = 0
    """Which of the map's crossings it is: there and back, near the kerb or not."""
    light: str = ""
    """Name of its traffic light in the network; empty: it has none."""


def crossings_of(
    scene: Scene, ways: list[Way], obstacles: Obstacles, radius: float
) -> list[Crossing]:
    """Return the crossings between ways, in both directions.

    Args:
        scene: The map.
        ways: The ways on its pavements.
        obstacles: What stands in the way, without the roads.
        radius: Distance to obstacles that is kept [m].
    """
    rings = [way.line for way in ways]
    lanes = [[k for k, way in enumerate(ways) if way.lane == lane] for lane in range(len(LANES))]
    found = []
    for number, one in enumerate(_kerb_to_kerb(scene)):
        for own in lanes:
            tried = (_between(rings, own, one, aside) for aside in one.asides)
            free = (
                joined
                for joined in tried
                if joined is not None
                and not obstacles.blocked(np.array([shapely.LineString(joined[2])]), radius)[0]
            )
            for (way, along), (other, other_along), line in list(free)[:1]:
                there = Crossing(way, along, other, other_along, line, number, one.light)
                back = Crossing(other, other_along, way, along, line[::-1], number, one.light)
                found += [there, back]
    return found


class _Paint(NamedTuple):
    """A crossing, before it is known which pavements it joins."""

    right: Floats
    left: Floats
    """Its ends at the kerbs [m], shape (2,)."""
    light: str = ""
    """See `Crossing`."""
    beyond: float = _PAVED
    """How far from the kerbs pavements are sought [m]."""
    asides: tuple[float, ...] = (0.0,)
    """How far beside its middle one may cross, the best first [m]."""


def _between(
    rings: list[shapely.LineString], own: list[int], one: _Paint, aside: float
) -> tuple[tuple[int, float], tuple[int, float], Floats] | None:
    """Return the ways that a crossing joins, the places on them, and the line between [m]."""
    onwards = (one.left - one.right)[::-1] * [1.0, -1.0] / np.hypot(*(one.left - one.right))
    right, left = one.right + aside * onwards, one.left + aside * onwards
    begin, end = (_joint(rings, own, a, b, one.beyond) for a, b in ((right, left), (left, right)))
    if begin is None or end is None:
        return None
    feet = [rings[way].interpolate(along) for way, along in (begin, end)]
    return begin, end, shapely.get_coordinates(feet)


def _kerb_to_kerb(scene: Scene) -> list[_Paint]:
    """Return all crossings."""
    footways = scene.footways
    if footways.told:
        each = zip(footways.crossings, footways.lights, strict=True)
        return [_Paint(line[0], line[1], light, _BEYOND_KERB, _ASIDES) for line, light in each]
    return [_Paint(right, left) for right, left in _painted(scene, _across(scene))]


def _across(scene: Scene) -> list[tuple[Floats, Floats]]:
    """Return the right and the left kerb beyond each stop line, where it might be crossed."""
    network, made = scene.network, []
    meeting, every = joints(network), streets(network)
    ways = {(street.start, street.end) for street in every}
    for street in every:
        if meeting[street.end] < 3 or len(street.right) < 2:
            continue
        onwards = street.right[-1] - street.right[-2]
        onwards /= max(float(np.hypot(*onwards)), 1e-9)
        leftwards = np.array([-onwards[1], onwards[0]])
        width = float((street.left[-1] - street.right[-1]) @ leftwards)
        right = street.right[-1] + _BEYOND * onwards
        sides = 2.0 if (street.end, street.start) in ways else 1.0
        made.append((right, right + sides * width * leftwards))
    return made


def _painted(scene: Scene, across: list[tuple[Floats, Floats]]) -> list[tuple[Floats, Floats]]:
    """Return the lines on which a crossing is painted."""
    kinds = scene.object_class[scene.static_object]
    corners = scene.static.triangles[kinds == ObjectClass.MARKING]
    paint = scene.static.positions[corners][..., :2].astype(np.float64)
    tree = shapely.STRtree(shapely.polygons(paint) if len(paint) else [])
    kept = []
    for right, left in across:
        count = max(int(np.hypot(*(left - right)) / _STEP), 1)
        share = (np.arange(count) + 0.5)[:, None] / count
        points = shapely.points(right + share * (left - right))
        on_paint = np.unique(tree.query(points, predicate="intersects")[0])
        if len(on_paint) >= _PAINTED * count:
            kept.append((right, left))
    return kept


def _joint(
    rings: list[shapely.LineString], own: list[int], kerb: Floats, opposite: Floats, beyond: float
) -> tuple[int, float] | None:
    """Return the way nearest to a kerb on the line from the other kerb, and the place on it."""
    outwards = (kerb - opposite) / np.hypot(*(kerb - opposite))
    line = shapely.LineString([0.5 * (kerb + opposite), kerb + beyond * outwards])
    best, place = np.inf, None
    for k in own:
        met = shapely.get_coordinates(rings[k].intersection(line))
        if beyond < _PAVED and not len(met) and shapely.dwithin(rings[k], line, _BESIDE):
            met = shapely.get_coordinates(shapely.shortest_line(rings[k], line))[:1]
        if len(met):
            away = (met - kerb) @ outwards
            if away.min() < best:
                best = float(away.min())
                place = k, float(rings[k].project(shapely.Point(met[away.argmin()])))
    return place
