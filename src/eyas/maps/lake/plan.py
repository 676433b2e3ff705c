"""The plan of the lake district."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.millimetres import rounded, snapped
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.lake.layout import EXTENT, FLOOR, MIXED, LakeLayout, Strip, lay_out
from eyas.maps.lake.roads import NAME
from eyas.maps.lake.scenery import boats, shore_life, water_in
from eyas.maps.land import ground
from eyas.maps.land.outlines import wavy
from eyas.maps.plan.library import CAR_KINDS, STREET_KINDS, plant_kinds, wild_kinds
from eyas.maps.plan.plan import (
    Building,
    Buildings,
    Chance,
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
from eyas.maps.plants.forest import SPECIES, STAND
from eyas.maps.street.lamps import lamps_along
from eyas.maps.street.parked_cars import CARS

_SOIL = Material("soil", (0.97, 0.95, 0.95), Surface.HEATH)
_SHORE = replace(_SOIL, surface=Surface.HEATH_SHORE)
# Lakes send back .02 to .06 of the light that enters them, most of it green; the sky is mirrored.
_WATER = Material("water", (0.22, 0.31, 0.31), Surface.WATER)
_LEAVES = material("dry_leaves")
_KERB = material("stone", (0.96, 0.94, 0.93))
_APRON = material("concrete", (0.92, 0.90, 0.88))
_KERB_WIDTH = 0.8
_BEACH = 7.0  # Width of the shores [m]
_TUFTS, _TUFTS_BESIDE = (6.0, 0.006), (1.3, 14.0)
"""Least distance between two groups of tufts [m], and number of attempts on a square metre; their
least and largest distance from a road [m]."""
_SHRUBS, _BESIDE = (16.0, 0.004), 7.0
"""Least distance between two shrubs [m], and number of attempts on a square metre; their least
distance from a road [m]."""
_SHORE_SHRUBS, _BANK = (3.5, 0.03), 1.4
"""Least distance and attempts of shrubs along shores; their least distance from a basin [m]."""
_NEAR = 90.0  # Reach of the ground that is cut into small squares beside a road [m]
_LAMPS = 48
_ZEBRAS_EVERY = 4  # One stop line in so many has a crossing
_LITTER = 5.0  # Most by which the floor of a wood reaches beyond it or ends within [m]
_SHIFT = 3.5  # Most by which stands stand off their grid, so that no wood is a box [m]
_STANDS = 3  # Different stands of each kind of tree
_OCCUPIED = 0.45


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the lake district."""
    district = lay_out(network, seed)
    rng = stream(seed, "lake forests")
    forests = [stand for strip in district.strips for stand in _stands(strip, rng)]
    plants = stream(seed, "lake plants")
    shores = stream(seed, "lake shores")
    waters = [water_in(area, shores) for area in (*district.ponds, *district.lakes)]
    near = shapely.buffer(district.roads, _NEAR, quad_segs=2)
    shapely.prepare(near)
    shrubs = _shrubs(district, plants)
    life = shore_life(waters, near, shores) + _tufts(district, stream(seed, "lake tufts"))
    kinds = [kind for strip in district.strips for kind in _kinds(strip)]
    water = shapely.union_all([*district.ponds, *(strip.area for strip in district.strips)])
    built = shapely.union_all([house.outline for house in district.houses])
    parks = (park.area for park in district.car_parks)
    taken = shapely.union_all([district.roads, water, built, *parks])
    wild = wild_kinds("dry tuft", "green tuft", "reeds") + wild_kinds("stones", looks=(2, 3))
    afloat = (ThingKind(name="jetty"), *wild_kinds("boat", shapes=3))
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(*kinds, *CAR_KINDS, *STREET_KINDS, *plant_kinds("plants"), *wild, *afloat),
        chances={"forests": state_of(rng), "plants": state_of(plants)},
        layers=(
            Buildings(items=tuple(Building(parts=(house,)) for house in district.houses)),
            *_roads(district),
            *_ground(district, waters, seed),
            things(forests, [kind.name for kind in kinds]),
            things(shrubs, gardens.BORDERS),
            things(_parked(district, stream(seed, "lake parked cars")), CARS),
            things(lamps_along(network, _LAMPS, taken, stream(seed, "lake lamps"))),
            things(life, [kind.name for kind in wild]),
            things(boats(waters, district, near, stream(seed, "lake boats"))),
        ),
        near=near,
    )


def _roads(district: LakeLayout) -> list[Layer]:
    """Return the roads with their kerbs, and the car parks."""
    bays = tuple(line for park in district.car_parks for line in park.lines)
    kerbs = Paved(
        area=_kerbs(district),
        beside=shapely.union(district.roads, _lots(district)),
        slabs=_KERB,
        kerb=_KERB,
        kerb_width=_KERB_WIDTH,
    )
    return [
        Roadway(
            area=district.roads,
            paint=Paint(crossings=_ZEBRAS_EVERY, shapes=bays),
            wear=Chance(stream="lake road wear"),
            apart=2.0,
        ),
        GroundCover(kind=ObjectClass.ROAD, pieces=(ground.asphalt(_lots(district), light=True),)),
        kerbs,
    ]


def _lots(district: LakeLayout) -> shapely.Geometry:
    areas = shapely.union_all([park.area for park in district.car_parks])
    return shapely.difference(areas, district.roads)


def _kerbs(district: LakeLayout) -> shapely.Geometry:
    beside = shapely.buffer(district.roads, _KERB_WIDTH, join_style="mitre")
    return shapely.difference(beside, shapely.union(district.roads, _lots(district)))


def _ground(district: LakeLayout, waters: Sequence[shapely.Polygon], seed: int) -> list[Layer]:
    """Return water with its shores, the floors of the forests, the feet of houses, the soil."""
    paved = shapely.union_all([district.roads, _lots(district), _kerbs(district)])
    water = shapely.union_all(waters)
    rng = stream(seed, "lake floors")
    floors = snapped(
        shapely.union_all([wavy(strip.area, _LITTER, rng) for strip in district.strips])
    )
    feet = [shapely.buffer(house.outline, 1.3, join_style="mitre") for house in district.houses]
    aprons = shapely.difference(shapely.union_all(feet), paved)
    covered = shapely.union_all([paved, water, floors, aprons])
    beach = shapely.union_all([shapely.buffer(area, _BEACH, quad_segs=3) for area in waters])
    shore = snapped(shapely.difference(beach, covered))
    covered = shapely.union(covered, shore)
    pieces = [
        Flat(area=shore, cover=_SHORE, beside=water),
        _wide(floors, _LEAVES),
        Flat(area=aprons, cover=_APRON, cells="whole"),
        _wide(shapely.difference(EXTENT, covered), _SOIL),
    ]
    far = Far(rule="plain", covers=(_SOIL,))
    wet = tuple(_wide(area, _WATER) for area in waters)
    return [GroundCover(kind=ObjectClass.WATER, pieces=wet), GroundCover(pieces=(*pieces, far))]


def _wide(area: shapely.Geometry, cover: Material) -> Flat:
    return Flat(area=area, cover=cover, cells="wide")


def _kinds(strip: Strip) -> list[ThingKind]:
    """Return the stands of a strip of forest."""
    name = "mixed" if strip.kind == MIXED else SPECIES[strip.kind].name
    return [
        ThingKind(name=f"{name} {k}", make="stand", variant=strip.kind, chance="forests")
        for k in range(_STANDS)
    ]


def _stands(strip: Strip, rng: np.random.Generator) -> list[Placed]:
    """Return the stands that fill a strip of forest."""
    kinds, made = _kinds(strip), []
    west, south, east, north = strip.area.bounds
    for x in np.arange(west + STAND / 2, east, STAND).tolist():
        for y in np.arange(south + STAND / 2, north, STAND).tolist():
            stand = kinds[int(rng.integers(_STANDS))].name
            place = rounded(np.array([x, y]) + rng.uniform(-_SHIFT, _SHIFT, 2))
            turn, size = float(rng.uniform(0, 2 * np.pi)), float(rng.uniform(0.7, 1.2))
            made.append(Placed.at(stand, place, FLOOR_HEIGHT, turn, size))
    return made


def _shrubs(district: LakeLayout, rng: np.random.Generator) -> list[Placed]:
    """Return shrubs on the heath beside roads, and more of them along the shores."""
    water = shapely.union_all([*district.ponds, *district.lakes])
    shore = shapely.difference(
        shapely.buffer(water, _BANK + 3.0, quad_segs=3), shapely.buffer(water, _BANK, quad_segs=3)
    )
    parks = [park.area for park in district.car_parks]
    houses = [house.outline for house in district.houses]
    forests = [strip.area for strip in district.strips]
    built = shapely.buffer(shapely.union_all([*parks, *houses, *forests]), 3.0)
    taken = shapely.union_all([shapely.buffer(district.roads, _BESIDE), built])
    around = shapely.difference(shapely.buffer(district.roads, _NEAR, quad_segs=2), taken)
    heath = shapely.difference(around, shapely.buffer(water, _BEACH, quad_segs=3))
    spots = np.concatenate(
        [
            gardens.scattered(heath, *_SHRUBS, rng),
            gardens.scattered(shapely.intersection(shore, around), *_SHORE_SHRUBS, rng),
        ]
    )
    return [
        Placed(
            kind=gardens.BORDERS[int(rng.integers(len(gardens.BORDERS)))],
            x=x,
            y=y,
            z=FLOOR_HEIGHT,
            turn=rng.uniform(0, 2 * np.pi),
            scale=rng.uniform(0.6, 1.2),
        )
        for x, y in rounded(spots).tolist()
    ]


def _tufts(district: LakeLayout, rng: np.random.Generator) -> list[Placed]:
    """Return tufts of grass beside the roads."""
    least, most = (shapely.buffer(district.roads, far, quad_segs=2) for far in _TUFTS_BESIDE)
    water = shapely.union_all([*district.ponds, *district.lakes])
    parks = [park.area for park in district.car_parks]
    houses = [house.outline for house in district.houses]
    taken = shapely.buffer(shapely.union_all([*parks, *houses]), 2.0)
    strips = [strip.area for strip in district.strips]
    room = shapely.difference(most, shapely.union_all([least, taken, water, *strips]))
    spots = gardens.scattered(room, *_TUFTS, rng)
    kinds = ("dry tuft 0", "dry tuft 1", "green tuft 0", "green tuft 1")
    return gardens.sown(spots, kinds, (0.7, 1.2), FLOOR_HEIGHT - 0.03, rng)


def _parked(district: LakeLayout, rng: np.random.Generator) -> Sequence[Placed]:
    made = []
    for park in district.car_parks:
        for x, y, turn in park.bays.tolist():
            if rng.random() < _OCCUPIED:
                way = turn + np.pi * float(rng.random() < 0.35) + exact.normal(rng, 0, 0.028)
                made.append(Placed(CARS[int(rng.integers(len(CARS)))], x, y, 0.0, way))
    return made
