"""Shores of ponds and lakes: where the water ends, reeds, stones, jetties with boats."""

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.lake.layout import LakeLayout
from eyas.maps.land.outlines import wavy
from eyas.maps.land.relief import Points
from eyas.maps.plants import gardens
from eyas.maps.plants.wild import BED
from eyas.maps.things.jetties import BESIDE, LONG

# order: bytes of plans depend on it, which draw an index of it
SHORE_KINDS = ("reeds 0", "reeds 1", "stones 2", "stones 3")
"""Kinds of what stands and lies along shores."""

_POND, _LAKE = (10.0, 6.0, 8.0), (40.0, 30.0, 24.0)
"""Ponds and lakes: depth of cut corners, the part of it that is kept, and the largest wandering of
the shore [m]."""
_BEDS, _GAPS = (2, 9), (1, 6)  # Lengths of reed beds and of the gaps between them, in pieces
_STONES_EVERY, _STONES_AWAY = 11.0, (0.2, 2.6)
_WITH_JETTY = 0.6  # Share of the waters near roads that have a jetty
_ASHORE = 0.4  # Share of the jetties with another boat on land


def water_in(
    shape: shapely.Polygon,  # The basin [m]
    rng: np.random.Generator,
) -> shapely.Polygon:
    """Return the water in a basin: within its outline, with round corners and an uneven shore."""
    cut, kept, depth = _POND if shape.area < 2e4 else _LAKE
    smooth = shapely.buffer(shapely.buffer(shape, -cut, quad_segs=4), kept, quad_segs=6)
    inside = shapely.buffer(shape, -0.3, join_style="mitre")
    water = shapely.intersection(wavy(smooth, depth, rng), inside)
    return max(shapely.get_parts(water), key=shapely.area)


def shore_life(
    waters: list[shapely.Polygon],  # Ponds and lakes [m]
    near: shapely.Geometry,  # Where they are seen [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return reeds and stones along shores."""
    made: list[Placed] = []
    for water in waters:
        ring = shapely.geometry.polygon.orient(water).exterior
        along, at = [], 0.0
        while at < ring.length:
            count = int(rng.integers(*_BEDS))
            along += [at + BED * k for k in range(count)]
            at += BED * (count + int(rng.integers(*_GAPS)))
        here, ahead = _stations(ring, np.array(along))
        spots = here + rng.uniform(0.2, 1.1, (len(here), 1)) * _left(ahead)
        turns = exact.atan2(ahead[:, 1], ahead[:, 0])
        inside = shapely.contains_xy(near, spots)
        for (x, y), turn in zip(rounded(spots)[inside].tolist(), turns[inside], strict=True):
            kind, size = SHORE_KINDS[int(rng.integers(2))], round(float(rng.uniform(0.8, 1.1)), 3)
            made.append(Placed(kind, x, y, FLOOR_HEIGHT - 0.05, round(float(turn), 3), size))
        count = int(ring.length / _STONES_EVERY)
        here, ahead = _stations(ring, rng.uniform(0.0, ring.length, count))
        spots = here - rng.uniform(*_STONES_AWAY, (count, 1)) * _left(ahead)
        spots = spots[shapely.contains_xy(near, spots)]
        made += gardens.sown(spots, SHORE_KINDS[2:], (0.6, 1.3), FLOOR_HEIGHT - 0.04, rng)
    return made


def boats(
    waters: list[shapely.Polygon],  # Ponds and lakes [m]
    district: LakeLayout,  # Where roads are
    near: shapely.Geometry,  # Where they are seen [m]
    rng: np.random.Generator,
) -> list[Placed]:
    """Return jetties, each with a boat beside it, and boats on land."""
    made: list[Placed] = []
    for water in waters:
        ring = shapely.geometry.polygon.orient(water).exterior
        at = shapely.line_locate_point(ring, shapely.shortest_line(ring, district.roads).centroid)
        at = (at + rng.uniform(-60.0, 60.0)) % ring.length
        wanted, ashore = rng.random() < _WITH_JETTY, rng.random() < _ASHORE
        here, ahead = _stations(ring, np.array([at, (at + 7.0) % ring.length]))
        out = _left(ahead)
        turn = round(float(exact.atan2(out[0, 1], out[0, 0])), 3)
        end = here[0] + LONG * out[0]
        fits = shapely.contains_xy(near, *here[0]) and shapely.contains_xy(water, *end)
        if not (wanted and fits):
            continue
        made.append(Placed.at("jetty", rounded(here[0]), FLOOR_HEIGHT, turn))
        side = BESIDE * float(rng.choice((-1.0, 1.0)))
        place = here[0] + rng.uniform(3.2, 5.0) * out[0] + side * ahead[0]
        way = turn + float(rng.uniform(-0.12, 0.12))
        made.append(_boat(place, FLOOR_HEIGHT - 0.03, way, rng))
        if ashore:
            made.append(_boat(here[1] - 1.6 * out[1], FLOOR_HEIGHT + 0.02, turn + 2.6, rng))
    return made


def _boat(place: Points, z: float, turn: float, rng: np.random.Generator) -> Placed:
    return Placed.at(f"boat {int(rng.integers(3))}", rounded(place), z, round(turn, 3))


def _stations(ring: shapely.Geometry, along: Points) -> tuple[Points, Points]:
    """Return points of a ring, and unit vectors along it there, shape (K, 2) each."""
    here, there = (
        shapely.get_coordinates(shapely.line_interpolate_point(ring, (along + d) % ring.length))
        for d in (-0.7, 0.7)
    )
    ahead = there - here
    return 0.5 * (here + there), ahead / np.maximum(
        np.linalg.norm(ahead, axis=1, keepdims=True), 1e-9
    )


def _left(ahead: Points) -> Points:
    return np.column_stack([-ahead[:, 1], ahead[:, 0]])
