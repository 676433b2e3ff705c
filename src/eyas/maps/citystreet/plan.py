"""The plan of the street city."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.street.signals import signal_places, signals_along
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.citystreet.layout import EXTENT, FLOOR, CityLayout, lay_out
from eyas.maps.citystreet.roads import NAME
from eyas.maps.land import ground, outskirts
from eyas.maps.plan.library import (
    CAR_KINDS,
    CLUTTER_KINDS,
    FURNITURE_KINDS,
    STREET_KINDS,
    plant_kinds,
)
from eyas.maps.plan.plan import (
    Building,
    Buildings,
    Chance,
    Deck,
    Far,
    Flat,
    GroundCover,
    Layer,
    MapPlan,
    Paint,
    Paved,
    Roadway,
    ThingKind,
    state_of,
    things,
)
from eyas.maps.plants import gardens, trees
from eyas.maps.roads import overpass
from eyas.maps.roads.pillars import pillars
from eyas.maps.street import furniture
from eyas.maps.street.dressing import CITY_KERBS, SHOP_FRONTS, Ground, along_kerbs, at_fronts
from eyas.maps.street.furnishing import furniture_along
from eyas.maps.street.lamps import lamps_along, lit_by
from eyas.maps.street.parked_cars import CARS

__all__ = ["make_plan"]

_GARDEN_TREES = ((4.5, 8.5), 11.0, 0.0022)
"""Heights and least distance [m], and number of attempts on a square metre."""
_MEADOW_TREES = ((4.0, 11.0), 70.0, 0.0004)
"""The same for the groups of trees beyond the outer streets."""
_FROM_WALL = 4.5
_FROM_STREET = 14.0  # Least distance of the trees beyond the outer streets from a street [m]
_OCCUPIED = 0.62  # Share of the bays with a car
_ISLAND_EVERY = 9  # Bays from one planted island to the next

_LAMPS = 48
_TREE_HEIGHTS = (14.8, 19.8, 27.0)
_TREE_ODDS = (0.3, 0.5, 0.2)
_TREES = tuple(f"street tree {k}" for k in range(trees.VARIANTS))
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_LEGS = 9  # Number of pillars beyond the floor, below the descent of the elevated road


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the street city.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    city = lay_out(network, seed)
    yards = gardens.paved_yards(city.footprints, city.pavement, _no_lawn(city))
    trunks, beds = stream(seed, "citystreet trees", 1), stream(seed, "citystreet gardens")
    great = _great_trees(city, trunks)
    taken = _taken(city, network)
    lamps = lamps_along(network, _LAMPS, taken, stream(seed, "citystreet lamps"))
    feet = shapely.buffer(shapely.points(lit_by(lamps)), 4.0)
    taken = shapely.union_all([taken, *feet])
    rng = stream(seed, "citystreet furniture")
    furnished = furniture_along(network, city.pavement, taken, KERB_HEIGHT, rng)
    taken = shapely.union_all([taken, city.pavement, *yards])
    green = greenery(city, taken, _TREES, beds)
    cars = parked(city, _TREES, stream(seed, "citystreet parked cars"))
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(
            *(ThingKind(name=name, make="street tree", variant=k, chance="trees")
              for k, name in enumerate(_TREES)),
            *plant_kinds("beds"), *STREET_KINDS, *FURNITURE_KINDS, *CAR_KINDS,
            *CLUTTER_KINDS,
        ),
        chances={"trees": state_of(trunks), "beds": state_of(beds)},
        # The largest occluders come first: they are drawn first, so less is drawn twice.
        layers=(
            things([], _TREES),
            _buildings(city),
            _deck(city),
            *_ground(city, yards, seed),
            things(great, solid="street trunk"),
            things(signals_along(network)),
            things(lamps),
            things(furnished, tuple(furniture.FURNITURE)),
            things(green, tuple(kind.name for kind in plant_kinds("beds"))),
            things(cars, CARS),
            things(_clutter(city, network, [*lamps, *furnished], green, seed)),
        ),
    )  # fmt: skip


def _clutter(
    city: CityLayout,
    network: RoadNetwork,
    poles: Sequence[Placed],
    green: Sequence[Placed],
    seed: int,
) -> list[Placed]:
    """Return the clutter of the streets, clear of what stands there already."""
    around = shapely.buffer(shapely.points([[one.x, one.y] for one in green]), 1.4, quad_segs=2)
    thin = shapely.buffer(shapely.points([[one.x, one.y] for one in poles]), 1.3, quad_segs=2)
    taken = shapely.union_all([_taken(city, network), *thin])
    paved = shapely.difference(city.pavement, taken)
    deck = shapely.buffer(overpass.deck_area(city.deck), 1.0)
    built = shapely.buffer(shapely.union_all([b.outline for b in city.buildings]), 0.3)
    covered = shapely.union_all([taken, city.pavement, city.lots, built, deck, *around])
    lawn = shapely.difference(shapely.union_all(city.blocks), covered)
    for area in (paved, lawn, city.roads):
        shapely.prepare(area)
    behind, rng = Ground(lawn, FLOOR_HEIGHT), stream(seed, "citystreet clutter")
    grounds = {"pavement": Ground(paved, KERB_HEIGHT), "behind": behind}
    beside = along_kerbs(network, {**grounds, "road": Ground(city.roads, 0.0)}, CITY_KERBS, rng)
    return [*beside, *at_fronts(city.footprints, behind, SHOP_FRONTS, rng)]


def _buildings(city: CityLayout) -> Buildings:
    """Return the buildings, and what keeps free the roofs below towers."""
    towers = [shell.outline for shell in city.buildings if shell.bottom > FLOOR_HEIGHT]
    made = []
    for shell in city.buildings:
        on_ground = shell.bottom <= FLOOR_HEIGHT
        above = [one for one in towers if on_ground and one.intersects(shell.outline)]
        free = shapely.union_all(above) if above else None
        made.append(Building(parts=(shell,), fittings=("roof units",), keep_free=free))
    return Buildings(items=tuple(made))


def _deck(city: CityLayout) -> Deck:
    down = outskirts.descent(city.deck, FLOOR_HEIGHT)  # beyond the floor; not solid
    legs = pillars(down, _LEGS, FLOOR_HEIGHT, city.roads)
    return Deck(middle=city.deck, pillars=tuple(city.pillars), descent=down, legs=tuple(legs))


def _no_lawn(city: CityLayout) -> shapely.Geometry:
    """Return roads, pavements, car parks and pools with their rims [m]."""
    rims = [shapely.buffer(pool, 0.8, join_style="mitre") for pool in city.pools]
    return shapely.union_all([city.roads, city.access, city.lots, city.pavement, *rims])


def _taken(city: CityLayout, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    built = [shell.outline for shell in city.buildings]
    areas = [park.area for park in city.car_parks] + [pillar.base for pillar in city.pillars]
    poles = [place for place, _ in signal_places(network)]
    thin = shapely.buffer(shapely.points([*city.trees, *poles]), 1.0)
    return shapely.union_all([city.roads, city.access, *city.pools, *built, *areas, *thin])


def _ground(city: CityLayout, yards: Sequence[shapely.Geometry], seed: int) -> list[Layer]:
    rng = stream(seed, "citystreet lawn")
    outskirts.fields(FLOOR, FLOOR_HEIGHT, rng, outskirts.CROPS)  # which shares the stream
    pools, turn = shapely.union_all(city.pools), city.turn
    paved = shapely.union_all([city.roads, city.access])
    paving = ground.yards(yards, turn, rng)
    covered = shapely.union_all([_no_lawn(city), *yards])
    lawn = ground.lawn(EXTENT, covered, rng, shapely.union_all(city.blocks), turn)
    crops, shares = zip(*outskirts.CROPS, strict=True)
    far = Far(rule="fields", covers=crops, shares=shares, chance=Chance(stream="citystreet lawn"))
    bays = [line for park in city.car_parks for line in park.lines]
    made: list[Layer] = [
        Roadway(
            area=paved, paint=Paint(shapes=tuple(bays)), wear=Chance(stream="citystreet road wear")
        ),
        Paved(area=city.pavement, beside=paved, turn=turn),
        GroundCover(kind=ObjectClass.PAVEMENT, pieces=tuple(paving)),
        GroundCover(kind=ObjectClass.ROAD, pieces=(ground.asphalt(city.lots, light=True),)),
        GroundCover(pieces=(*lawn, far)),
    ]
    if city.pools:
        rim = shapely.difference(shapely.buffer(pools, 0.8, join_style="mitre"), pools)
        water = Flat(area=pools, z=-0.15, cover=_WATER)
        made.append(GroundCover(kind=ObjectClass.WATER, pieces=(water,)))
        made.append(Paved(area=rim, beside=pools))
    return made


def _great_trees(city: CityLayout, rng: np.random.Generator) -> list[Placed]:
    """Return a tree of a random kind at each trunk."""
    made = []
    for x, y in city.trees.tolist():
        height = float(rng.choice(_TREE_HEIGHTS, p=_TREE_ODDS) * rng.uniform(0.93, 1.0))
        kind, turn = _TREES[int(rng.integers(len(_TREES)))], float(rng.uniform(0, 2 * np.pi))
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, height))
    return made


def greenery(
    plan: CityLayout, taken: shapely.Geometry, trees: Sequence[str], rng: np.random.Generator
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


def parked(plan: CityLayout, trees: Sequence[str], rng: np.random.Generator) -> list[Placed]:
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
                way = turn + ahead + exact.normal(rng, 0, 0.028)
                car = CARS[int(rng.integers(len(CARS)))]
                made.append(Placed(car, east, north, 0.0, way, rng.uniform(0.94, 1.04)))
    return made
