"""The scene of the village."""

from functools import partial
from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.core.rng import stream
from eyas.mesh.solids import box
from eyas.state.lighting import Horizon
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Lamps, ObjectClass, Scene
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES, material, without_snow
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.buildings.cottages import add_cottages
from eyas.world.land import ground
from eyas.world.land.facets import Relief, relief, surface_of, terrain_of
from eyas.world.land.mounds import highest
from eyas.world.land.outlines import blob
from eyas.world.land.plain import far_plain
from eyas.world.maps.village.looks import GRASS, HILLS, HOUSES, MEADOWS, ROCK, SHORE, VERGE, WATER
from eyas.world.maps.village.plan import EXTENT, FLOOR, HALF, Plan, make_plan
from eyas.world.maps.village.roads import NAME
from eyas.world.plants import gardens
from eyas.world.plants.cones import VARIANTS, cone_tree_levels
from eyas.world.plants.shrubs import plant_makers
from eyas.world.roads import markings, painting
from eyas.world.roads import wear as road_wear
from eyas.world.roads.areas import skirt, surface
from eyas.world.roads.tunnels import tunnel_mesh, tunnel_prisms
from eyas.world.street.gantries import add_gantries
from eyas.world.street.lamps import add_lamps
from eyas.world.street.signals import add_signals, signal_places

__all__ = ["VALLEY", "build_scene"]

VALLEY = Horizon(name="village", height=0.05, woods=0.6)
"""What stands beyond the hills."""
_LAMPS = 47
_CORE = 345.0
"""Half the side of the square with the smaller facets [m]."""
_FACETS = (6.5, 12.5)
"""Distance between the corners of facets in the middle and outside of it [m]."""
_ROUGH = 0.045
"""Most by which a corner lies above or below the smooth shape, as a share of its height."""
_PATCHES = 60
"""Number of patches of each kind of grass."""
_BUSHES = (26.0, 0.004)
"""Least distance between two bushes [m], and number of attempts on a square metre."""
_TREE_HEIGHTS = (10.0, 11.8)


def build_scene(network: RoadNetwork, seed: int) -> Scene:
    """Return the village.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    plan = make_plan(network, seed)
    hills = _relief(plan, stream(seed, "village facets"))
    terrain = terrain_of(hills, FLOOR_HEIGHT, HALF)
    builder = SceneBuilder(NAME, seed, FLOOR, terrain)
    _add_hills(builder, hills, stream(seed, "village grass"))
    lights = _add_tunnels(builder, plan, stream(seed, "village mounds"))
    add_cottages(builder, plan.cottages, HOUSES)
    _add_ground(builder, plan, network, hills.area, seed)
    _add_plants(builder, plan, hills.area, stream(seed, "village plants"))
    add_signals(builder, network)
    add_gantries(builder, plan.gantries, stream(seed, "village signs"))
    street = _LAMPS - len(lights.position)
    taken = _taken(plan, network)
    more = add_lamps(builder, network, street, taken, stream(seed, "village lamps"))
    both = Lamps(
        np.concatenate([lights.position, more.position]), np.concatenate([lights.axis, more.axis])
    )
    return builder.build(network, both, VALLEY)


def _relief(plan: Plan, rng: np.random.Generator) -> Relief:
    """Return the hills as facets."""
    passages = [shapely.buffer(tunnel.passage, 0.5) for tunnel in plan.tunnels]
    trunks = shapely.buffer(shapely.union_all(shapely.points(plan.trees)), 1.5)
    flat = shapely.union_all(
        [
            shapely.buffer(plan.roads, 6.0),
            shapely.buffer(plan.walls, 4.0),
            shapely.buffer(plan.lake, 4.0),
            trunks,
            *passages,
        ]
    )

    def heights(points: np.ndarray) -> np.ndarray:
        smooth, _ = highest(plan.hills, points)
        return np.round(smooth * (1.0 + rng.uniform(-_ROUGH, _ROUGH, len(points))), 3)

    return relief(heights, (_CORE, HALF), _FACETS, flat, rng)


def _add_hills(builder: SceneBuilder, hills: Relief, rng: np.random.Generator) -> None:
    """Add the hills; each facet has one of a few greens, lighter and drier ones higher up."""
    height = hills.corners[..., 2].mean(axis=1)
    level = np.clip(height / 45.0, 0.0, 1.0) * (len(HILLS) - 2) + rng.uniform(0.0, 1.8, len(height))
    kind = np.clip(level.astype(int), 0, len(HILLS) - 1)
    builder.add(ObjectClass.GROUND, surface_of(hills, FLOOR_HEIGHT, HILLS, kind))


def _add_tunnels(builder: SceneBuilder, plan: Plan, rng: np.random.Generator) -> Lamps:
    """Add the tunnels; return the lamps below their roofs."""
    position = []
    lamp = Material(tint=(1.0, 0.92, 0.78), surface=Surface.LAMP, emission=5.0)
    case = builder.prototype("tunnel lamp", lambda: (box((1.4, 0.5, 0.12), (0, 0, 0), lamp, 1.0),))
    for tunnel in plan.tunnels:
        mesh = tunnel_mesh(tunnel, FLOOR_HEIGHT, HILLS[1], ROCK, rng)
        owner = builder.add(ObjectClass.STRUCTURE, mesh)
        for outline, bottom, top in tunnel_prisms(tunnel, FLOOR_HEIGHT):
            builder.add_prism(outline, bottom, top, owner)
        turn = float(exact.atan2(tunnel.along[1], tunnel.along[0]))
        for at in (-11.0, 11.0):
            spot = tunnel.placed(np.array([at, 0.0]))
            builder.add_copy(ObjectClass.STRUCTURE, case, (*spot.tolist(), 6.75), turn, 1.0, owner)
            position.append((*spot.tolist(), 6.6))
    down = np.tile([0.0, 0.0, -1.0], (len(position), 1))
    return Lamps(np.array(position, np.float32).reshape(-1, 3), down.astype(np.float32))


def _add_ground(
    builder: SceneBuilder, plan: Plan, network: RoadNetwork, hills: shapely.Geometry, seed: int
) -> None:
    paint = markings.road_paint(network, centre=markings.Centre.DOUBLE_YELLOW, crossings=False)
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint))
    wear = road_wear.road_wear(network, stream(seed, "village road wear"))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(plan.roads))
    passages = shapely.union_all([tunnel.passage for tunnel in plan.tunnels])
    beside = shapely.buffer(plan.roads, 1.4, quad_segs=4)
    paved = _paving(plan)
    verge = shapely.difference(shapely.union(beside, passages), shapely.union(plan.roads, paved))
    shore = shapely.difference(shapely.buffer(plan.lake, 2.6), plan.lake)
    # Slightly below the hills' feet, so that rounding leaves no gap between them.
    rest = shapely.buffer(hills, -0.4, join_style="mitre")
    lawn = shapely.difference(
        EXTENT, shapely.union_all([plan.roads, paved, verge, shore, plan.lake, rest])
    )
    builder.add(
        ObjectClass.GROUND,
        *_meadow(lawn, stream(seed, "village meadow")),
        surface(
            shapely.intersection(verge, passages),
            FLOOR_HEIGHT,
            without_snow(VERGE),
            TEXTURES[VERGE.texture],
        ),
        surface(shapely.difference(verge, passages), FLOOR_HEIGHT, VERGE, TEXTURES[VERGE.texture]),
        surface(shore, FLOOR_HEIGHT, SHORE, TEXTURES[SHORE.texture]),
        skirt(shore, FLOOR_HEIGHT - 0.3, FLOOR_HEIGHT, SHORE, TEXTURES[SHORE.texture]),
        far_plain((2 * HALF, 2 * HALF), GRASS),
    )
    slabs = material("paving", (0.95, 0.94, 0.92))
    builder.add(ObjectClass.PAVEMENT, surface(paved, FLOOR_HEIGHT, slabs, TEXTURES["paving"]))
    water = surface(plan.lake, FLOOR_HEIGHT - 0.2, WATER, TEXTURES["water"])
    builder.add(ObjectClass.WATER, water)


def _meadow(lawn: shapely.Geometry, rng: np.random.Generator) -> list[Mesh]:
    """Return the grass of the valley, with drier and lusher patches."""
    made = []
    for cover in MEADOWS:
        spots = rng.uniform(-_CORE, _CORE, (_PATCHES, 2))
        shapes = [
            blob(spot, (rng.uniform(8.0, 34.0), rng.uniform(6.0, 16.0)), rng.uniform(0, 3.1), rng)
            for spot in spots
        ]
        patch = shapely.intersection(lawn, shapely.union_all(shapes))
        lawn = shapely.difference(lawn, patch)
        made.append(surface(patch, FLOOR_HEIGHT, cover, TEXTURES[cover.texture]))
    return [surface(lawn, FLOOR_HEIGHT, GRASS, TEXTURES[GRASS.texture]), *made]


def _paving(plan: Plan) -> shapely.Geometry:
    """Return the paving round the houses and from their doors to the roads [m]."""
    parts = []
    for house in plan.cottages:
        shape = shapely.Polygon(house.outline)
        front = np.array([-exact.sin(house.turn), exact.cos(house.turn)])
        reach = [house.place, house.place + 24.0 * front]
        path = shapely.buffer(shapely.LineString(reach), 1.9, cap_style="flat")
        parts += [shapely.buffer(shape, 1.8, join_style="mitre"), path]
    return shapely.difference(shapely.union_all(parts), plan.roads)


def _add_plants(
    builder: SceneBuilder, plan: Plan, hills: shapely.Geometry, rng: np.random.Generator
) -> None:
    """Add the rows of trees, hedges round the gardens, and bushes in the valley."""
    kinds = [
        builder.prototype(f"cone tree {k}", partial(cone_tree_levels, rng, k), trees=1)
        for k in range(VARIANTS)
    ]
    for place in plan.trees:
        height, turn = rng.uniform(*_TREE_HEIGHTS), rng.uniform(0, 2 * np.pi)
        kind = kinds[int(rng.integers(len(kinds)))]
        owner = builder.add_copy(ObjectClass.TREE, kind, (*place, FLOOR_HEIGHT), turn, height)
        builder.add_cylinder(place, 0.03 * height, FLOOR_HEIGHT, 0.5 * height, owner)
    plants = {name: builder.prototype(name, make) for name, make in plant_makers(rng).items()}
    hedge = [plants["hedge"]]
    room = shapely.difference(
        shapely.union_all(plan.blocks),
        shapely.union_all([shapely.buffer(_paving(plan), 0.6), shapely.buffer(plan.roads, 1.9)]),
    )
    for house in plan.cottages:
        yard = shapely.buffer(shapely.Polygon(house.outline), 3.1, join_style="mitre")
        ring = shapely.get_coordinates(yard)
        for start, end in pairwise(ring):
            gardens.add_row(builder, hedge, np.array([start, end]), room, FLOOR_HEIGHT, rng)
    thin = shapely.buffer(shapely.union_all(shapely.points(plan.trees)), 4.0)
    yards = shapely.buffer(plan.walls, 6.0)
    taken = [yards, shapely.buffer(plan.lake, 3.4), plan.covered, hills, thin]
    open_land = shapely.difference(
        shapely.intersection(EXTENT, shapely.buffer(plan.roads, 60.0)),
        shapely.union_all([shapely.buffer(plan.roads, 5.0), *taken]),
    )
    bushes = [plants["border"], plants["low border"], plants["tall border"]]
    for spot in gardens.scattered(open_land, *_BUSHES, rng):
        kind, turn = bushes[int(rng.integers(3))], rng.uniform(0, 2 * np.pi)
        size = rng.uniform(0.7, 1.3)
        builder.add_copy(ObjectClass.TREE, kind, (*spot.tolist(), FLOOR_HEIGHT), turn, size)


def _taken(plan: Plan, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    poles = [place for place, _ in signal_places(network)]
    signs = [place for place, _ in plan.gantries]
    thin = shapely.buffer(shapely.points([*plan.trees, *poles]), 2.0)
    wide = shapely.buffer(shapely.points(signs), 12.0)
    covered = shapely.buffer(plan.covered, 4.0)
    return shapely.union_all([plan.roads, plan.walls, plan.lake, covered, *thin, *wide])
