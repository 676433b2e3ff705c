"""The scene of downtown."""

from dataclasses import replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.core.rng import stream
from eyas.mesh.assembly import concatenate
from eyas.mesh.solids import cylinder
from eyas.state.mesh import Mesh
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Lamps, ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import Levels, SceneBuilder
from eyas.world.buildings import placing, rooftops
from eyas.world.buildings.facades import chance_of, mesh_of
from eyas.world.maps.downtown.backdrop import add_backdrop
from eyas.world.maps.downtown.bridges import add_skyways
from eyas.world.maps.downtown.fronts import add_fronts
from eyas.world.maps.downtown.kerbs import crossing_lamps
from eyas.world.maps.downtown.plan import EXTENT, FLOOR, Plan, make_plan
from eyas.world.maps.downtown.railway import add_railway
from eyas.world.maps.downtown.roads import NAME
from eyas.world.maps.downtown.rooftops import add_water_tank
from eyas.world.maps.downtown.subway import add_entrances
from eyas.world.maps.downtown.surfaces import add_surfaces
from eyas.world.plants import gardens, trees
from eyas.world.plants.shrubs import plant_makers
from eyas.world.street import lamps
from eyas.world.street.furnishing import add_furniture
from eyas.world.street.furniture import FURNITURE
from eyas.world.street.parked_cars import VARIANTS, add_car, parked_car
from eyas.world.street.signals import add_signals, signal_places

__all__ = ["build_scene"]

_GREAT_HEIGHTS = (13.6, 15.4)
_SLIM_HEIGHTS = (11.5, 14.0)
_BROADER, _SLIMMER = 1.15, 0.64
"""Factors on the widths of the great and slim trees' crowns; they are usually about as wide as
high."""
_PARK_HEIGHTS = (3.6, 8.8)
_TAXI = (0.93, 0.70, 0.08)
_TAXIS = 0.2
"""Share of taxis among the parked cars."""
_HIGHEST_UNITS = 170.0
"""Roofs above this height are left bare but for a mast: no camera sees their equipment [m]."""
_LAMP_LIGHT = 96.0
"""Three times the usual: one lamp has to light a whole crossing [the original's unit]."""
_JET = material("plain", (0.93, 0.95, 0.97))


def build_scene(network: RoadNetwork, seed: int) -> Scene:
    """Return downtown.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    plan = make_plan(network, seed)
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    # The largest occluders come first: they are drawn first, so less is drawn twice.
    _add_buildings(builder, plan)
    add_railway(builder, plan.viaduct)
    add_skyways(builder, plan.skyways)
    _add_surroundings(builder, plan, seed)
    add_surfaces(builder, plan, network, seed)
    _add_trees(builder, plan, seed)
    lights = _furnish_streets(builder, plan, network, seed)
    _add_parked(builder, plan, stream(seed, "downtown parked cars"))
    _furnish_park(builder, plan)
    return builder.build(network, lights)


def _add_buildings(builder: SceneBuilder, plan: Plan) -> None:
    """Add buildings, each with all its parts, and the equipment of their roofs."""
    pavement = plan.pavement
    shapely.prepare(pavement)
    for parts in plan.buildings:
        owner = builder.add(ObjectClass.BUILDING, *map(mesh_of, parts))
        add_fronts(builder, parts[0], owner, pavement, chance_of(parts[0]))
        above = [shapely.Polygon(part.footprint) for part in parts[1:]] + [shapely.Polygon()]
        for part, taken in zip(parts, above, strict=True):
            builder.add_prism(*placing.prism_of(part), owner)
            top = part.bottom + part.height
            if part.roof != "flat" or (top > _HIGHEST_UNITS and not taken.is_empty):
                continue
            rng = chance_of(part)
            inside = shapely.buffer(shapely.Polygon(part.footprint), -0.8, join_style="mitre")
            roof = shapely.difference(inside, shapely.buffer(taken, 0.5))
            free = add_water_tank(builder, part, owner, roof, rng)
            used = shapely.union(taken, shapely.difference(roof, free))
            rooftops.add_rooftop(builder, part.footprint, top, owner, used, rng)


def _add_surroundings(builder: SceneBuilder, plan: Plan, seed: int) -> None:
    """Add the city beyond the outer streets."""
    fronts = [shapely.Polygon(corners) for corners in plan.footprints]
    city = shapely.union_all([plan.roads, plan.park.ground, plan.viaduct.ground, *fronts])
    add_backdrop(builder, plan.grid, EXTENT, city, stream(seed, "downtown backdrop"))


def _add_trees(builder: SceneBuilder, plan: Plan, seed: int) -> None:
    """Plant the trees along two streets and in the park."""
    shapes, rng = stream(seed, "downtown tree shapes"), stream(seed, "downtown trees")
    great = [
        builder.prototype(f"great tree {k}", partial(_tree, shapes, k, _BROADER), trees=1)
        for k in range(3)
    ]
    slim = [
        builder.prototype(f"slim tree {k}", partial(_tree, shapes, k, _SLIMMER), trees=1)
        for k in range(2)
    ]
    for trunks, kinds, heights, ground in (
        (plan.kerbs.great_trees, great, _GREAT_HEIGHTS, KERB_HEIGHT),
        (plan.kerbs.slim_trees, slim, _SLIM_HEIGHTS, KERB_HEIGHT),
        (plan.park.trees, great, _PARK_HEIGHTS, FLOOR_HEIGHT),
    ):
        gardens.add_small_trees(builder, trunks, heights, ground, kinds, rng)
    makers = plant_makers(shapes)
    shrubs = [builder.prototype(name, makers[name]) for name in ("border", "tall border")]
    for x, y, turn in plan.park.shrubs:
        kind = shrubs[int(rng.integers(len(shrubs)))]
        size = float(rng.uniform(0.9, 1.5))
        builder.add_copy(ObjectClass.TREE, kind, (x, y, FLOOR_HEIGHT), turn, size)


def _tree(rng: np.random.Generator, variant: int, width: float) -> Levels:
    """Return a tree of height 1 with a crown of another width, the finest level first."""
    return tuple(_widened(level, width) for level in trees.street_tree_levels(rng, variant))


def _widened(mesh: Mesh, width: float) -> Mesh:
    factor = np.array([width, width, 1.0])
    normals = mesh.normals / factor
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return replace(
        mesh,
        positions=(mesh.positions * factor).astype(np.float32),
        normals=normals.astype(np.float32),
    )


def _furnish_streets(builder: SceneBuilder, plan: Plan, network: RoadNetwork, seed: int) -> Lamps:
    """Add signals, lamps and furniture; return the light of the lamps."""
    add_signals(builder, network)
    lights, feet = _add_lamps(builder, network)
    poles = [place for place, _ in signal_places(network)]
    trunks = [*plan.kerbs.great_trees, *plan.kerbs.slim_trees, *plan.viaduct.feet]
    thin = shapely.buffer(shapely.points([*feet, *poles, *trunks]), 1.6)
    taken = shapely.union_all([plan.roads, plan.kerbs.bays, *thin])
    rng = stream(seed, "downtown furniture")
    taken = shapely.union(taken, add_entrances(builder, network, taken, rng))
    add_furniture(builder, network, plan.pavement, taken, KERB_HEIGHT, rng)
    return lights


def _add_lamps(builder: SceneBuilder, network: RoadNetwork) -> tuple[Lamps, NDArray[np.float64]]:
    """Add a lamp at each crossing; return their lights and their feet."""
    kind = builder.prototype("street lamp", lamps.lamp_levels)
    position, axis, feet = [], [], []
    x, _, z = lamps.LIGHT
    for foot, turn in crossing_lamps(network, lamps.BEYOND_KERB):
        owner = builder.add_copy(ObjectClass.POLE, kind, (*foot, KERB_HEIGHT), turn, 1.0)
        builder.add_cylinder(
            (foot[0], foot[1]), lamps.POLE_RADIUS, FLOOR_HEIGHT, lamps.POLE_HEIGHT, owner
        )
        onto_road = np.array([exact.cos(turn), exact.sin(turn)])
        position.append([*(foot + x * onto_road), z + KERB_HEIGHT])
        axis.append([*(0.3 * onto_road), -0.954])
        feet.append(foot)
    direction = np.array(axis) / np.linalg.norm(axis, axis=1, keepdims=True)
    made = Lamps(np.array(position, np.float32), direction.astype(np.float32), _LAMP_LIGHT)
    return made, np.array(feet)


def _add_parked(builder: SceneBuilder, plan: Plan, rng: np.random.Generator) -> None:
    """Park cars in the bays; every fifth is a yellow taxi."""
    cars = [builder.prototype(f"parked car {k}", partial(parked_car, k)) for k in range(VARIANTS)]
    taxi = builder.prototype("parked taxi", _taxi)
    for x, y, heading in plan.kerbs.cars:
        car = taxi if rng.random() < _TAXIS else cars[int(rng.integers(len(cars)))]
        size = float(rng.uniform(0.94, 1.04))
        add_car(builder, car, (x, y, 0.0), heading, size)


def _taxi() -> Levels:
    def yellow(mesh: Mesh) -> Mesh:
        paint = parked_car(0)[0].palette[0]
        palette = tuple(replace(m, tint=_TAXI) if m == paint else m for m in mesh.palette)
        return replace(mesh, palette=palette)

    fine, coarse = parked_car(0)
    return yellow(fine), yellow(coarse)


def _furnish_park(builder: SceneBuilder, plan: Plan) -> None:
    """Add benches along the paths, and the bowls of the fountain."""
    bench = builder.prototype("bench", FURNITURE["bench"])
    for x, y, facing in plan.park.benches:
        place = (x, y, FLOOR_HEIGHT)
        builder.add_copy(ObjectClass.STRUCTURE, bench, place, facing - np.pi / 2, 1.0)
    fountain = builder.prototype("fountain", lambda: (_fountain(20), _fountain(8)))
    place = (*plan.park.fountain, FLOOR_HEIGHT)
    builder.add_copy(ObjectClass.STRUCTURE, fountain, place, 0.0, 1.0)


def _fountain(sides: int) -> Mesh:
    stone = material("stone", (0.9, 0.88, 0.84))
    return concatenate(
        [
            cylinder((0.9, 0.6), (-0.1, 2.2), sides, stone),
            cylinder((1.0, 3.0), (1.5, 2.3), sides, stone, cap=True),
            cylinder((0.35, 0.3), (2.3, 3.6), sides, stone),
            cylinder((0.5, 1.5), (3.2, 3.7), sides, stone, cap=True),
            cylinder((0.12, 0.03), (3.7, 6.2), 6, _JET),
        ]
    )
