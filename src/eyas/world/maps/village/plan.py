"""The plan of the village."""

from itertools import pairwise

import numpy as np
import shapely

from eyas.core import exact
from eyas.core.rng import stream
from eyas.state.lighting import Horizon
from eyas.state.mesh import Material, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import facade, material, without_snow
from eyas.world.build.placed import Placed
from eyas.world.land.outlines import blob
from eyas.world.land.rising import relief_of
from eyas.world.maps.village.layout import EXTENT, FLOOR, HALF, VillageLayout, lay_out
from eyas.world.maps.village.roads import NAME
from eyas.world.plan.library import STREET_KINDS, houses, plant_kinds
from eyas.world.plan.plan import (
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
from eyas.world.plants import gardens
from eyas.world.plants.cones import VARIANTS
from eyas.world.street import gantries
from eyas.world.street.lamps import lamps_along
from eyas.world.street.signals import signal_places, signals_along

__all__ = ["GRASS", "VALLEY", "make_plan"]

GRASS = material("lawn", (0.61, 0.74, 0.74))
"""The valley."""

_MEADOWS = (material("lawn", (0.70, 0.76, 0.66)), material("lawn", (0.54, 0.68, 0.69)))
"""Patches of drier and of lusher grass."""

_HILLS = (
    material("lawn", (0.62, 0.77, 0.77)),
    material("lawn", (0.66, 0.82, 0.84)),
    material("lawn", (0.70, 0.87, 0.91)),
    material("lawn", (0.75, 0.91, 0.96)),
)
"""Greens of the hills, from the foot up."""

_VERGE = material("roof_gravel", (0.86, 0.82, 0.74))
_SHORE = material("sand", (0.80, 0.78, 0.70))
_ROCK = material("stone", (0.50, 0.52, 0.47))
"""Inside of the tunnels."""

_WATER = Material("water", (0.20, 0.44, 0.72), Surface.WATER)

_HOUSES = (
    (facade("facade_concrete", (1.0, 1.0, 1.0)), material("roof_tiles", (1.0, 0.96, 0.94))),
    (facade("facade_plaster", (0.88, 0.94, 1.0)), material("roof_tiles", (0.96, 0.88, 0.84))),
    (facade("facade_concrete", (1.0, 0.99, 0.97)), material("roof_tiles", (1.0, 0.92, 0.86))),
)

VALLEY = Horizon(name="village", height=0.05, woods=0.6)
"""What stands beyond the hills."""

_LAMPS = 47
"""Street lamps, and two in each tunnel."""
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
_CONES = tuple(f"cone tree {k}" for k in range(VARIANTS))


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the village.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    valley = lay_out(network, seed)
    hills = _hills(valley)
    rising = relief_of(hills, seed).area
    kinds, placed = houses(valley.cottages, _HOUSES)
    rng = stream(seed, "village plants")
    plants = _plants(valley, rising, rng)
    signs = _signs(valley, stream(seed, "village signs"))
    lamps, taken = _LAMPS - 2 * len(valley.tunnels), _taken(valley, network)
    tunnels = Tunnels(
        items=tuple(valley.tunnels),
        outside=_HILLS[1],
        inside=_ROCK,
        chance=Chance(stream="village mounds"),
    )
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
        library=(*kinds, *cones, *plant_kinds("plants"), *STREET_KINDS, *gantry_kinds),
        chances={"plants": state_of(rng)},
        layers=(
            hills,
            tunnels,
            things(placed),
            *_ground(valley, rising, seed),
            things(plants, (*_CONES, *(kind.name for kind in plant_kinds("plants")))),
            things(signals_along(network)),
            things(signs),
            things(lamps_along(network, lamps, taken, stream(seed, "village lamps"))),
        ),
        horizon=VALLEY,
    )


def _hills(valley: VillageLayout) -> Hills:
    """Return the hills as facets; each has one of a few greens, lighter and drier higher up."""
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
        covers=_HILLS,
        shades=Chance(stream="village grass"),
    )


def _ground(valley: VillageLayout, hills: shapely.Geometry, seed: int) -> list[Layer]:
    roads, lake = valley.roads, valley.lake
    passages = shapely.union_all([tunnel.passage for tunnel in valley.tunnels])
    beside = shapely.buffer(roads, 1.4, quad_segs=4)
    paved = _paving(valley)
    verge = shapely.difference(shapely.union(beside, passages), shapely.union(roads, paved))
    shore = shapely.difference(shapely.buffer(lake, 2.6), lake)
    # Slightly below the hills' feet, so that rounding leaves no gap between them.
    rest = shapely.buffer(hills, -0.4, join_style="mitre")
    lawn = shapely.difference(EXTENT, shapely.union_all([roads, paved, verge, shore, lake, rest]))
    pieces: tuple[Flat | Far, ...] = (
        *_meadow(lawn, stream(seed, "village meadow")),
        Flat(area=shapely.intersection(verge, passages), cover=without_snow(_VERGE)),
        Flat(area=shapely.difference(verge, passages), cover=_VERGE),
        Flat(area=shore, cover=_SHORE, sides=_SHORE, foot=FLOOR_HEIGHT - 0.3),
        Far(rule="plain", covers=(GRASS,), beyond=(2 * HALF, 2 * HALF)),
    )
    slabs = Flat(area=paved, cover=material("paving", (0.95, 0.94, 0.92)))
    water = Flat(area=lake, z=FLOOR_HEIGHT - 0.2, cover=_WATER)
    return [
        Roadway(
            area=roads,
            paint=Paint(centre="double yellow", crossings=0),
            wear=Chance(stream="village road wear"),
        ),
        GroundCover(pieces=pieces),
        GroundCover(kind=ObjectClass.PAVEMENT, pieces=(slabs,)),
        GroundCover(kind=ObjectClass.WATER, pieces=(water,)),
    ]


def _meadow(lawn: shapely.Geometry, rng: np.random.Generator) -> list[Flat]:
    """Return the grass of the valley, with drier and lusher patches."""
    made = []
    for cover in _MEADOWS:
        spots = rng.uniform(-_CORE, _CORE, (_PATCHES, 2))
        shapes = [
            blob(spot, (rng.uniform(8.0, 34.0), rng.uniform(6.0, 16.0)), rng.uniform(0, 3.1), rng)
            for spot in spots
        ]
        patch = shapely.intersection(lawn, shapely.union_all(shapes))
        lawn = shapely.difference(lawn, patch)
        made.append(Flat(area=patch, cover=cover))
    return [Flat(area=lawn, cover=GRASS), *made]


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


def _signs(valley: VillageLayout, rng: np.random.Generator) -> list[Placed]:
    """Return the gantries with their boards."""
    made = []
    for index, (place, turn) in enumerate(valley.gantries):
        kind = int((index + rng.integers(2)) % gantries.KINDS)
        made.append(Placed.at(f"gantry {kind}", place, 0.0, turn))
    return made


def _taken(valley: VillageLayout, network: RoadNetwork) -> shapely.Geometry:
    """Return the area where something already stands or drives, in plan view."""
    poles = [place for place, _ in signal_places(network)]
    signs = [place for place, _ in valley.gantries]
    thin = shapely.buffer(shapely.points([*valley.trees, *poles]), 2.0)
    wide = shapely.buffer(shapely.points(signs), 12.0)
    covered = shapely.buffer(valley.covered, 4.0)
    return shapely.union_all([valley.roads, valley.walls, valley.lake, covered, *thin, *wide])
