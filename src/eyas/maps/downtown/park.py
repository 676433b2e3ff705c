"""The park north of the streets: a pond, a fountain, paths, meadows and many small trees."""

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded, snapped
from eyas.engine.world.roads.areas import polygons_of
from eyas.lanes import exact
from eyas.maps.buildings.lots import largest, turned
from eyas.maps.downtown.roads import Grid
from eyas.maps.plants import gardens

__all__ = ["Park", "make_park"]

_DEPTH = 345.0  # From the street along its south side to its far end [m]
_WALK = 4.2  # Width of the pavement along its edge [m]
_POND_AREA = 15_325.0  # As in the original [m^2]
_POND_LINE = ((-72.0, -34.0), (-50.0, 26.0), (4.0, 40.0), (46.0, 10.0), (88.0, 44.0))
"""Backbone of the pond about its middle, in the frame of the grid [m]."""
_POND_REACH = 34.0
_FOUNTAIN = 11.3  # Radius of the basin of the fountain: 401 m^2, as in the original [m]
_SMALL_PONDS = ((0.10, 0.72, 9.0, 6.0), (0.82, 0.74, 12.0, 7.0), (0.60, 0.90, 8.0, 8.0), (0.30, 0.92, 10.0, 5.0))  # noqa: E501  # fmt: skip
"""Position as a share of width and depth, and half axes [m]."""
_PATH = 3.6
_TREES = 243
_GROUPS = 34  # Number of groups in which the trees of the park stand

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Park:
    """The park in plan view, world frame [m]."""

    ground: shapely.Polygon  # All of it, from the kerbs on
    walk: shapely.Geometry  # Raised pavement along the kerbs
    water: shapely.Geometry  # Ponds, and the basin of the fountain
    rim: shapely.Geometry  # Stone around the water
    paths: shapely.Geometry  # Paths and the square around the fountain
    fountain: tuple[float, float]  # Middle of the fountain
    trees: Points  # Trunks, shape (K, 2)
    shrubs: Points  # Middle of each group of shrubs and its direction [rad], shape (K, 3)
    benches: Points  # Position of each bench and direction that it faces [rad], shape (K, 3)


def make_park(
    grid: Grid, roads: shapely.Geometry, floor: shapely.Polygon, rng: np.random.Generator
) -> Park:
    """Return the park of a city.

    Args:
        grid: The grid of its streets.
        roads: Asphalt [m].
        floor: The whole floor [m].
        rng: Random numbers of the park.
    """
    west, east, south = grid.avenues[0] - 8.0, grid.avenues[4], grid.streets[7]
    whole = turned(shapely.box(west, south, east, south + _DEPTH), grid.turn)
    ground = largest(shapely.difference(shapely.intersection(whole, floor), roads))
    walk = shapely.intersection(ground, shapely.buffer(roads, _WALK, join_style="mitre"))
    inner = shapely.difference(ground, walk)
    middle = np.array([west + 0.47 * (east - west), south + 205.0])
    pond = _pond(grid, middle)
    fountain = grid.world(np.array([[east - 118.0, south + 62.0]]))[0]
    basin = snapped(shapely.buffer(shapely.Point(fountain), _FOUNTAIN, quad_segs=12))
    small = [
        _oval(grid, west + x * (east - west), south + y * _DEPTH, a, b)
        for x, y, a, b in _SMALL_PONDS
    ]
    water = shapely.union_all([pond, basin, *small])
    rim = snapped(shapely.difference(shapely.buffer(water, 0.9, quad_segs=4), water))
    wet = shapely.union(water, rim)
    square = snapped(shapely.buffer(shapely.Point(fountain), _FOUNTAIN + 9.0, quad_segs=12))
    trails = _trails(grid, (west, south, east), middle, pond)
    paths = shapely.intersection(shapely.union(trails, square), inner)
    paths = snapped(shapely.difference(paths, wet))
    trees = _trees(shapely.difference(inner, shapely.union(wet, paths)), rng)
    return Park(
        ground=ground,
        walk=walk,
        water=water,
        rim=rim,
        paths=paths,
        fountain=(float(fountain[0]), float(fountain[1])),
        trees=trees,
        shrubs=_shrubs(shapely.difference(inner, shapely.union(wet, paths)), wet, rng),
        benches=_benches(trails, shapely.union(wet, paths), inner),
    )


def _pond(grid: Grid, middle: Points) -> shapely.Polygon:
    """Return the pond: winding, and exactly as large as the original's."""
    line = shapely.LineString(np.array(_POND_LINE) + middle)
    shape = shapely.buffer(line, _POND_REACH, quad_segs=6)
    island = shapely.buffer(shapely.Point(middle + np.array([-26.0, 8.0])), 9.0, quad_segs=4)
    bays = [
        shapely.buffer(shapely.Point(middle + at), 13.0) for at in ([30.0, -26.0], [-6.0, 74.0])
    ]
    shape = shapely.difference(shape, shapely.union_all([island, *bays]))
    shape = shapely.buffer(shapely.buffer(shape, -6.0), 6.0, quad_segs=4)
    factor = math.sqrt(_POND_AREA / shape.area)
    shape = shapely.transform(shape, lambda xy: rounded(middle + factor * (xy - middle)))
    return largest(turned(shapely.simplify(shape, 0.3), grid.turn))


def _oval(grid: Grid, u: float, v: float, a: float, b: float) -> shapely.Polygon:
    angle = np.linspace(0.0, 2 * np.pi, 28, endpoint=False)
    ring = np.column_stack([u + a * exact.cos(angle), v + b * exact.sin(angle)])
    return shapely.Polygon(grid.world(ring))


def _trails(
    grid: Grid, corner: tuple[float, float, float], middle: Points, pond: shapely.Polygon
) -> shapely.Geometry:
    """Return a loop around the pond, and winding ways from it to the edges of the park."""
    west, south, east = corner
    loop = shapely.buffer(pond, 7.0, quad_segs=6).exterior
    ends = [
        (west + 20.0, south), (west + 190.0, south), (middle[0] + 90.0, south),
        (east - 40.0, south), (east, south + 120.0), (east, south + 300.0), (west, south + 160.0),
        (west + 90.0, south + _DEPTH), (middle[0] + 160.0, south + _DEPTH),
    ]  # fmt: skip
    lines: list[shapely.Geometry] = [shapely.LineString(loop.coords)]
    for k, end in enumerate(ends):
        straight = np.array(end) - middle
        aside = np.array([-straight[1], straight[0]]) * (0.16 if k % 2 else -0.16)
        t = np.linspace(0.0, 1.0, 15)[:, None]
        curve = middle + t * straight + np.round(exact.sin(np.pi * t), 6) * aside
        lines.append(shapely.LineString(grid.world(curve)))
    ways = shapely.union_all([shapely.buffer(line, _PATH / 2, quad_segs=3) for line in lines])
    return snapped(shapely.simplify(ways, 0.05))


def _trees(room: shapely.Geometry, rng: np.random.Generator) -> Points:
    """Return trunks in groups and alone, at least 4 m apart."""
    free = shapely.buffer(room, -2.2)
    shapely.prepare(free)
    centres = gardens.scattered(free, 26.0, 0.004, rng)
    centres = centres[rng.permutation(len(centres))[:_GROUPS]]
    grouped = gardens.clustered(np.round(centres, 3), 9.0, (5, 11), free, rng)
    alone = gardens.scattered(free, 13.0, 0.012, rng)
    # Whole millimetres, as normal numbers differ from processor to processor in their last bits.
    every = rounded(np.concatenate([grouped, rng.permutation(alone)]))
    chosen: list[Points] = []
    for place in every:
        if len(chosen) < _TREES and all(np.abs(place - c).max() > 3.2 for c in chosen):
            chosen.append(place)
    return np.array(chosen).reshape(-1, 2)


def _shrubs(room: shapely.Geometry, wet: shapely.Geometry, rng: np.random.Generator) -> Points:
    """Return groups of shrubs: thickets on the meadows, and some along the water."""
    free = shapely.buffer(room, -2.4)
    shore = shapely.intersection(free, shapely.buffer(wet, 5.0))
    shapely.prepare(free)
    thickets = gardens.clustered(gardens.scattered(free, 40.0, 0.002, rng), 4.5, (2, 6), free, rng)
    places = np.concatenate([thickets, gardens.scattered(shore, 7.0, 0.012, rng)])
    turns = np.round(rng.uniform(0.0, np.pi, (len(places), 1)), 6)
    return np.column_stack([rounded(places), turns])


def _benches(trails: shapely.Geometry, taken: shapely.Geometry, inner: shapely.Geometry) -> Points:
    """Return benches beside the paths, which face them."""
    made = []
    shapely.prepare(taken)
    for part in polygons_of(trails):
        for ring in (part.exterior, *part.interiors):
            line = shapely.LineString(ring.coords)
            for at in np.arange(12.0, line.length - 1.0, 58.0):
                here, there = (
                    shapely.get_coordinates(line.interpolate(s))[0] for s in (at, at + 0.2)
                )
                onwards = (there - here) / exact.hypot(*(there - here))
                # The path lies on the left or right of its edge; a bench on the other side.
                for side in (1.0, -1.0):
                    out = side * np.array([-onwards[1], onwards[0]])
                    place = rounded(here + 0.75 * out)
                    if not taken.intersects(shapely.Point(place).buffer(0.6)) and inner.contains(
                        shapely.Point(place)
                    ):
                        made.append([*place, round(exact.atan2(-out[1], -out[0]), 6)])
    return np.array(made).reshape(-1, 3)
