"""Scenery of the village: trodden paths, grass and stones, what stands about the houses."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.cottages import Cottage
from eyas.maps.land.relief import Points, Relief, heights_of
from eyas.maps.plants import gardens
from eyas.maps.village.layout import VillageLayout

# order: bytes of plans depend on it, which draw an index of it
GRASS_KINDS = ("green tuft 0", "green tuft 1", "dry tuft 0", "dry tuft 1")
STONE_KINDS = ("stones 2", "stones 3", "boulder 2", "boulder 3")

_PATHS, _STEPS, _STEP = 20, (6, 16), 6.0
"""Number of paths, of their pieces, and the length of a piece [m]."""
_WIDTHS = (0.55, 0.8)  # Half the width of a path [m]
_ROUND_LAKE = 7.5  # Distance of the path round the lake from the water [m]
_TUFTS, _BESIDE = (5.0, 0.014), (1.8, 16.0)
"""Least distance between groups of tufts [m], and number of attempts on a square metre; their
least and largest distance from a road [m]."""
_STONES, _STONES_BESIDE, _STONES_REACH = (19.0, 0.004), 6.0, 110.0
"""Least distance and attempts of stones; their least and largest distance from a road [m]."""


def trodden(
    valley: VillageLayout, lawn: shapely.Geometry, rng: np.random.Generator
) -> list[shapely.Polygon]:
    """Return the paths on a lawn, in plan view [m]."""
    rings = [ring for part in shapely.get_parts(valley.roads) for ring in _rings(part)]
    sizes = np.array([round(float(ring.length), 3) for ring in rings])
    made = []
    for _ in range(_PATHS):
        ring = rings[int(rng.choice(len(rings), p=sizes / sizes.sum()))]
        start = float(rng.uniform(0.0, ring.length))
        line = _wandering(ring, start, rng)
        made.append(shapely.buffer(line, rng.uniform(*_WIDTHS), quad_segs=3))
    around = shapely.boundary(shapely.buffer(valley.lake, _ROUND_LAKE, quad_segs=4))
    made.append(shapely.buffer(around, 0.7, quad_segs=2))
    kept = shapely.intersection(shapely.union_all(made), lawn)
    return [part for part in shapely.get_parts(kept) if part.area > 8.0]


def _rings(part: shapely.Polygon) -> list[shapely.Geometry]:
    part = shapely.geometry.polygon.orient(part)
    return [part.exterior, *part.interiors]


def _wandering(
    ring: shapely.Geometry, start: float, rng: np.random.Generator
) -> shapely.LineString:
    """Return a line that leaves a ring of roads to the right and bends here and there."""
    here, there = (
        shapely.get_coordinates(ring.interpolate((start + d) % ring.length))[0] for d in (0.0, 0.5)
    )
    turn = exact.atan2(there[1] - here[1], there[0] - here[0]) - np.pi / 2
    turn += rng.uniform(-0.6, 0.6)
    count = int(rng.integers(*_STEPS))
    turns = turn + np.cumsum(rng.uniform(-0.28, 0.28, count))
    steps = _STEP * np.column_stack([exact.cos(turns), exact.sin(turns)])
    points = rounded(np.concatenate([[here], here + np.cumsum(steps, axis=0)]))
    return shapely.LineString(points)


def grown(
    valley: VillageLayout,  # Where roads are
    ground: Relief,
    taken: shapely.Geometry,  # Where nothing grows: paving, paths, water [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return tufts beside the roads, and stones in the meadows and on the feet of hills."""
    least, most = (shapely.buffer(valley.roads, far, quad_segs=3) for far in _BESIDE)
    spots = gardens.scattered(shapely.difference(most, shapely.union(least, taken)), *_TUFTS, rng)
    made = gardens.sown(spots, GRASS_KINDS, (0.7, 1.2), _feet(ground, spots, 0.03), rng)
    least = shapely.buffer(valley.roads, _STONES_BESIDE, quad_segs=3)
    most = shapely.buffer(valley.roads, _STONES_REACH, quad_segs=2)
    room = shapely.difference(most, shapely.union(least, taken))
    spots = gardens.scattered(room, *_STONES, rng)
    steep = heights_of(ground, spots) > 1.0
    for some, kinds in ((spots[steep], STONE_KINDS), (spots[~steep][::3], STONE_KINDS[:2])):
        made += gardens.sown(some, kinds, (0.6, 1.3), _feet(ground, some, 0.12), rng)
    return made


def _feet(ground: Relief, spots: Points, sunk: float) -> Points:
    """Return z of the ground at places, less how deep things stand in it [m]."""
    return np.asarray(heights_of(ground, spots) + FLOOR_HEIGHT - sunk, np.float64)


_GARDEN = ("trampoline", "washing line", "garden pool", "logs", "cafe table 1", "cafe table 2")
_REACH = 17.0  # Largest distance of these from a wall [m]
_ROOM = 3.2  # Room that each of them needs [m]
_YARD_APART, _YARD_DENSITY = 7.0, 0.02
"""Least distance between two of them [m], and number of attempts on a square metre."""
_BESIDE_PATH = 2.6  # Distance from the middle of the path to a house to what stands beside it [m]
_FROM_DOOR = 12.5  # Distance from the middle of a house to its bins and its bicycles [m]


def yard_things(
    cottages: Sequence[Cottage],
    roads: shapely.Geometry,  # Asphalt [m]
    free: shapely.Geometry,  # Where nothing else stands [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return what stands about the houses."""
    walls = shapely.union_all([shapely.Polygon(house.outline) for house in cottages])
    made = []
    room = shapely.intersection(shapely.buffer(free, -_ROOM), shapely.buffer(walls, _REACH))
    room = shapely.difference(room, shapely.buffer(roads, _ROOM + 3.0))
    for x, y in rounded(gardens.scattered(room, _YARD_APART, _YARD_DENSITY, rng)).tolist():
        kind = _GARDEN[int(rng.integers(len(_GARDEN)))]
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, float(rng.uniform(0.0, 2.0 * np.pi))))
    shapely.prepare(free)
    for house in cottages:
        front = np.array([-exact.sin(house.turn), exact.cos(house.turn)])
        aside = np.array([front[1], -front[0]]) * (1.0 if rng.random() < 0.5 else -1.0)
        gap = float(shapely.distance(roads, shapely.Polygon(house.outline)))
        spots = (
            (f"wheeled bins {int(rng.integers(2))}", _FROM_DOOR, _BESIDE_PATH),
            ("bicycle rack", _FROM_DOOR, -_BESIDE_PATH - 1.2),
            ("letter box", 10.0 + gap - 2.8, -_BESIDE_PATH),
        )
        for kind, ahead, beside in spots:
            place = rounded(house.place + ahead * front + beside * aside)
            away = float(shapely.distance(roads, shapely.Point(place)))
            if away > 2.6 and shapely.contains_xy(free, *place):
                made.append(Placed.at(kind, place, FLOOR_HEIGHT, house.turn))
    return made
