"""Plants between the buildings of the street city, and the cars in its car parks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.scene_builder import Prototype, SceneBuilder
from eyas.world.maps.citystreet.plan import EXTENT, Plan
from eyas.world.plants import gardens
from eyas.world.roads import overpass
from eyas.world.street.parked_cars import VARIANTS, add_car, parked_car

__all__ = ["Flora", "add_greenery", "add_parked"]

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


@dataclass(frozen=True, slots=True)
class Flora:
    """Prototypes of the city's plants."""

    trees: Sequence[Prototype]
    """Trees 1 m high."""
    plants: Mapping[str, Prototype]
    """Other plants, by the names of `plant_makers`."""


def add_greenery(
    builder: SceneBuilder,
    plan: Plan,
    taken: shapely.Geometry,
    flora: Flora,
    rng: np.random.Generator,
) -> None:
    """Plant borders along walls, hedges around car parks, and small trees.

    Args:
        builder: The builder to add to.
        plan: The plan of the city.
        taken: Area that is paved or where something stands [m].
        flora: The plants.
        rng: Random numbers of the gardens.
    """
    deck = shapely.buffer(overpass.deck_area(plan.deck), 2.0)
    inside = shapely.difference(shapely.union_all(plan.blocks), shapely.union(taken, deck))
    shapely.prepare(inside)
    gardens.add_borders(builder, plan.footprints, inside, FLOOR_HEIGHT, flora.plants, rng)
    built = shapely.union_all([shapely.Polygon(corners) for corners in plan.footprints])
    hedge = [flora.plants["hedge"]]
    for park in plan.car_parks:
        ring = shapely.get_coordinates(shapely.buffer(park.area, 1.2, join_style="mitre"))
        for side in pairwise(ring):
            gardens.add_row(builder, hedge, np.array(side), inside, FLOOR_HEIGHT, rng)
    heights, apart, density = _GARDEN_TREES
    room = shapely.difference(shapely.buffer(inside, -1.6), shapely.buffer(built, _FROM_WALL))
    spots = gardens.scattered(room, apart, density, rng)
    gardens.add_small_trees(builder, spots, heights, FLOOR_HEIGHT, flora.trees, rng)
    heights, apart, density = _MEADOW_TREES
    streets = shapely.buffer(shapely.union_all([plan.roads, plan.access, deck]), _FROM_STREET)
    room = shapely.difference(
        shapely.buffer(EXTENT, -8.0), shapely.union_all([streets, *plan.blocks])
    )
    groups = gardens.scattered(room, apart, density, rng)
    spots = gardens.clustered(groups, 7.0, (1, 6), room, rng)
    gardens.add_small_trees(builder, spots, heights, FLOOR_HEIGHT, flora.trees, rng)


def add_parked(builder: SceneBuilder, plan: Plan, flora: Flora, rng: np.random.Generator) -> None:
    """Fill bays of the car parks with islands, small trees and cars.

    Args:
        builder: The builder to add to.
        plan: The plan of the city.
        flora: The plants.
        rng: Random numbers of the car parks.
    """
    cars = [builder.prototype(f"parked car {k}", partial(parked_car, k)) for k in range(VARIANTS)]
    island = flora.plants["island"]
    for park in plan.car_parks:
        for index, (x, y, turn) in enumerate(park.bays):
            if index % _ISLAND_EVERY == _ISLAND_EVERY // 2:
                builder.add_copy(ObjectClass.STRUCTURE, island, (x, y, 0.0), turn, 1.0)
                spot, heights = np.array([[x, y]]), (4.0, 6.0)
                gardens.add_small_trees(builder, spot, heights, 0.1, flora.trees, rng)
            elif rng.random() < _OCCUPIED:
                ahead = np.pi * float(rng.random() < 0.35)
                slip = (x + exact.normal(rng, 0, 0.06), y + exact.normal(rng, 0, 0.06), 0.0)
                way = turn + ahead + exact.normal(rng, 0, 0.015)
                car = cars[int(rng.integers(len(cars)))]
                add_car(builder, car, slip, way, rng.uniform(0.94, 1.04))
