"""Scenery of the street city: trees, hedges and borders, parked cars, clutter of the streets."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.street.signals import signal_places
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.citystreet.layout import EXTENT, CityLayout
from eyas.maps.plants import gardens, trees
from eyas.maps.roads import overpass
from eyas.maps.street.dressing import CITY_KERBS, SHOP_FRONTS, DressedGround, along_kerbs, at_fronts
from eyas.maps.street.parked_cars import CARS

_GARDEN_TREES = ((4.5, 8.5), 11.0, 0.0022)
"""Heights and least distance [m], and number of attempts on a square metre."""
_MEADOW_TREES = ((4.0, 11.0), 70.0, 0.0004)
"""Heights, least distance and attempts of the groups of trees beyond the outer streets."""
_FROM_WALL = 4.5
_FROM_STREET = 14.0  # Least distance of the trees beyond the outer streets from a street [m]
_OCCUPIED = 0.62  # Share of the bays with a car
_ISLAND_EVERY = 9  # Bays from one planted island to the next
_TREE_HEIGHTS = (14.8, 19.8, 27.0)
_TREE_ODDS = (0.3, 0.5, 0.2)
TREES = tuple(f"street tree {k}" for k in range(trees.VARIANTS))


def no_lawn(city: CityLayout) -> shapely.Geometry:
    """Return roads, pavements, car parks and pools with their rims [m]."""
    rims = [shapely.buffer(pool, 0.8, join_style="mitre") for pool in city.pools]
    return shapely.union_all([city.roads, city.access, city.lots, city.pavement, *rims])


def taken_area(city: CityLayout, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    built = [shell.outline for shell in city.buildings]
    areas = [park.area for park in city.car_parks] + [pillar.base for pillar in city.pillars]
    poles = [place for place, _ in signal_places(network)]
    thin = shapely.buffer(shapely.points([*city.trees, *poles]), 1.0)
    return shapely.union_all([city.roads, city.access, *city.pools, *built, *areas, *thin])


def great_trees(city: CityLayout, rng: np.random.Generator) -> list[Placed]:
    """Return a tree of a random kind at each trunk."""
    made = []
    for x, y in city.trees.tolist():
        height = float(rng.choice(_TREE_HEIGHTS, p=_TREE_ODDS) * rng.uniform(0.93, 1.0))
        kind, turn = TREES[int(rng.integers(len(TREES)))], float(rng.uniform(0, 2 * np.pi))
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, height))
    return made


def greenery(plan: CityLayout, taken: shapely.Geometry, rng: np.random.Generator) -> list[Placed]:
    """Return borders along walls, hedges around car parks, and small trees.

    Args:
        taken: Area that is paved or where something stands [m].
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
    made += gardens.small_trees(spots, heights, FLOOR_HEIGHT, TREES, rng)
    heights, apart, density = _MEADOW_TREES
    streets = shapely.buffer(shapely.union_all([plan.roads, plan.access, deck]), _FROM_STREET)
    room = shapely.difference(
        shapely.buffer(EXTENT, -8.0), shapely.union_all([streets, *plan.blocks])
    )
    groups = gardens.scattered(room, apart, density, rng)
    spots = gardens.clustered(groups, 7.0, (1, 6), room, rng)
    return made + gardens.small_trees(spots, heights, FLOOR_HEIGHT, TREES, rng)


def parked(plan: CityLayout, rng: np.random.Generator) -> list[Placed]:
    """Return what is in the bays of the car parks: islands, small trees and cars."""
    made = []
    for park in plan.car_parks:
        for index, (x, y, turn) in enumerate(park.bays.tolist()):
            if index % _ISLAND_EVERY == _ISLAND_EVERY // 2:
                made.append(Placed("island", x, y, 0.0, turn))
                made += gardens.small_trees(np.array([[x, y]]), (4.0, 6.0), 0.1, TREES, rng)
            elif rng.random() < _OCCUPIED:
                ahead = np.pi * float(rng.random() < 0.35)
                east, north = x + exact.normal(rng, 0, 0.06), y + exact.normal(rng, 0, 0.06)
                way = turn + ahead + exact.normal(rng, 0, 0.028)
                car = CARS[int(rng.integers(len(CARS)))]
                made.append(Placed(car, east, north, 0.0, way, rng.uniform(0.94, 1.04)))
    return made


def clutter(
    city: CityLayout,
    network: RoadNetwork,
    poles: Sequence[Placed],
    green: Sequence[Placed],
    seed: int,
) -> list[Placed]:
    """Return the clutter of the streets, clear of what stands there already."""
    around = shapely.buffer(shapely.points([[one.x, one.y] for one in green]), 1.4, quad_segs=2)
    thin = shapely.buffer(shapely.points([[one.x, one.y] for one in poles]), 1.3, quad_segs=2)
    taken = shapely.union_all([taken_area(city, network), *thin])
    paved = shapely.difference(city.pavement, taken)
    deck = shapely.buffer(overpass.deck_area(city.deck), 1.0)
    built = shapely.buffer(shapely.union_all([b.outline for b in city.buildings]), 0.3)
    covered = shapely.union_all([taken, city.pavement, city.lots, built, deck, *around])
    lawn = shapely.difference(shapely.union_all(city.blocks), covered)
    for area in (paved, lawn, city.roads):
        shapely.prepare(area)
    behind, rng = DressedGround(lawn, FLOOR_HEIGHT), stream(seed, "citystreet clutter")
    grounds = {"pavement": DressedGround(paved, KERB_HEIGHT), "behind": behind}
    beside = along_kerbs(
        network, {**grounds, "road": DressedGround(city.roads, 0.0)}, CITY_KERBS, rng
    )
    return [*beside, *at_fronts(city.footprints, behind, SHOP_FRONTS, rng)]
