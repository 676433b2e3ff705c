"""The plan of the street city."""

from collections.abc import Sequence

import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.street.signals import signals_along
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.citystreet.layout import EXTENT, FLOOR, CityLayout, lay_out
from eyas.maps.citystreet.roads import NAME
from eyas.maps.citystreet.scenery import (
    TREES,
    clutter,
    great_trees,
    greenery,
    no_lawn,
    parked,
    taken_area,
)
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
from eyas.maps.plants import gardens
from eyas.maps.roads.overpass import pillars
from eyas.maps.street import furniture
from eyas.maps.street.furniture import furniture_along
from eyas.maps.street.lamps import lamps_along, lit_by
from eyas.maps.street.parked_cars import CARS

_LAMPS = 48
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_LEGS = 9  # Number of pillars beyond the floor, below the descent of the elevated road


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the street city."""
    city = lay_out(network, seed)
    yards = gardens.paved_yards(city.footprints, city.pavement, no_lawn(city))
    trunks, beds = stream(seed, "citystreet trees", 1), stream(seed, "citystreet gardens")
    great = great_trees(city, trunks)
    taken = taken_area(city, network)
    lamps = lamps_along(network, _LAMPS, taken, stream(seed, "citystreet lamps"))
    feet = shapely.buffer(shapely.points(lit_by(lamps)), 4.0)
    taken = shapely.union_all([taken, *feet])
    rng = stream(seed, "citystreet furniture")
    furnished = furniture_along(network, city.pavement, taken, KERB_HEIGHT, rng)
    taken = shapely.union_all([taken, city.pavement, *yards])
    green = greenery(city, taken, beds)
    cars = parked(city, stream(seed, "citystreet parked cars"))
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(
            *(ThingKind(name=name, make="street tree", variant=k, chance="trees")
              for k, name in enumerate(TREES)),
            *plant_kinds("beds"), *STREET_KINDS, *FURNITURE_KINDS, *CAR_KINDS,
            *CLUTTER_KINDS,
        ),
        chances={"trees": state_of(trunks), "beds": state_of(beds)},
        # The largest occluders come first: they are drawn first, so less is drawn twice.
        layers=(
            things([], TREES),
            _buildings(city),
            _deck(city),
            *_ground(city, yards, seed),
            things(great, solid="street trunk"),
            things(signals_along(network)),
            things(lamps),
            things(furnished, tuple(furniture.FURNITURE)),
            things(green, tuple(kind.name for kind in plant_kinds("beds"))),
            things(cars, CARS),
            things(clutter(city, network, [*lamps, *furnished], green, seed)),
        ),
    )  # fmt: skip


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


def _ground(city: CityLayout, yards: Sequence[shapely.Geometry], seed: int) -> list[Layer]:
    rng = stream(seed, "citystreet lawn")
    outskirts.fields(FLOOR, FLOOR_HEIGHT, rng, outskirts.CROPS)  # which shares the stream
    pools, turn = shapely.union_all(city.pools), city.turn
    paved = shapely.union_all([city.roads, city.access])
    paving = ground.yards(yards, turn, rng)
    covered = shapely.union_all([no_lawn(city), *yards])
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
