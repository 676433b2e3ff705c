"""Where pavements are joined by painted crossings."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.pavements import LANES, Walkway
from eyas.engine.state.scene import Scene
from eyas.lanes import exact

_PAVED: Final = 9.0  # How far from the kerb pavements are sought: corners are round [m]

_BEYOND_KERB: Final = 4.0  # The same on imported maps, which tell where each crossing ends [m]

_ASIDES: Final = (0.0, 0.9, -0.9)
"""There, one crosses beside the middle if something stands at the end of it [m]."""

_BESIDE: Final = 1.2  # There, pavements may end so far beside the middle of a crossing [m]

Floats = NDArray[np.float64]
_Joined = tuple[tuple[int, float], tuple[int, float], Floats]
"""Two ways with the places on them [m], and the line between them [m]."""


class Crossing(NamedTuple):
    """From one way on a pavement over a road to another."""

    way: int
    along: float  # Where on the way it begins, from its first corner [m]
    other: int
    other_along: float
    line: Floats  # Where it begins and ends [m], shape (2, 2)
    number: int = 0  # Which of the map's crossings it is: there and back, near the kerb or not
    light: str = ""  # Name of its traffic light in the network; empty: it has none
    to_kerb: float = 0.0  # From its beginning to the kerb [m]


def crossings_of(
    scene: Scene,  # The map
    ways: list[Walkway],  # The ways on its pavements
    obstacles: GroundObstacles,  # What stands in the way, without the roads
    radius: float,  # Distance to obstacles that is kept [m]
) -> list[Crossing]:
    """Return the crossings between ways, in both directions."""
    rings = [way.line for way in ways]
    lanes = [[k for k, way in enumerate(ways) if way.lane == lane] for lane in range(len(LANES))]
    sides = [_Side(own, shapely.STRtree([rings[k] for k in own])) for own in lanes]
    found = []
    for number, one in enumerate(_kerb_to_kerb(scene)):
        for side in sides:
            joined = _free(side, one, obstacles, radius)
            if joined is None:
                continue
            there, back, line = joined
            kerb = [float(exact.hypot(*(a - b))) for a, b in zip(line, one[:2], strict=True)]
            found.append(Crossing(*there, *back, line, number, one.light, kerb[0]))
            found.append(Crossing(*back, *there, line[::-1], number, one.light, kerb[1]))
    return found


class _Side(NamedTuple):
    """The ways at one distance from the kerb."""

    ways: list[int]
    tree: shapely.STRtree


class _Paint(NamedTuple):
    """A crossing, before it is known which pavements it joins."""

    right: Floats
    left: Floats  # Its ends at the kerbs [m], shape (2,)
    light: str  # See `Crossing`
    beyond: float  # How far from the kerbs pavements are sought [m]
    asides: tuple[float, ...]  # How far beside its middle one may cross, the best first [m]


def _free(side: _Side, one: _Paint, obstacles: GroundObstacles, radius: float) -> _Joined | None:
    """Return what a crossing joins, the first way over it that nothing blocks."""
    for aside in one.asides:
        joined = _between(side, one, aside)
        if joined is not None:
            line = np.array([shapely.LineString(joined[2])], object)
            if not obstacles.blocked(line, radius)[0]:
                return joined
    return None


def _between(side: _Side, one: _Paint, aside: float) -> _Joined | None:
    """Return the ways that a crossing joins, the places on them, and the line between [m]."""
    onwards = (one.left - one.right)[::-1] * [1.0, -1.0] / exact.hypot(*(one.left - one.right))
    right, left = one.right + aside * onwards, one.left + aside * onwards
    begin, end = _joint(side, right, left, one.beyond), _joint(side, left, right, one.beyond)
    if begin is None or end is None:
        return None
    return begin[:2], end[:2], np.array([begin[2], end[2]])


def _kerb_to_kerb(scene: Scene) -> list[_Paint]:
    """Return all crossings."""
    footways = scene.footways
    reach, asides = (_BEYOND_KERB, _ASIDES) if footways.told else (_PAVED, (0.0,))
    each = zip(footways.crossings, footways.lights, strict=True)
    return [_Paint(line[0], line[1], light, reach, asides) for line, light in each]


def _joint(
    side: _Side, kerb: Floats, opposite: Floats, beyond: float
) -> tuple[int, float, Floats] | None:
    """Return the way nearest to a kerb on the line from the other kerb, and the place on it."""
    outwards = (kerb - opposite) / exact.hypot(*(kerb - opposite))
    line = shapely.LineString([0.5 * (kerb + opposite), kerb + beyond * outwards])
    best, place = np.inf, None
    reach = _BESIDE if beyond < _PAVED else 0.0
    for k in np.sort(side.tree.query(line, predicate="dwithin", distance=reach)).tolist():
        ring = side.tree.geometries[k]
        met = shapely.get_coordinates(shapely.intersection(ring, line))
        if not len(met):
            met = shapely.get_coordinates(shapely.shortest_line(ring, line))[:1]
        away = exact.product(met - kerb, outwards)
        if away.min() < best:
            best = float(away.min())
            along = float(ring.project(shapely.Point(met[away.argmin()])))
            foot = shapely.get_coordinates(ring.interpolate(along))[0]
            place = side.ways[k], along, foot
    return place
