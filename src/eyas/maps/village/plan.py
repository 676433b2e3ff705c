"""The plan of the village."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import facade, material, without_snow
from eyas.engine.world.build.millimetres import rounded, snapped
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.street.signals import signal_places, signals_along
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.land.relief import Relief, heights_of, relief_of
from eyas.maps.plan.library import CLUTTER_KINDS, STREET_KINDS, houses, plant_kinds, wild_kinds
from eyas.maps.plan.plan import (
    Chance,
    Far,
    Flat,
    GroundCover,
    Hills,
    Layer,
    MapPlan,
    Paint,
    Roadway,
    ThingKind,
    Tunnels,
    state_of,
    things,
)
from eyas.maps.plants import gardens
from eyas.maps.plants.trees import CONES
from eyas.maps.street import gantries
from eyas.maps.street.dressing import VILLAGE_KERBS, DressedGround, along_kerbs
from eyas.maps.street.lamps import lamps_along
from eyas.maps.village.layout import EXTENT, FLOOR, HALF, VillageLayout, lay_out
from eyas.maps.village.roads import NAME
from eyas.maps.village.scenery import grown, trodden, yard_things

GRASS = replace(material("lawn", (0.86, 0.93, 0.90)), surface=Surface.HILLSIDE)
"""The valley and its hills."""

_VERGE = material("roof_gravel", (0.86, 0.82, 0.74))
_SHORE = replace(GRASS, surface=Surface.HILLSIDE_SHORE)
_BANK = material("soil", (0.60, 0.56, 0.50))
_SHOULDER = replace(GRASS, surface=Surface.HILLSIDE_VERGE)
_PATH = replace(GRASS, surface=Surface.HILLSIDE_PATH)
_ROCK = material("stone", (0.50, 0.52, 0.47))  # Inside of the tunnels

_WATER = Material("water", (0.20, 0.32, 0.38), Surface.WATER)

_HOUSES = (
    (facade("facade_concrete", (1.0, 1.0, 1.0)), material("roof_tiles", (1.0, 0.96, 0.94))),
    (facade("facade_plaster", (0.88, 0.94, 1.0)), material("roof_tiles", (0.96, 0.88, 0.84))),
    (facade("facade_concrete", (1.0, 0.99, 0.97)), material("roof_tiles", (1.0, 0.92, 0.86))),
)

VALLEY = Horizon(name="village", height=0.05, woods=0.6)  # What stands beyond the hills

_LAMPS = 47  # Street lamps, and two in each tunnel
_CORE = 345.0  # Half the side of the square with the smaller facets [m]
_FACETS = (6.5, 12.5)  # Distance between the corners of facets in the middle and outside of it [m]
_ROUGH = 0.045
"""Most by which a corner lies above or below the smooth shape, as a share of its height."""
_WOODS, _WOOD_TREES, _WOOD_RADIUS = 40, (5, 14), 24.0
"""Number of groups of trees on the hills, of trees in each, and radius of a group [m]."""
_BESIDE_WOODS, _FARTHEST_WOODS = 30.0, 240.0
"""Least and largest distance of these trees from a road [m]."""
_ROOTS = 0.5  # Depth of a trunk's foot in a slope [m]
_BUSHES = (26.0, 0.004)
"""Least distance between two bushes [m], and number of attempts on a square metre."""
_TREE_HEIGHTS = (10.0, 11.8)
_WOOD_HEIGHTS = (5.0, 11.0)
_SHORE_WIDTH = 5.0
_WILD = (*wild_kinds("green tuft", "dry tuft"), *wild_kinds("stones", "boulder", looks=(2, 3)))
_CONES = tuple(f"cone tree {k}" for k in range(CONES))


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the village."""
    valley = lay_out(network, seed)
    hills = _hills(valley)
    relief = relief_of(hills, seed)
    rising = relief.area
    kinds, placed = houses(valley.cottages, _HOUSES)
    rng = stream(seed, "village plants")
    plants = _plants(valley, rising, rng)
    ground, paths = _ground(valley, rising, seed)
    closed = [*paths, _paving(valley), shapely.buffer(valley.lake, 3.0), valley.walls]
    wild = grown(
        valley, relief, shapely.union_all([*closed, valley.covered]), stream(seed, "village grass")
    )
    woods = _woods(valley, relief, stream(seed, "village woods"))
    signs = _signs(valley, stream(seed, "village signs"))
    count, taken = _LAMPS - 2 * len(valley.tunnels), _taken(valley, network)
    lamps = lamps_along(network, count, taken, stream(seed, "village lamps"))
    clutter = _clutter(valley, network, rising, [*plants, *lamps], seed)
    tunnels = Tunnels(
        items=tuple(valley.tunnels),
        outside=GRASS,
        inside=_ROCK,
        chance=Chance(stream="village mounds"),
    )
    wild_names = [kind.name for kind in _WILD]
    gantry_kinds = (
        ThingKind(name=f"gantry {k}", make="gantry", variant=k) for k in range(gantries.KINDS)
    )
    cones = (
        ThingKind(name=name, make="cone tree", variant=k, chance="plants")
        for k, name in enumerate(_CONES)
    )
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(
            *kinds,
            *cones,
            *plant_kinds("plants"),
            *STREET_KINDS,
            *gantry_kinds,
            *_WILD,
            *CLUTTER_KINDS,
        ),
        chances={"plants": state_of(rng)},
        layers=(
            hills,
            tunnels,
            things(placed),
            *ground,
            things([*plants, *woods], (*_CONES, *(kind.name for kind in plant_kinds("plants")))),
            things(signals_along(network)),
            things(signs),
            things(lamps),
            things(clutter),
            things(wild, wild_names),
        ),
        horizon=VALLEY,
    )


def _hills(valley: VillageLayout) -> Hills:
    """Return the hills."""
    passages = [shapely.buffer(tunnel.passage, 0.5) for tunnel in valley.tunnels]
    trunks = shapely.buffer(shapely.union_all(shapely.points(valley.trees)), 1.5)
    flat = [shapely.buffer(valley.roads, 6.0), shapely.buffer(valley.walls, 4.0)]
    return Hills(
        mounds=tuple(valley.hills),
        flat=shapely.union_all([*flat, shapely.buffer(valley.lake, 4.0), trunks, *passages]),
        half=(_CORE, HALF),
        spacing=_FACETS,
        rough=_ROUGH,
        chance=Chance(stream="village facets"),
        covers=(GRASS,),
        smooth=True,
    )


def _ground(
    valley: VillageLayout, hills: shapely.Geometry, seed: int
) -> tuple[list[Layer], list[shapely.Polygon]]:
    """Return roads, paving, lawn and water, and the paths on the lawn."""
    roads, lake = valley.roads, valley.lake
    passages = shapely.union_all([tunnel.passage for tunnel in valley.tunnels])
    beside = shapely.buffer(roads, 1.4, quad_segs=4)
    paved = _paving(valley)
    verge = shapely.difference(shapely.union(beside, passages), shapely.union(roads, paved))
    shore = shapely.difference(
        shapely.buffer(lake, _SHORE_WIDTH), shapely.union_all([lake, roads, paved, verge])
    )
    # Slightly below the hills' feet, so that rounding leaves no gap between them.
    rest = shapely.buffer(hills, -0.4, join_style="mitre")
    lawn = shapely.difference(EXTENT, shapely.union_all([roads, paved, verge, shore, lake, rest]))
    # Paths end where hills begin, not below their feet, which look different.
    paths = trodden(valley, shapely.difference(lawn, hills), stream(seed, "village paths"))
    beaten = snapped(shapely.union_all(paths))
    pieces: tuple[Flat | Far, ...] = (
        Flat(area=shapely.difference(lawn, beaten), cover=GRASS),
        Flat(area=beaten, cover=_PATH),
        Flat(area=shapely.intersection(verge, passages), cover=without_snow(_VERGE)),
        Flat(area=shapely.difference(verge, passages), cover=_SHOULDER, beside=roads),
        Flat(area=shore, cover=_SHORE, beside=lake, sides=_BANK, foot=FLOOR_HEIGHT - 0.3),
        Far(rule="plain", covers=(GRASS,), beyond=(2 * HALF, 2 * HALF)),
    )
    slabs = Flat(area=paved, cover=material("paving", (0.95, 0.94, 0.92)))
    water = Flat(area=lake, z=FLOOR_HEIGHT - 0.2, cover=_WATER)
    layers: list[Layer] = [
        Roadway(
            area=roads,
            paint=Paint(centre="double yellow", crossings=0),
            wear=Chance(stream="village road wear"),
        ),
        GroundCover(pieces=pieces),
        GroundCover(kind=ObjectClass.PAVEMENT, pieces=(slabs,)),
        GroundCover(kind=ObjectClass.WATER, pieces=(water,)),
    ]
    return layers, paths


def _paving(valley: VillageLayout) -> shapely.Geometry:
    """Return the paving round the houses and from their doors to the roads [m]."""
    parts = []
    for house in valley.cottages:
        shape = shapely.Polygon(house.outline)
        front = np.array([-exact.sin(house.turn), exact.cos(house.turn)])
        reach = [house.place, house.place + 24.0 * front]
        path = shapely.buffer(shapely.LineString(reach), 1.9, cap_style="flat")
        parts += [shapely.buffer(shape, 1.8, join_style="mitre"), path]
    return shapely.difference(shapely.union_all(parts), valley.roads)


def _plants(
    valley: VillageLayout, hills: shapely.Geometry, rng: np.random.Generator
) -> list[Placed]:
    """Return the rows of trees, hedges round the gardens, and bushes in the valley."""
    made = []
    for x, y in valley.trees.tolist():
        height, turn = rng.uniform(*_TREE_HEIGHTS), rng.uniform(0, 2 * np.pi)
        kind = _CONES[int(rng.integers(len(_CONES)))]
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, height))
    room = shapely.difference(
        shapely.union_all(valley.blocks),
        shapely.union_all(
            [shapely.buffer(_paving(valley), 0.6), shapely.buffer(valley.roads, 1.9)]
        ),
    )
    for house in valley.cottages:
        yard = shapely.buffer(shapely.Polygon(house.outline), 3.1, join_style="mitre")
        for side in pairwise(shapely.get_coordinates(yard)):
            made += gardens.row(("hedge",), np.array(side), room, FLOOR_HEIGHT, rng)
    thin = shapely.buffer(shapely.union_all(shapely.points(valley.trees)), 4.0)
    yards = shapely.buffer(valley.walls, 6.0)
    taken = [yards, shapely.buffer(valley.lake, 3.4), valley.covered, hills, thin]
    open_land = shapely.difference(
        shapely.intersection(EXTENT, shapely.buffer(valley.roads, 60.0)),
        shapely.union_all([shapely.buffer(valley.roads, 5.0), *taken]),
    )
    for x, y in gardens.scattered(open_land, *_BUSHES, rng).tolist():
        kind, turn = gardens.BORDERS[int(rng.integers(3))], rng.uniform(0, 2 * np.pi)
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, rng.uniform(0.7, 1.3)))
    return made


def _woods(valley: VillageLayout, ground: Relief, rng: np.random.Generator) -> list[Placed]:
    """Return groups of trees on the hills, far enough from roads to hide none."""
    ways = shapely.union_all([valley.roads, valley.covered, valley.walls])
    room = shapely.intersection(
        shapely.difference(
            shapely.buffer(ways, _FARTHEST_WOODS), shapely.buffer(ways, _BESIDE_WOODS)
        ),
        ground.area,
    )
    middles = gardens.scattered(room, 2.0 * _WOOD_RADIUS, 0.002, rng)
    middles = middles[rng.permutation(len(middles))[:_WOODS]]
    made = []
    for middle in middles:
        count = int(rng.integers(*_WOOD_TREES, endpoint=True))
        away = _WOOD_RADIUS * np.sqrt(rng.uniform(0.0, 1.0, count))
        turn = rng.uniform(0.0, 2 * np.pi, count)
        spots = middle + away[:, None] * np.column_stack([exact.cos(turn), exact.sin(turn)])
        spots = rounded(spots[shapely.contains_xy(room, spots)])
        feet = rounded(heights_of(ground, spots) + FLOOR_HEIGHT - _ROOTS)
        for (x, y), z in zip(spots.tolist(), feet.tolist(), strict=True):
            kind, height = _CONES[int(rng.integers(len(_CONES)))], rng.uniform(*_WOOD_HEIGHTS)
            made.append(Placed(kind, x, y, z, rng.uniform(0, 2 * np.pi), height))
    return made


def _signs(valley: VillageLayout, rng: np.random.Generator) -> list[Placed]:
    """Return the gantries with their boards."""
    made = []
    for index, (place, turn) in enumerate(valley.gantries):
        kind = int((index + rng.integers(2)) % gantries.KINDS)
        made.append(Placed.at(f"gantry {kind}", place, 0.0, turn))
    return made


def _clutter(
    valley: VillageLayout,
    network: RoadNetwork,
    rising: shapely.Geometry,
    standing: list[Placed],
    seed: int,
) -> list[Placed]:
    """Return what lies about along roads and about houses, clear of what stands there already."""
    thin = shapely.buffer(shapely.points([[one.x, one.y] for one in standing]), 1.4, quad_segs=2)
    steep = shapely.buffer(shapely.union(rising, valley.covered), 1.0)
    taken = shapely.union_all([_taken(valley, network), steep, *thin])
    verge = shapely.difference(shapely.buffer(valley.roads, 1.4, quad_segs=4), taken)
    open_road = shapely.difference(valley.roads, shapely.buffer(valley.covered, 1.0))
    for area in (verge, open_road):
        shapely.prepare(area)
    rng = stream(seed, "village clutter")
    grounds = {"road": DressedGround(open_road, 0.0), "verge": DressedGround(verge, FLOOR_HEIGHT)}
    beside = along_kerbs(network, grounds, VILLAGE_KERBS, rng)
    free = shapely.difference(shapely.union_all(valley.blocks), taken)
    return [*beside, *yard_things(valley.cottages, valley.roads, free, rng)]


def _taken(valley: VillageLayout, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    poles = [place for place, _ in signal_places(network)]
    signs = [place for place, _ in valley.gantries]
    thin = shapely.buffer(shapely.points([*valley.trees, *poles]), 2.0)
    wide = shapely.buffer(shapely.points(signs), 12.0)
    covered = shapely.buffer(valley.covered, 4.0)
    return shapely.union_all([valley.roads, valley.walls, valley.lake, covered, *thin, *wide])
