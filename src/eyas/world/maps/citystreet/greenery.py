"""Plants between the buildings of the street city, and the cars in its car parks."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.placed import Placed
from eyas.world.maps.citystreet.layout import EXTENT, Layout
from eyas.world.plants import gardens
from eyas.world.roads import overpass
from eyas.world.street.parked_cars import CARS

__all__ = ["greenery", "parked"]

_GARDEN_TREES = ((4.5, 8.5), 11.0, 0.0022)
"""Heights and least distance [m], and number of attempts on a square metre."""
_MEADOW_TREES = ((4.0, 11.0), 70.0, 0.0004)
"""The same for the groups of trees beyond the outer streets."""
_FROM_WALL = 4.5
_FROM_STREET = 14.0
"""Least distance of the trees beyond the outer streets from a street [m]."""
_OCCUPIED = 0.62
"""Share of the bays with a car."""
_ISLAND_EVERY = 9
"""Bays from one planted island to the next."""


def greenery(
    plan: Layout, taken: shapely.Geometry, trees: Sequence[str], rng: np.random.Generator
) -> list[Placed]:
    """Return borders along walls, hedges around car parks, and small trees.

    Args:
        plan: The layout of the city.
        taken: Area that is paved or where something stands [m].
        trees: Kinds of trees, 1 m high.
        rng: Random numbers of the gardens.
    """
    deck = shapely.buffer(overpass.deck_area(plan.deck), 2.0)
    inside = shapely.difference(shapely.union_all(plan.blocks), shapely.union(taken, deck))
    shapely.prepare(inside)
    made = gardens.borders(plan.footprints, inside, FLOOR_HEIGHT, rng)
    built = shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])
    for park in plan.car_parks:
        ring = shapely.get_coordinates(shapely.buffer(park.area, 1.2, join_style="mitre"))
        for side in pairwise(ring):
            made += gardens.row(("hedge",), np.array(side), inside, FLOOR_HEIGHT, rng)
    heights, apart, density = _GARDEN_TREES
    room = shapely.difference(shapely.buffer(inside, -1.6), shapely.buffer(built, _FROM_WALL))
    spots = gardens.scattered(room, apart, density, rng)
    made += gardens.small_trees(spots, heights, FLOOR_HEIGHT, trees, rng)
    heights, apart, density = _MEADOW_TREES
    streets = shapely.buffer(shapely.union_all([plan.roads, plan.access, deck]), _FROM_STREET)
    room = shapely.difference(
        shapely.buffer(EXTENT, -8.0), shapely.union_all([streets, *plan.blocks])
    )
    groups = gardens.scattered(room, apart, density, rng)
    spots = gardens.clustered(groups, 7.0, (1, 6), room, rng)
    return made + gardens.small_trees(spots, heights, FLOOR_HEIGHT, trees, rng)


def parked(plan: Layout, trees: Sequence[str], rng: np.random.Generator) -> list[Placed]:
    """Return what is in the bays of the car parks: islands, small trees and cars.

    Args:
        plan: The layout of the city.
        trees: Kinds of trees, 1 m high.
        rng: Random numbers of the car parks.
    """
    made = []
    for park in plan.car_parks:
        for index, (x, y, turn) in enumerate(park.bays.tolist()):
            if index % _ISLAND_EVERY == _ISLAND_EVERY // 2:
                made.append(Placed("island", x, y, 0.0, turn))
                made += gardens.small_trees(np.array([[x, y]]), (4.0, 6.0), 0.1, trees, rng)
            elif rng.random() < _OCCUPIED:
                ahead = np.pi * float(rng.random() < 0.35)
                east, north = x + exact.normal(rng, 0, 0.06), y + exact.normal(rng, 0, 0.06)
                way = turn + ahead + exact.normal(rng, 0, 0.015)
                car = CARS[int(rng.integers(len(CARS)))]
                made.append(Placed(car, east, north, 0.0, way, rng.uniform(0.94, 1.04)))
    return made
