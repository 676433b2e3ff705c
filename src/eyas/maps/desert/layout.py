"""Plan of the desert: the position of everything in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import length, rounded, unit
from eyas.engine.world.roads.areas import Street, blocks, road_area, streets
from eyas.lanes import exact
from eyas.maps.buildings.cottages import SIDE, Cottage
from eyas.maps.land.mounds import Mound, place_inside, place_ring, sizes
from eyas.maps.land.outlines import blob

FLOOR = (982.0, 998.0)  # Extent of the floor [m]

HALF = 710.0  # Half the side of the square that the dunes fill [m]

EXTENT = shapely.box(-HALF, -HALF, HALF, HALF)  # Extent of the dunes [m]

_INSIDE, _INSIDE_RADII = 26, (57.0, 84.0, 147.0)
_RING, _RING_RADII = 24, (111.0, 153.0, 192.0)
"""Numbers of dunes, and their smallest, median and largest radius [m]."""
_STEEP, _RING_STEEP = (0.46, 0.60), (0.42, 0.66)
"""Least and largest height of a dune, as a share of its radius."""
_KERB_TO_FOOT = 6.5
_RING_GAPS = (8.0, 60.0)
_WIND = math.radians(-35.0)  # Direction in which the wind blows, counter-clockwise from east [rad]
_LEAN = (0.22, 0.36)
"""From the middle of a dune to its summit, to leeward, as a share of its radius."""
_DRIFTS = 11
_DRIFT = (15.0, 32.0)  # Extent of a drift along and across the road [m]
_ASKEW = math.radians(40.0)  # Most by which a drift is turned from the line across the road [rad]
_DRIFT_APART = 95.0
_TONGUE_EVERY, _TONGUES = 24.0, 0.6
"""From one place with sand on the kerb to the next [m], and share of the places that have it."""
_HOUSES = 7
_SETBACKS = (4.6, 10.5)

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Drift:
    """Sand that the wind has blown over a road, in plan view."""

    area: shapely.Polygon  # Area where sand hides the road [m]
    fringe: shapely.Polygon  # Area with at least thin sand, `area` included [m]


@dataclass(frozen=True, slots=True)
class DesertLayout:
    """Positions in plan view."""

    roads: shapely.Geometry  # Asphalt [m]
    blocks: list[shapely.Polygon]  # Ground between roads [m]
    drifts: list[Drift]  # Sand on the roads
    tongues: list[shapely.Polygon]  # Sand that reaches over the kerbs [m]
    houses: list[Cottage]  # Houses
    dunes: list[Mound]  # Dunes between the roads, then those of the ring

    @property
    def walls(self) -> shapely.Geometry:
        """Footprints of the houses [m]."""
        return shapely.union_all([shapely.Polygon(house.outline) for house in self.houses])


def lay_out(network: RoadNetwork, seed: int) -> DesertLayout:
    """Return the plan of a desert."""
    roads = road_area(network)
    closed, _ = blocks(roads, EXTENT)
    ways = [way for way in streets(network) if way.start < way.end]
    drifts = _drifts(ways, stream(seed, "desert drifts"))
    houses = _houses(ways, roads, drifts, stream(seed, "desert houses"))
    walls = shapely.union_all([shapely.Polygon(house.outline) for house in houses])
    dunes = _dunes(roads, closed, walls, stream(seed, "desert dunes"))
    tongues = _tongues(roads, stream(seed, "desert tongues"))
    return DesertLayout(roads, closed, drifts, tongues, houses, dunes)


def _tongues(roads: shapely.Geometry, rng: np.random.Generator) -> list[shapely.Polygon]:
    """Return sand along the kerbs, which hides the straight edge of the road here and there."""
    made = []
    for ring in shapely.get_parts(shapely.boundary(roads)):
        for at in np.arange(0.0, float(ring.length), _TONGUE_EVERY) + rng.uniform(0.0, 20.0):
            here, there = (shapely.get_coordinates(ring.interpolate(s))[0] for s in (at, at + 1.0))
            half = (rng.uniform(5.0, 15.0), rng.uniform(0.3, 1.1))
            if rng.random() < _TONGUES and length(there - here) > 0.1:
                onwards = unit(there - here)
                turn = exact.atan2(onwards[1], onwards[0])
                made.append(blob(here, half, turn, rng, corners=18, full=1.0))
    return made


def _drifts(ways: Sequence[Street], rng: np.random.Generator) -> list[Drift]:
    """Return drifts all over the roads, at a distance from each other and from junctions."""
    lines = [shapely.LineString(way.left) for way in ways]
    total = sum(round(line.length, 3) for line in lines)
    made: list[Drift] = []
    places: list[Points] = []
    while len(made) < _DRIFTS:
        at = float(rng.uniform(0.0, total))
        for line in lines:
            if at < line.length:
                break
            at -= round(line.length, 3)
        if not 28.0 < at < line.length - 28.0:
            continue
        here, there = (shapely.get_coordinates(line.interpolate(s))[0] for s in (at, at + 0.5))
        if min((length(here - other) for other in places), default=1e9) < _DRIFT_APART:
            continue
        places.append(here)
        onwards = unit(there - here)
        turn = exact.atan2(onwards[1], onwards[0]) + float(rng.uniform(-_ASKEW, _ASKEW))
        half = (_DRIFT[0] / 2 * rng.uniform(0.9, 1.1), _DRIFT[1] / 2 * rng.uniform(0.9, 1.1))
        area = blob(here, half, turn, rng)
        fringe = blob(here, (half[0] + 3.2, half[1] + 2.0), turn, rng)
        made.append(Drift(area, shapely.union(area, fringe)))
    return made


def _houses(
    ways: Sequence[Street],
    roads: shapely.Geometry,
    drifts: Sequence[Drift],
    rng: np.random.Generator,
) -> list[Cottage]:
    """Return houses, alone or in twos, beside the roads."""
    free = shapely.union_all([shapely.buffer(roads, 3.9), *(drift.fringe for drift in drifts)])
    shapely.prepare(free)
    made: list[Cottage] = []
    shapes: list[shapely.Polygon] = []
    while len(made) < _HOUSES:
        way = ways[int(rng.integers(len(ways)))]
        line = shapely.LineString(way.left)
        first, side = rng.uniform(25.0, line.length - 60.0), float(rng.choice((-1.0, 1.0)))
        for at in (first, first + 29.0)[: int(rng.integers(1, 3))]:
            here, there = (shapely.get_coordinates(line.interpolate(s))[0] for s in (at, at + 0.5))
            onwards = unit(there - here)
            right = side * np.array([onwards[1], -onwards[0]])
            away = 8.0 + rng.uniform(*_SETBACKS) + SIDE / 2
            turn = exact.atan2(-right[1], -right[0]) - math.pi / 2
            house = Cottage(rounded(here + away * right), round(turn, 4), 3, int(rng.integers(3)))
            shape = shapely.Polygon(house.outline)
            near = any(shapely.distance(shape, other) < 6.0 for other in shapes)
            if len(made) < _HOUSES and not near and not shapely.intersects(free, shape):
                made.append(house)
                shapes.append(shape)
    return made


def _dunes(
    roads: shapely.Geometry,
    closed: Sequence[shapely.Polygon],
    walls: shapely.Geometry,
    rng: np.random.Generator,
) -> list[Mound]:
    """Return the dunes, which lean to leeward."""
    room = shapely.difference(
        shapely.union_all([shapely.buffer(block, -_KERB_TO_FOOT) for block in closed]),
        shapely.buffer(walls, 7.0),
    )
    made = place_inside(sizes(_INSIDE, _INSIDE_RADII, rng).tolist(), _STEEP, room, rng)
    filled = shapely.Polygon(shapely.get_exterior_ring(shapely.get_parts(roads)[0]))
    around = shapely.union(filled, shapely.buffer(walls, 4.0))
    ring = place_ring(sizes(_RING, _RING_RADII, rng).tolist(), _RING_GAPS, _RING_STEEP, around, rng)
    leaning = []
    for dune in (*made, *ring):
        far, wind = rng.uniform(*_LEAN), _WIND + rng.uniform(-0.3, 0.3)
        lean = np.round(far * np.array([exact.cos(wind), exact.sin(wind)]), 4).tolist()
        leaning.append(
            replace(
                dune,
                phases=tuple(rng.uniform(0, 2 * math.pi, 3).tolist()),
                waviness=0.1,
                lean=(lean[0], lean[1]),
            )
        )
    return leaning
