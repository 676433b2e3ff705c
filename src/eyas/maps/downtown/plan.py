"""The plan of downtown."""

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import joints, streets
from eyas.engine.world.street.signals import signal_places, signals_along
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.downtown.kerbs import crossing_lamps
from eyas.maps.downtown.layout import EXTENT, FLOOR, DowntownLayout, lay_out
from eyas.maps.downtown.roads import NAME
from eyas.maps.downtown.surfaces import backdrop, surfaces
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
    LampLight,
    MapPlan,
    Railway,
    Skyways,
    ThingKind,
    Things,
    things,
)
from eyas.maps.plants import gardens
from eyas.maps.street import lamps
from eyas.maps.street.dressing import CITY_KERBS, SHOP_FRONTS, Ground, along_kerbs, at_fronts
from eyas.maps.street.furnishing import furniture_along
from eyas.maps.street.furniture import FURNITURE
from eyas.maps.street.parked_cars import CARS
from eyas.maps.things.subway import LONG, WIDE

__all__ = ["make_plan"]

_GREAT, _SLIM = (
    tuple(f"great tree {k}" for k in range(3)),
    tuple(f"slim tree {k}" for k in range(2)),
)
_GREAT_HEIGHTS = (13.6, 15.4)
_SLIM_HEIGHTS = (11.5, 14.0)
_BROADER, _SLIMMER = 1.15, 0.64
"""Factors on the widths of the great and slim trees' crowns; they are usually about as wide as
high."""
_PARK_HEIGHTS = (3.6, 8.8)
_SHRUBS = ("border", "tall border")
_TAXI = "parked taxi"
_TAXIS = 0.2  # Share of taxis among the parked cars
_LIGHT = LampLight(axis=(0.3, 0.0, -0.954), intensity=96.0)
"""Three times the usual intensity: one lamp has to light a whole crossing."""
_ENTRANCES = 0.3  # Share of the ends of wide roads with an entrance of the subway
_APART = 2.2  # Factor on the distances in the clutter of a city with so many streets
_FROM_END, _BEYOND = 9.0, 2.3  # From the end of the road, and from the kerb, to its middle [m]


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of downtown.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    city = lay_out(network, seed)
    buildings = (
        Building(parts=tuple(parts), fittings=("fronts", "tank", "roof units"))
        for parts in city.buildings
    )
    fronts = [shapely.Polygon(corners) for corners in city.footprints]
    built = shapely.union_all([city.roads, city.park.ground, city.viaduct.ground, *fronts])
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(
            *(ThingKind(name=name, make="street tree", variant=k, width=width, chance="trees")
              for names, width in ((_GREAT, _BROADER), (_SLIM, _SLIMMER))
              for k, name in enumerate(names)),
            *plant_kinds("trees"), *STREET_KINDS, *FURNITURE_KINDS, *CAR_KINDS, *CLUTTER_KINDS,
            ThingKind(name="subway entrance"), ThingKind(name=_TAXI), ThingKind(name="fountain"),
        ),
        chances={"trees": Chance(stream="downtown tree shapes")},
        # The largest occluders come first: they are drawn first, so less is drawn twice.
        layers=(
            Buildings(items=tuple(buildings)),
            Railway(line=city.viaduct),
            Skyways(items=tuple(city.skyways)),
            backdrop(city.grid, EXTENT, built, stream(seed, "downtown backdrop")),
            *surfaces(city, seed),
            things(_trees(city, stream(seed, "downtown trees")), (*_GREAT, *_SLIM, *_SHRUBS)),
            *_along_streets(city, network, seed),
            things(_parked(city, stream(seed, "downtown parked cars")), (*CARS, _TAXI)),
            things(_in_park(city)),
        ),
        lamps=_LIGHT,
    )  # fmt: skip


def _trees(city: DowntownLayout, rng: np.random.Generator) -> list[Placed]:
    """Return the trees along two streets and in the park, and its shrubs."""
    made = []
    for trunks, kinds, heights, ground in (
        (city.kerbs.great_trees, _GREAT, _GREAT_HEIGHTS, KERB_HEIGHT),
        (city.kerbs.slim_trees, _SLIM, _SLIM_HEIGHTS, KERB_HEIGHT),
        (city.park.trees, _GREAT, _PARK_HEIGHTS, FLOOR_HEIGHT),
    ):
        made += gardens.small_trees(trunks, heights, ground, kinds, rng)
    for x, y, turn in city.park.shrubs.tolist():
        kind = _SHRUBS[int(rng.integers(len(_SHRUBS)))]
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, float(rng.uniform(0.9, 1.5))))
    return made


def _along_streets(city: DowntownLayout, network: RoadNetwork, seed: int) -> list[Things]:
    """Return signals, lamps, entrances of the subway, furniture and clutter."""
    rng = stream(seed, "downtown furniture")
    lit = crossing_lamps(network, lamps.BEYOND_KERB)
    lights = [Placed.at("street lamp", foot, KERB_HEIGHT, turn) for foot, turn in lit]
    feet = np.array([foot for foot, _ in lit])
    poles = [place for place, _ in signal_places(network)]
    trunks = [*city.kerbs.great_trees, *city.kerbs.slim_trees, *city.viaduct.feet]
    thin = shapely.buffer(shapely.points([*feet, *poles, *trunks]), 1.6)
    taken = shapely.union_all([city.roads, city.kerbs.bays, *thin])
    entrances = _entrances(network, taken, rng)
    room = [shapely.Point(one.x, one.y).buffer(0.5 * LONG + 0.3) for one in entrances]
    taken = shapely.union(taken, shapely.union_all(room))
    furnished = furniture_along(network, city.pavement, taken, KERB_HEIGHT, rng)
    clutter = _clutter(city, network, taken, furnished, stream(seed, "downtown clutter"))
    return [
        things(signals_along(network)),
        things(lights),
        things(entrances, ("subway entrance",)),
        things(furnished, tuple(FURNITURE)),
        things(clutter),
    ]


def _clutter(
    city: DowntownLayout,
    network: RoadNetwork,
    taken: shapely.Geometry,
    furnished: list[Placed],
    rng: np.random.Generator,
) -> list[Placed]:
    """Return the clutter of the streets, clear of what stands there already."""
    thin = shapely.buffer(shapely.points([[one.x, one.y] for one in furnished]), 1.3, quad_segs=2)
    paved = shapely.difference(city.pavement, shapely.union_all([taken, *thin]))
    ways = shapely.union(city.roads, city.kerbs.bays)
    back = shapely.difference(paved, shapely.buffer(ways, 2.45))
    asphalt = shapely.difference(city.roads, shapely.buffer(city.kerbs.bays, 0.3))
    for area in (paved, back, asphalt):
        shapely.prepare(area)
    behind = Ground(back, KERB_HEIGHT)
    grounds = {"road": Ground(asphalt, 0.0), "pavement": Ground(paved, KERB_HEIGHT)}
    beside = along_kerbs(network, {**grounds, "behind": behind}, CITY_KERBS, rng, _APART)
    return [*beside, *at_fronts(city.footprints, behind, SHOP_FRONTS, rng, _APART)]


def _entrances(
    network: RoadNetwork, keep_free: shapely.Geometry, rng: np.random.Generator
) -> list[Placed]:
    """Return entrances of the subway beside the ends of wide roads.

    Args:
        network: The roads.
        keep_free: Area where something else stands or drives [m].
        rng: Random numbers of the street furniture.
    """
    meeting, made = joints(network), []
    for street in streets(network):
        end = street.right[-1]
        onwards = unit(end - street.right[-2])
        leftwards = np.array([-onwards[1], onwards[0]])
        place = rounded(end - _FROM_END * onwards - _BEYOND * leftwards)
        wide = len(street.dividers) > 0 and meeting[street.end] >= 3
        room = shapely.Point(place).buffer(0.5 * WIDE + 0.4)
        if wide and rng.random() < _ENTRANCES and not shapely.intersects(keep_free, room):
            turn = float(exact.atan2(onwards[1], onwards[0]))
            made.append(Placed.at("subway entrance", place, KERB_HEIGHT, turn))
    return made


def _parked(city: DowntownLayout, rng: np.random.Generator) -> list[Placed]:
    """Return cars in the bays; every fifth is a yellow taxi."""
    made = []
    for x, y, heading in city.kerbs.cars.tolist():
        car = _TAXI if rng.random() < _TAXIS else CARS[int(rng.integers(len(CARS)))]
        made.append(Placed(car, x, y, 0.0, heading, float(rng.uniform(0.94, 1.04))))
    return made


def _in_park(city: DowntownLayout) -> list[Placed]:
    """Return benches along the paths, and the fountain."""
    benches = [
        Placed("bench", x, y, FLOOR_HEIGHT, facing - np.pi / 2)
        for x, y, facing in city.park.benches.tolist()
    ]
    return [*benches, Placed.at("fountain", city.park.fountain, FLOOR_HEIGHT)]
