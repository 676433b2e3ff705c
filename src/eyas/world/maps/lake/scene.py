"""The scene of the lake district."""

from dataclasses import replace
from functools import partial

import numpy as np
import shapely

from eyas.core import exact
from eyas.core.rng import stream
from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import flat_polygon
from eyas.state.mesh import Material, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.materials import TEXTURES, material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.buildings.facades import mesh_of
from eyas.world.buildings.placing import prism_of
from eyas.world.land import ground
from eyas.world.land.plain import far_plain, plain
from eyas.world.maps.lake.plan import EXTENT, FLOOR, MIXED, Plan, Strip, make_plan
from eyas.world.maps.lake.roads import NAME
from eyas.world.plants.forest import SPECIES, STAND, TREES, stand_levels
from eyas.world.roads import markings, painting
from eyas.world.roads.areas import skirt, surface
from eyas.world.roads.wear import road_wear
from eyas.world.street.lamps import add_lamps
from eyas.world.street.parked_cars import VARIANTS, add_car, parked_car
from eyas.world.weather import Season

__all__ = ["build_scene"]

_SOIL = material("soil", (0.97, 0.95, 0.95))
_DAMP = material("soil", (0.74, 0.70, 0.66))
_SHORE = material("sand", (0.86, 0.84, 0.80))
_WATER = Material("water", (0.38, 0.59, 0.85), Surface.WATER)
_LEAVES = material("dry_leaves")
_KERB = material("stone", (1.0, 0.92, 0.85))
_APRON = material("concrete", (0.92, 0.90, 0.88))

_KERB_WIDTH = 0.8
_BANK, _BEACH = 1.4, 7.0
"""Width of the damp ground around ponds and of the shores of lakes [m]."""
_NEAR = 90.0
"""Reach of the ground that is cut into small squares beside a road [m]."""
_LAMPS = 48
_ZEBRAS_EVERY = 4
"""One stop line in so many has a crossing."""
_STANDS = 3
"""Different stands of each kind of tree."""
_OCCUPIED = 0.45


def build_scene(network: RoadNetwork, seed: int, season: Season) -> Scene:
    """Return the lake district in a season.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
        season: Season of the trees.
    """
    plan = make_plan(network, seed)
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    for house in plan.houses:
        owner = builder.add(ObjectClass.BUILDING, mesh_of(house))
        builder.add_prism(*prism_of(house), owner)
    _add_roads(builder, plan, network, seed)
    _add_ground(builder, plan)
    _add_forests(builder, plan, season, seed)
    _add_parked(builder, plan, stream(seed, "lake parked cars"))
    water = shapely.union_all([*plan.ponds, *(strip.area for strip in plan.strips)])
    houses = shapely.union_all([shapely.Polygon(house.footprint) for house in plan.houses])
    taken = shapely.union_all([plan.roads, water, houses, *(park.area for park in plan.car_parks)])
    lamps = add_lamps(builder, network, _LAMPS, taken, stream(seed, "lake lamps"))
    return builder.build(network, lamps)


def _add_roads(builder: SceneBuilder, plan: Plan, network: RoadNetwork, seed: int) -> None:
    """Add the roads with their kerbs, and the car parks."""
    paint = markings.road_paint(network)
    paint = replace(paint, zebras=paint.zebras[::_ZEBRAS_EVERY])
    bays = [painting.painted(park.lines, painting.WHITE) for park in plan.car_parks]
    wear = road_wear(network, stream(seed, "lake road wear"), apart=2.0)
    lots = _lots(plan)
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint), *bays)
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(plan.roads))
    builder.add(ObjectClass.ROAD, ground.asphalt(lots, light=True))
    kerbs = _kerbs(plan)
    tile = TEXTURES["stone"]
    builder.add(
        ObjectClass.PAVEMENT,
        surface(kerbs, KERB_HEIGHT, _KERB, tile),
        skirt(kerbs, FLOOR_HEIGHT, KERB_HEIGHT, _KERB, tile),
    )


def _lots(plan: Plan) -> shapely.Geometry:
    areas = shapely.union_all([park.area for park in plan.car_parks])
    return shapely.difference(areas, plan.roads)


def _kerbs(plan: Plan) -> shapely.Geometry:
    beside = shapely.buffer(plan.roads, _KERB_WIDTH, join_style="mitre")
    return shapely.difference(beside, shapely.union(plan.roads, _lots(plan)))


def _add_ground(builder: SceneBuilder, plan: Plan) -> None:
    """Add water with its shores, the floors of the forests, the feet of houses, and the soil."""
    near = shapely.buffer(plan.roads, _NEAR, quad_segs=2)
    paved = shapely.union_all([plan.roads, _lots(plan), _kerbs(plan)])
    water = [*plan.ponds, *plan.lakes]
    builder.add(ObjectClass.WATER, *(plain(area, near, _WATER) for area in water))
    covered = shapely.union_all([paved, *water])
    shores = [(plan.ponds, _BANK, _DAMP), (plan.lakes, _BEACH, _SHORE)]
    meshes = []
    for areas, width, cover in shores:
        shore = shapely.union_all([shapely.buffer(area, width, quad_segs=3) for area in areas])
        shore = shapely.difference(shore, covered)
        meshes.append(plain(shore, near, cover))
        covered = shapely.union(covered, shore)
    floors = shapely.union_all([shapely.buffer(strip.area, 1.0) for strip in plan.strips])
    meshes.append(plain(floors, near, _LEAVES))
    feet = [shapely.Polygon(house.footprint) for house in plan.houses]
    aprons = shapely.union_all([shapely.buffer(foot, 1.3, join_style="mitre") for foot in feet])
    aprons = shapely.difference(aprons, covered)
    meshes.append(flat_polygon(aprons, FLOOR_HEIGHT, _APRON, TEXTURES["concrete"]))
    covered = shapely.union_all([covered, floors, aprons])
    meshes.append(plain(shapely.difference(EXTENT, covered), near, _SOIL))
    builder.add(ObjectClass.GROUND, concatenate(meshes), far_plain(FLOOR, _SOIL))


def _add_forests(builder: SceneBuilder, plan: Plan, season: Season, seed: int) -> None:
    """Plant the strips, stand by stand."""
    rng = stream(seed, "lake forests")
    for strip in plan.strips:
        _add_strip(builder, strip, season, rng)


def _add_strip(
    builder: SceneBuilder, strip: Strip, season: Season, rng: np.random.Generator
) -> None:
    kinds = SPECIES if strip.kind == MIXED else (SPECIES[strip.kind],)
    name = "mixed" if strip.kind == MIXED else SPECIES[strip.kind].name
    make = partial(stand_levels, kinds, rng, frosted=season is Season.WINTER)
    stands = [builder.prototype(f"{name} {k}", make, trees=TREES) for k in range(_STANDS)]
    west, south, east, north = strip.area.bounds
    for x in np.arange(west + STAND / 2, east, STAND):
        for y in np.arange(south + STAND / 2, north, STAND):
            stand = stands[int(rng.integers(_STANDS))]
            turn = np.pi / 2 * float(rng.integers(4))
            place = (float(x), float(y), FLOOR_HEIGHT)
            builder.add_copy(ObjectClass.TREE, stand, place, turn, rng.uniform(0.94, 1.06))


def _add_parked(builder: SceneBuilder, plan: Plan, rng: np.random.Generator) -> None:
    cars = [builder.prototype(f"parked car {k}", partial(parked_car, k)) for k in range(VARIANTS)]
    for park in plan.car_parks:
        for x, y, turn in park.bays:
            if rng.random() < _OCCUPIED:
                way = turn + np.pi * float(rng.random() < 0.35) + exact.normal(rng, 0, 0.015)
                car = cars[int(rng.integers(len(cars)))]
                add_car(builder, car, (x, y, 0.0), way, 1.0)
