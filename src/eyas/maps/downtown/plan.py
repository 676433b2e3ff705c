"""The plan of downtown."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import facade, material
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import joints, streets
from eyas.engine.world.street.signals import signal_places, signals_along
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.buildings.towers import STOREY
from eyas.maps.downtown.layout import EXTENT, FLOOR, DowntownLayout, facade_of, lay_out, roof_of
from eyas.maps.downtown.roads import NAME, Grid
from eyas.maps.downtown.scenery import DowntownScenery, Kerbs, Park, crossing_lamps, scenery_of
from eyas.maps.land import ground
from eyas.maps.plan.library import (
    CAR_KINDS,
    CLUTTER_KINDS,
    FURNITURE_KINDS,
    STREET_KINDS,
    plant_kinds,
)
from eyas.maps.plan.plan import (
    Backdrop,
    Building,
    Buildings,
    Chance,
    Far,
    Flat,
    GroundCover,
    LampLight,
    Layer,
    MapPlan,
    Paint,
    Paved,
    Railway,
    Roadway,
    Skyways,
    ThingKind,
    Things,
    state_of,
    things,
)
from eyas.maps.plants import gardens
from eyas.maps.street import lamps
from eyas.maps.street.dressing import CITY_KERBS, SHOP_FRONTS, DressedGround, along_kerbs, at_fronts
from eyas.maps.street.furniture import FURNITURE, furniture_along
from eyas.maps.street.parked_cars import CARS
from eyas.maps.things.subway import LONG, WIDE

_STEP = (72.0, 66.0)
"""Distances between the middles of neighbours, along the streets and the avenues [m]."""
_REACH = 420.0  # Distance from the outermost roads to the farthest [m]
_BACKDROP_APART = 36.0  # Least distance from blocks, fronts and the park [m]
_FROM_EDGE = 30.0
_SHARE = 0.7  # Share of the places that are built on
_SIDES = (17.0, 40.0)
_MEDIAN, _SPREAD, _HIGHEST = 26.0, 0.75, 150.0
"""Median height [m], spread of its logarithm, and limit [m]."""

_KERB_WIDTH = 0.8  # Width of kerbs, as in the original [m]
_KERB = material("paving", (1.0, 0.94, 0.90))
_SLABS = material("paving", (0.84, 0.91, 0.95))
_COURT = material("concrete", (0.97, 0.97, 0.93))
_TRAIL = material("asphalt_light", (1.0, 0.97, 0.90))
_RIM = material("stone", (0.98, 0.95, 0.92))
_WATER = Material("water", (0.18, 0.34, 0.38), Surface.WATER)
_STONES = material("stone", (0.80, 0.78, 0.76))
_WALL, _WALL_TOP = 0.5, 1.0  # Thickness of the wall around the park, and z of its top [m]
_LAND = (
    material("concrete", (0.90, 0.90, 0.87)),
    material("concrete", (0.80, 0.80, 0.79)),
    material("asphalt_light", (1.0, 0.99, 0.96)),
    material("lawn", (0.84, 0.90, 0.80)),
)
"""What covers the land around: courts, yards, car parks, some lawn."""
_LAND_SHARES = (0.34, 0.26, 0.2, 0.2)


def _surfaces(city: DowntownLayout, scenery: DowntownScenery, seed: int) -> list[Layer]:
    """Return paint, roads, pavements, courts, the park and the land around."""
    park, turn, rng = scenery.park, city.grid.turn, stream(seed, "downtown lawn")
    bays = shapely.difference(scenery.kerbs.bays, city.roads)
    wet = shapely.union(park.water, park.rim)
    green = shapely.difference(park.ground, shapely.union_all([park.walk, park.paths, wet]))
    nowhere = shapely.Polygon()
    lawn = ground.lawn(park.ground, shapely.difference(EXTENT, green), rng, nowhere, 0.0)
    land = Far(rule="city", covers=_LAND, shares=_LAND_SHARES, chance=state_of(rng))
    covered = shapely.union_all([city.roads, bays, scenery.pavement, park.ground])
    court = Flat(area=shapely.difference(EXTENT, covered), cover=_COURT, turn=turn)
    ponds = (Flat(area=pond, z=-0.15, cover=_WATER) for pond in shapely.get_parts(park.water))
    return [
        Roadway(
            area=city.roads,
            bays=bays,
            paint=Paint(shapes=tuple(scenery.kerbs.lines)),
            wear=Chance(stream="downtown road wear"),
        ),
        _paved(scenery.pavement, shapely.union(city.roads, bays), turn, _SLABS),
        GroundCover(pieces=tuple(lawn)),
        GroundCover(kind=ObjectClass.PAVEMENT, pieces=(Flat(area=park.paths, cover=_TRAIL),)),
        _paved(park.rim, nowhere, 0.0, _RIM),
        *(GroundCover(kind=ObjectClass.WATER, pieces=(pond,)) for pond in ponds),
        GroundCover(kind=ObjectClass.STRUCTURE, pieces=(_park_wall(city.grid, scenery.park),)),
        GroundCover(pieces=(court, land)),
    ]


def _paved(area: shapely.Geometry, road: shapely.Geometry, turn: float, slabs: Material) -> Paved:
    return Paved(area=area, beside=road, slabs=slabs, kerb=_KERB, kerb_width=_KERB_WIDTH, turn=turn)


def _park_wall(grid: Grid, park: Park) -> Flat:
    """Return the low wall between the streets and the park, with gaps where paths enter."""
    line = shapely.intersection(shapely.buffer(park.walk, _WALL, join_style="mitre"), park.ground)
    gates = shapely.buffer(park.paths, 0.6)
    wall = shapely.difference(line, shapely.union(park.walk, gates))
    return Flat(area=wall, z=_WALL_TOP, cover=_RIM, turn=grid.turn, sides=_STONES)


def _backdrop(grid: Grid, city: shapely.Geometry, rng: np.random.Generator) -> Backdrop:
    """Return the city beyond the outer streets, clear of roads, fronts and the park."""
    free = shapely.difference(
        shapely.buffer(EXTENT, -_FROM_EDGE), shapely.buffer(city, _BACKDROP_APART)
    )
    shapely.prepare(free)
    u = np.arange(grid.avenues[0] - _REACH, grid.avenues[-1] + _REACH, _STEP[0])
    v = np.arange(grid.streets[0] - _REACH, grid.streets[-1] + _REACH, _STEP[1])
    places = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    places += rng.uniform(-9.0, 9.0, places.shape)
    made: list[tuple[NDArray[np.float64], float, Material, Material, NDArray[np.int64]]] = []
    for place in places:
        side = np.round(rng.uniform(*_SIDES, 2) / 3.0) * 1.5
        height = min(_MEDIAN * float(exact.exp(exact.normal(rng, 0.0, _SPREAD))), _HIGHEST)
        top = FLOOR_HEIGHT + STOREY * max(round(height / STOREY), 2)
        corners = place + side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        outline = grid.world(corners)
        if rng.random() < _SHARE and shapely.contains(free, shapely.Polygon(outline)):
            walls, roof = facade(*facade_of(top, rng)), roof_of(rng)
            made.append((outline, top, walls, roof, rng.integers(0, 4, (4, 2))))
    outlines, tops, walls_, roofs, bays = zip(*made, strict=True) if made else ((),) * 5
    return Backdrop(
        outlines=outlines, tops=np.array(tops, np.float64), walls=walls_, roofs=roofs, bays=bays
    )


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
    """Return the plan of downtown."""
    city = lay_out(network, seed)
    scenery = scenery_of(network, city, seed)
    buildings = (
        Building(parts=tuple(parts), fittings=("fronts", "tank", "roof units"))
        for parts in city.buildings
    )
    fronts = [shapely.Polygon(corners) for corners in city.footprints]
    built = shapely.union_all([city.roads, scenery.park.ground, city.viaduct.ground, *fronts])
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
            Skyways(items=tuple(scenery.skyways)),
            _backdrop(city.grid, built, stream(seed, "downtown backdrop")),
            *_surfaces(city, scenery, seed),
            things(_trees(scenery, stream(seed, "downtown trees")), (*_GREAT, *_SLIM, *_SHRUBS)),
            *_along_streets(city, scenery, network, seed),
            things(_parked(scenery.kerbs, stream(seed, "downtown parked cars")), (*CARS, _TAXI)),
            things(_in_park(scenery.park)),
        ),
        lamps=_LIGHT,
    )  # fmt: skip


def _trees(scenery: DowntownScenery, rng: np.random.Generator) -> list[Placed]:
    """Return the trees along two streets and in the park, and its shrubs."""
    made = []
    for trunks, kinds, heights, z in (
        (scenery.kerbs.great_trees, _GREAT, _GREAT_HEIGHTS, KERB_HEIGHT),
        (scenery.kerbs.slim_trees, _SLIM, _SLIM_HEIGHTS, KERB_HEIGHT),
        (scenery.park.trees, _GREAT, _PARK_HEIGHTS, FLOOR_HEIGHT),
    ):
        made += gardens.small_trees(trunks, heights, z, kinds, rng)
    for x, y, turn in scenery.park.shrubs.tolist():
        kind = _SHRUBS[int(rng.integers(len(_SHRUBS)))]
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, turn, float(rng.uniform(0.9, 1.5))))
    return made


def _along_streets(
    city: DowntownLayout, scenery: DowntownScenery, network: RoadNetwork, seed: int
) -> list[Things]:
    """Return signals, lamps, entrances of the subway, furniture and clutter."""
    rng = stream(seed, "downtown furniture")
    lit = crossing_lamps(network, lamps.BEYOND_KERB)
    lights = [Placed.at("street lamp", foot, KERB_HEIGHT, turn) for foot, turn in lit]
    feet = np.array([foot for foot, _ in lit])
    poles = [place for place, _ in signal_places(network)]
    trunks = [*scenery.kerbs.great_trees, *scenery.kerbs.slim_trees, *city.viaduct.feet]
    thin = shapely.buffer(shapely.points([*feet, *poles, *trunks]), 1.6)
    taken = shapely.union_all([city.roads, scenery.kerbs.bays, *thin])
    entrances = _entrances(network, taken, rng)
    room = [shapely.Point(one.x, one.y).buffer(0.5 * LONG + 0.3) for one in entrances]
    taken = shapely.union(taken, shapely.union_all(room))
    furnished = furniture_along(network, scenery.pavement, taken, KERB_HEIGHT, rng)
    clutter = _clutter(city, scenery, network, taken, furnished, stream(seed, "downtown clutter"))
    return [
        things(signals_along(network)),
        things(lights),
        things(entrances, ("subway entrance",)),
        things(furnished, tuple(FURNITURE)),
        things(clutter),
    ]


def _clutter(
    city: DowntownLayout,
    scenery: DowntownScenery,
    network: RoadNetwork,
    taken: shapely.Geometry,
    furnished: list[Placed],
    rng: np.random.Generator,
) -> list[Placed]:
    """Return the clutter of the streets, clear of what stands there already."""
    thin = shapely.buffer(shapely.points([[one.x, one.y] for one in furnished]), 1.3, quad_segs=2)
    paved = shapely.difference(scenery.pavement, shapely.union_all([taken, *thin]))
    ways = shapely.union(city.roads, scenery.kerbs.bays)
    back = shapely.difference(paved, shapely.buffer(ways, 2.45))
    asphalt = shapely.difference(city.roads, shapely.buffer(scenery.kerbs.bays, 0.3))
    for area in (paved, back, asphalt):
        shapely.prepare(area)
    behind = DressedGround(back, KERB_HEIGHT)
    grounds = {"road": DressedGround(asphalt, 0.0), "pavement": DressedGround(paved, KERB_HEIGHT)}
    beside = along_kerbs(network, {**grounds, "behind": behind}, CITY_KERBS, rng, _APART)
    return [*beside, *at_fronts(city.footprints, behind, SHOP_FRONTS, rng, _APART)]


def _entrances(
    network: RoadNetwork, keep_free: shapely.Geometry, rng: np.random.Generator
) -> list[Placed]:
    """Return entrances of the subway beside the ends of wide roads."""
    meeting, made = joints(network), []
    for street in streets(network):
        end = street.right[-1]
        onwards = unit(end - street.right[-2])
        place = rounded(end - _FROM_END * onwards - _BEYOND * street.inwards(onwards))
        wide = len(street.dividers) > 0 and meeting[street.end] >= 3
        room = shapely.Point(place).buffer(0.5 * WIDE + 0.4)
        if wide and rng.random() < _ENTRANCES and not shapely.intersects(keep_free, room):
            turn = float(exact.atan2(onwards[1], onwards[0]))
            made.append(Placed.at("subway entrance", place, KERB_HEIGHT, turn))
    return made


def _parked(kerbs: Kerbs, rng: np.random.Generator) -> list[Placed]:
    """Return cars in the bays; every fifth is a yellow taxi."""
    made = []
    for x, y, heading in kerbs.cars.tolist():
        car = _TAXI if rng.random() < _TAXIS else CARS[int(rng.integers(len(CARS)))]
        made.append(Placed(car, x, y, 0.0, heading, float(rng.uniform(0.94, 1.04))))
    return made


def _in_park(park: Park) -> list[Placed]:
    """Return benches along the paths, and the fountain."""
    benches = [
        Placed("bench", x, y, FLOOR_HEIGHT, facing - np.pi / 2)
        for x, y, facing in park.benches.tolist()
    ]
    return [*benches, Placed.at("fountain", park.fountain, FLOOR_HEIGHT)]
