"""The street city: mid-rise blocks on lawn, rows of great trees, a road high above the roofs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core.rng import stream
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.world import buildings, ground, markings, materials, outskirts, overpass, road_wear, trees
from eyas.world.assembly import SceneBuilder
from eyas.world.car_parks import CarPark, place_car_parks, place_rectangle
from eyas.world.lamps import add_lamps, lamp_levels
from eyas.world.lots import turned
from eyas.world.maps.citystreet_roads import NAME, road_graph
from eyas.world.pillars import BASE_HEIGHT, COLUMN_RADIUS, Pillar, pillar_mesh, pillars
from eyas.world.poles import add_signals, signal_levels, signal_places
from eyas.world.roads import (
    Street,
    blocks,
    corners,
    corridors,
    joints,
    polygons_of,
    road_area,
    streets,
    surface,
)

__all__ = ["FLOOR", "NAME", "build_scene", "road_graph"]

FLOOR = (900.0, 900.0)
"""Extent of the floor [m]."""

_EXTENT = shapely.box(*(-0.5 * np.array(FLOOR)), *(0.5 * np.array(FLOOR)))
_BUILDINGS = 83
_TREES = 63
_LAMPS = 48
_TREE_SPACING = (15.0, 21.5)
_TREE_HEIGHTS = (14.8, 19.8, 27.0)
_TREE_ODDS = (0.3, 0.5, 0.2)
_BEYOND_KERB = 4.4
"""From the kerb to the trunks [m]."""
_TREE_STRIP = 10.0
"""Beside a row of trees, from the kerb: no building [m]."""
_CAR_PARKS = ((69.0, 34.0), (58.0, 34.0), (45.0, 34.0), (64.0, 17.0), (49.0, 17.0))
_POOL = (30.0, 18.8)
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)

_HIGH = 53.5
"""z of the elevated road [m]."""
_PILLARS = 18
_LEGS = 9
"""Pillars beyond the floor, where the elevated road comes down."""
_ASIDE = 17.0
"""From the middle of a street to that of the elevated road beside it [m]."""
_RAMP = ((0.0, 0.0), (0.02, 0.1), (0.09, 3.5), (0.27, 28.0), (0.42, _HIGH), (1.0, _HIGH))
"""Share of the elevated road's length, and z [m]."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Plan:
    """Where things are, in plan view."""

    roads: shapely.Geometry
    access: shapely.Geometry
    blocks: list[shapely.Polygon]
    outside: list[shapely.Polygon]
    deck: Points
    pillars: list[Pillar]
    car_parks: list[CarPark]
    pools: list[shapely.Polygon]
    trees: Points
    buildings: list[buildings.Building]


def build_scene(network: RoadNetwork, seed: int) -> Scene:
    """Return the street city.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Of the map, >= 0.
    """
    plan = _plan(network, seed)
    builder = SceneBuilder()
    _add_ground(builder, plan, network, seed)
    _add_overpass(builder, plan)
    for building in plan.buildings:
        owner = builder.add(ObjectClass.BUILDING, buildings.mesh_of(building))
        builder.add_prism(*buildings.prism_of(building), owner)
    levels = _add_trees(builder, plan, stream(seed, "citystreet trees", 1))
    add_signals(builder, network, len(levels))
    levels += [signal_levels(), lamp_levels()]
    rng = stream(seed, "citystreet lamps")
    lights = add_lamps(builder, network, _LAMPS, _taken(plan, network), len(levels) - 1, rng)
    return builder.build(NAME, seed, FLOOR, ground.FLOOR_HEIGHT, levels, network, lights)


def _taken(plan: _Plan, network: RoadNetwork) -> shapely.Geometry:
    """Return where something stands or drives already, in plan view."""
    built = [shapely.Polygon(buildings.prism_of(building)[0]) for building in plan.buildings]
    areas = [park.area for park in plan.car_parks] + [pillar.base for pillar in plan.pillars]
    poles = [place for place, _ in signal_places(network)]
    thin = shapely.buffer(shapely.points([*plan.trees, *poles]), 1.0)
    return shapely.union_all([plan.roads, plan.access, *plan.pools, *built, *areas, *thin])


def _plan(network: RoadNetwork, seed: int) -> _Plan:
    roads = road_area(network)
    closed, _ = blocks(sharp := corridors(network), _EXTENT)
    middle = _overpass_path(seed)
    onwards = (middle[1] - middle[0])[:2]
    access = outskirts.access_road(middle[0, :2], onwards / np.linalg.norm(onwards), roads)
    columns = pillars(middle, _PILLARS, ground.FLOOR_HEIGHT, roads)
    deck = shapely.buffer(overpass.deck_area(middle), 3.0)
    rng = stream(seed, "citystreet lots")
    car_parks = place_car_parks(closed, _CAR_PARKS, rng, deck)
    lots = [park.area for park in car_parks]
    pools = _pools(closed, rng, shapely.union_all([deck, *lots]))
    bases = [shapely.buffer(pillar.base, 3.0) for pillar in columns]
    taken = shapely.union_all([roads, *bases, *(shapely.buffer(lot, 2.0) for lot in lots)])
    trunks, strips = _tree_rows(network, stream(seed, "citystreet trees"), taken)
    aprons = [shapely.buffer(lot, 2.5, join_style="mitre") for lot in (*lots, *pools)]
    free = shapely.union_all([deck, *aprons, *strips])
    # Each corner by itself, so that it takes a corner off a building and moves none.
    free = shapely.geometrycollections([*polygons_of(free), *corners(roads, sharp)])
    made = buildings.place_buildings(closed, _BUILDINGS, stream(seed, "citystreet buildings"), free)
    inside, outside = blocks(roads, _EXTENT)
    plain = (roads, access, inside, outside, middle, columns, car_parks, pools)
    return _Plan(*plain, trunks, made)


def _overpass_path(seed: int) -> Points:
    """Return the elevated road: up a ramp in the west, then beside three streets to the east."""
    at = {node.name: np.array([node.x, node.y]) for node in road_graph(seed).nodes}
    origin = at["B2"]
    east = (at["C2"] - origin) / np.linalg.norm(at["C2"] - origin)
    frame = np.stack([east, [-east[1], east[0]]])
    west, third = frame @ (at["A4"] - origin)
    second = frame[0] @ (at["C2"] - origin)
    corners = np.array(
        [
            [west - 68.0, 70.0],
            [west - 68.0, third + _ASIDE],
            [second + _ASIDE, third + _ASIDE],
            [second + _ASIDE, _ASIDE],
            [second + 600.0, _ASIDE],
        ]
    )
    world = corners @ frame + origin
    # It leaves the map where the floor ends.
    onwards = frame[0]
    room = (np.sign(onwards) * 0.5 * np.array(FLOOR) - world[3]) / onwards
    world[4] = world[3] + (room.min() - 2.0) * onwards
    return overpass.path(world, (55.0, 70.0, 60.0), _RAMP)


def _pools(
    closed: Sequence[shapely.Polygon], rng: np.random.Generator, keep_free: shapely.Geometry
) -> list[shapely.Polygon]:
    """Return one pool, in the first block that has room for it."""
    for index in rng.permutation(len(closed)):
        found = place_rectangle(closed[int(index)], _POOL, rng, keep_free)
        if found:
            return [turned(found[0], found[1])]
    return []


def _tree_rows(
    network: RoadNetwork, rng: np.random.Generator, keep_free: shapely.Geometry
) -> tuple[Points, list[shapely.Polygon]]:
    """Return trunks along both sides of inner streets, and the strips that their crowns need."""
    meeting = joints(network)
    every = streets(network)
    rows: list[Street] = []
    for index in rng.permutation(len(every)):
        street = every[int(index)]
        if street not in rows and min(meeting[street.start], meeting[street.end]) == 4:
            rows += [s for s in every if {s.start, s.end} == {street.start, street.end}]
    trunks, strips = np.zeros((0, 2)), []
    for street in rows:
        kerb = shapely.LineString(street.right)
        line = shapely.offset_curve(kerb, -_BEYOND_KERB)
        found = trees.place_along(line, _TREE_SPACING, rng, keep_free)[: _TREES - len(trunks)]
        if len(found):
            trunks = np.concatenate([trunks, found])
            strips.append(shapely.buffer(kerb, -_TREE_STRIP, cap_style="flat", single_sided=True))
    return trunks, strips


def _add_ground(builder: SceneBuilder, plan: _Plan, network: RoadNetwork, seed: int) -> None:
    rng = stream(seed, "citystreet lawn")
    lots = shapely.union_all([park.area for park in plan.car_parks])
    pools = shapely.union_all(plan.pools)
    paved = shapely.union_all([plan.roads, plan.access])
    lots = shapely.difference(lots, plan.roads)
    verge = ground.verge_area(plan.outside, paved)
    foot = overpass.deck_area(plan.deck[:9])
    pavement = shapely.union_all(
        [ground.pavement_area(plan.blocks, lots), shapely.difference(verge, foot)]
    )
    rim = shapely.difference(shapely.buffer(pools, 0.8, join_style="mitre"), pools)
    covered = shapely.union_all([paved, lots, pools, rim, pavement])
    land = outskirts.fields(FLOOR, ground.FLOOR_HEIGHT, rng)
    builder.add(ObjectClass.GROUND, ground.lawn(_EXTENT, covered, rng), land)
    wear = road_wear.road_wear(network, stream(seed, "citystreet road wear"))
    builder.add(ObjectClass.ROAD, ground.asphalt(paved), wear)
    paint = markings.mesh_of(markings.road_paint(network))
    bays = [markings.painted(park.lines, markings.WHITE) for park in plan.car_parks]
    builder.add(ObjectClass.MARKING, paint, *bays)
    builder.add(ObjectClass.PAVEMENT, ground.pavement(pavement, paved))
    builder.add(ObjectClass.ROAD, ground.asphalt(lots, light=True))
    if plan.pools:
        builder.add(ObjectClass.WATER, surface(pools, -0.15, _WATER, materials.TEXTURES["water"]))
        builder.add(ObjectClass.PAVEMENT, ground.pavement(rim, pools))


def _add_overpass(builder: SceneBuilder, plan: _Plan) -> None:
    floor = ground.FLOOR_HEIGHT
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
    builder: SceneBuilder, plan: _Plan, rng: np.random.Generator
) -> list[tuple[Mesh, ...]]:
    """Add a tree at each trunk; return the kinds of trees."""
    for place in plan.trees:
        height = rng.choice(_TREE_HEIGHTS, p=_TREE_ODDS) * rng.uniform(0.93, 1.0)
        spot = (*place, ground.FLOOR_HEIGHT)
        kind, turn = int(rng.integers(trees.VARIANTS)), rng.uniform(0, 2 * np.pi)
        owner = builder.add_copy(ObjectClass.TREE, kind, spot, turn, height)
        builder.add_cylinder(place, 0.022 * height, ground.FLOOR_HEIGHT, 0.3 * height, owner)
    return [trees.street_tree_levels(rng, kind) for kind in range(trees.VARIANTS)]
