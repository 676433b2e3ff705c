"""The scene of the street city."""

from collections.abc import Sequence
from functools import partial

import numpy as np
import shapely

from eyas.core.rng import stream
from eyas.state.mesh import Material, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build import materials
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.scene_builder import Prototype, SceneBuilder
from eyas.world.buildings import placing as buildings
from eyas.world.buildings import rooftops
from eyas.world.buildings.facades import chance_of, mesh_of
from eyas.world.land import ground, outskirts
from eyas.world.maps.citystreet.greenery import Flora, add_greenery, add_parked
from eyas.world.maps.citystreet.plan import EXTENT, FLOOR, Plan, make_plan
from eyas.world.maps.citystreet.roads import NAME
from eyas.world.plants import gardens, trees
from eyas.world.plants.shrubs import plant_makers
from eyas.world.roads import markings, overpass, painting
from eyas.world.roads import wear as road_wear
from eyas.world.roads.areas import surface
from eyas.world.roads.pillars import BASE_HEIGHT, COLUMN_RADIUS, pillar_mesh, pillars
from eyas.world.street.furnishing import add_furniture
from eyas.world.street.lamps import add_lamps
from eyas.world.street.signals import add_signals, signal_places

__all__ = ["build_scene"]

_LAMPS = 48
_TREE_HEIGHTS = (14.8, 19.8, 27.0)
_TREE_ODDS = (0.3, 0.5, 0.2)
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_LEGS = 9
"""Number of pillars beyond the floor, below the descent of the elevated road."""


def build_scene(network: RoadNetwork, seed: int) -> Scene:
    """Return the street city.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    plan = make_plan(network, seed)
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    yards = gardens.paved_yards(plan.footprints, plan.pavement, _no_lawn(plan))
    trunks, beds = stream(seed, "citystreet trees", 1), stream(seed, "citystreet gardens")
    kinds = [
        builder.prototype(f"street tree {k}", partial(trees.street_tree_levels, trunks, k), trees=1)
        for k in range(trees.VARIANTS)
    ]
    # The largest occluders come first: they are drawn first, so less is drawn twice.
    _add_buildings(builder, plan)
    _add_overpass(builder, plan)
    _add_ground(builder, plan, network, yards, seed)
    _add_trees(builder, plan, kinds, trunks)
    add_signals(builder, network)
    taken = _taken(plan, network)
    lights = add_lamps(builder, network, _LAMPS, taken, stream(seed, "citystreet lamps"))
    feet = shapely.buffer(shapely.points(lights.position[:, :2].astype(float)), 4.0)
    taken = shapely.union_all([taken, *feet])
    rng = stream(seed, "citystreet furniture")
    add_furniture(builder, network, plan.pavement, taken, KERB_HEIGHT, rng)
    taken = shapely.union_all([taken, plan.pavement, *yards])
    plants = {name: builder.prototype(name, make) for name, make in plant_makers(beds).items()}
    flora = Flora(kinds, plants)
    add_greenery(builder, plan, taken, flora, beds)
    add_parked(builder, plan, flora, stream(seed, "citystreet parked cars"))
    return builder.build(network, lights)


def _add_buildings(builder: SceneBuilder, plan: Plan) -> None:
    """Add buildings and the equipment of their roofs."""
    towers = [shapely.Polygon(b.footprint) for b in plan.buildings if b.bottom > FLOOR_HEIGHT]
    above = shapely.union_all(towers)
    for building in plan.buildings:
        owner = builder.add(ObjectClass.BUILDING, mesh_of(building))
        builder.add_prism(*buildings.prism_of(building), owner)
        if building.roof == "flat":
            top = building.bottom + building.height
            free = above if building.bottom <= FLOOR_HEIGHT else shapely.Polygon()
            rng = chance_of(building)
            rooftops.add_rooftop(builder, building.footprint, top, owner, free, rng)


def _no_lawn(plan: Plan) -> shapely.Geometry:
    """Return roads, pavements, car parks and pools with their rims [m]."""
    rims = [shapely.buffer(pool, 0.8, join_style="mitre") for pool in plan.pools]
    return shapely.union_all([plan.roads, plan.access, plan.lots, plan.pavement, *rims])


def _taken(plan: Plan, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    built = [shapely.Polygon(buildings.prism_of(building)[0]) for building in plan.buildings]
    areas = [park.area for park in plan.car_parks] + [pillar.base for pillar in plan.pillars]
    poles = [place for place, _ in signal_places(network)]
    thin = shapely.buffer(shapely.points([*plan.trees, *poles]), 1.0)
    return shapely.union_all([plan.roads, plan.access, *plan.pools, *built, *areas, *thin])


def _add_ground(
    builder: SceneBuilder,
    plan: Plan,
    network: RoadNetwork,
    yards: list[shapely.Geometry],
    seed: int,
) -> None:
    rng = stream(seed, "citystreet lawn")
    pools, turn = shapely.union_all(plan.pools), plan.turn
    paved = shapely.union_all([plan.roads, plan.access])
    covered = shapely.union_all([_no_lawn(plan), *yards])
    land = outskirts.fields(FLOOR, FLOOR_HEIGHT, rng)
    mown = shapely.union_all(plan.blocks)
    paint = markings.road_paint(network)
    bays = [painting.painted(park.lines, painting.WHITE) for park in plan.car_parks]
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint), *bays)
    wear = road_wear.road_wear(network, stream(seed, "citystreet road wear"))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(paved))
    builder.add(ObjectClass.PAVEMENT, ground.pavement(plan.pavement, paved, turn))
    builder.add(ObjectClass.PAVEMENT, ground.yards(yards, turn, rng))
    builder.add(ObjectClass.ROAD, ground.asphalt(plan.lots, light=True))
    builder.add(ObjectClass.GROUND, ground.lawn(EXTENT, covered, rng, mown, turn), land)
    if plan.pools:
        rim = shapely.difference(shapely.buffer(pools, 0.8, join_style="mitre"), pools)
        builder.add(ObjectClass.WATER, surface(pools, -0.15, _WATER, materials.TEXTURES["water"]))
        builder.add(ObjectClass.PAVEMENT, ground.pavement(rim, pools))


def _add_overpass(builder: SceneBuilder, plan: Plan) -> None:
    floor = FLOOR_HEIGHT
    down = outskirts.descent(plan.deck, floor)  # beyond the floor; not solid
    legs = [pillar_mesh(pillar, floor) for pillar in pillars(down, _LEGS, floor, plan.roads)]
    deck = [overpass.deck_mesh(part, floor) for part in (plan.deck, down)]
    owner = builder.add(ObjectClass.STRUCTURE, *deck, *legs)
    for outline, bottom, top in overpass.deck_prisms(plan.deck, floor):
        builder.add_prism(outline, bottom, top, owner)
    for pillar in plan.pillars:
        owner = builder.add(ObjectClass.STRUCTURE, pillar_mesh(pillar, floor))
        base = shapely.get_coordinates(pillar.base)[:-1]
        builder.add_prism(base, floor, floor + BASE_HEIGHT, owner)
        for column in pillar.columns:
            builder.add_cylinder(column, COLUMN_RADIUS, floor, pillar.top, owner)


def _add_trees(
    builder: SceneBuilder, plan: Plan, kinds: Sequence[Prototype], rng: np.random.Generator
) -> None:
    """Add a tree of a random kind at each trunk."""
    for place in plan.trees:
        height = rng.choice(_TREE_HEIGHTS, p=_TREE_ODDS) * rng.uniform(0.93, 1.0)
        spot = (*place, FLOOR_HEIGHT)
        kind, turn = kinds[int(rng.integers(len(kinds)))], rng.uniform(0, 2 * np.pi)
        owner = builder.add_copy(ObjectClass.TREE, kind, spot, turn, height)
        builder.add_cylinder(place, 0.022 * height, FLOOR_HEIGHT, 0.3 * height, owner)
