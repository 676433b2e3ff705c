"""The rest of a map of which only some is known."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import polygons_of, road_area, streets
from eyas.engine.world.street import signals
from eyas.lanes import exact
from eyas.maps.build.apart import SpacedPoints
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.buildings.parts import rings
from eyas.maps.land import ground, outskirts
from eyas.maps.land.relief import relief_of
from eyas.maps.osm.features import Survey
from eyas.maps.plan.library import (
    CAR_KINDS,
    CLUTTER_KINDS,
    FURNITURE_KINDS,
    STREET_KINDS,
    plant_kinds,
)
from eyas.maps.plan.plan import (
    BuildingPart,
    Buildings,
    Chance,
    Far,
    Flat,
    GroundCover,
    Hills,
    Layer,
    MapPlan,
    Paint,
    Paved,
    Roadway,
    ThingKind,
    Walkways,
    state_of,
    things,
)
from eyas.maps.plants import gardens, trees
from eyas.maps.street.car_parks import bays_in
from eyas.maps.street.dressing import TOWN_KERBS, DressedGround, along_kerbs
from eyas.maps.street.furniture import FURNITURE, furniture_along
from eyas.maps.street.lamps import BEYOND_KERB, POLE_RADIUS, lit_by
from eyas.maps.street.parked_cars import CARS
from eyas.maps.towns.buildings import building_of
from eyas.maps.towns.crossings import kept_free, town_paint
from eyas.maps.towns.layout import Occupied, Town, lay_out

_TREES = tuple(f"street tree {k}" for k in range(trees.VARIANTS))
_WATER = Material("water", (0.18, 0.30, 0.33), Surface.WATER)
_WATER_DEPTH = 0.15  # Depth of water below the road [m]
_BELOW_BANK = 0.4  # How far water reaches below its banks, so that no gap is seen [m]

# order: bytes of plans depend on it, since all kinds of ground draw from one stream in turn
_COVERS: dict[str, tuple[ObjectClass, tuple[Material, ...]]] = {
    "plaza": (ObjectClass.PAVEMENT, (material("paving", (0.98, 0.96, 0.92)),)),
    "path": (ObjectClass.PAVEMENT, (material("concrete", (0.97, 0.93, 0.85)),)),
    "pitch": (ObjectClass.GROUND, (material("asphalt_light", (0.86, 0.55, 0.44)),
                                   material("lawn_mown", (0.86, 0.97, 0.84)))),
    "playground": (ObjectClass.GROUND, (material("sand", (0.98, 0.94, 0.86)),)),
    "sand": (ObjectClass.GROUND, (material("sand"),)),
    "rail": (ObjectClass.GROUND, (material("roof_gravel", (0.74, 0.69, 0.64)),)),
    "park": (ObjectClass.GROUND, (material("lawn_mown"),
                                  material("lawn_mown", (0.93, 0.98, 0.90)))),
    "forest": (ObjectClass.GROUND, (material("lawn", (0.66, 0.73, 0.60)),)),
    "scrub": (ObjectClass.GROUND, (material("lawn", (0.84, 0.86, 0.70)),)),
    "grass": (ObjectClass.GROUND, (material("lawn", (0.97, 0.98, 0.92)),)),
    "farmland": (ObjectClass.GROUND, (material("crops"), material("crops_ripe"),
                                      material("soil"))),
    "soil": (ObjectClass.GROUND, (material("soil"),)),
    "industrial": (ObjectClass.PAVEMENT, (material("concrete", (0.80, 0.79, 0.77)),)),
    "commercial": (ObjectClass.PAVEMENT, (material("paving", (0.90, 0.89, 0.88)),)),
    "residential": (ObjectClass.GROUND, (material("lawn_mown", (0.97, 0.97, 0.90)),
                                         material("lawn_mown", (0.92, 0.96, 0.88)))),
}  # fmt: skip
"""Class and materials of each kind of ground; one material is drawn for each area."""

_YARDS = (
    material("concrete", (0.86, 0.85, 0.83)),
    material("paving", (0.88, 0.87, 0.86)),
    material("clinker", (0.93, 0.90, 0.87)),
    material("asphalt_light", (0.97, 0.96, 0.95)),
)
_RAIL = Material(tint=(0.36, 0.33, 0.31))
_GAUGE = 0.72  # Half the distance between the rails of a track [m]
_RAIL_HEIGHT = 0.12
_BESIDE_ROAD, _BESIDE_WALL = 6.0, 4.0
"""Distance from streets with their pavements, and from walls, to the feet of hills [m]."""
_WORN_FROM = 30.0  # Shorter lanes have no wear [m]
_USUAL = (6.5, 12.5)  # Heights of trees of which the map tells none [m]
_TRUNK = 1.0  # Room around a trunk [m]
_GUESSED: dict[str, tuple[tuple[float, float], float, float]] = {
    "forest": ((8.0, 15.0), 6.5, 0.03),
    "park": ((6.0, 13.0), 12.0, 0.0022),
    "scrub": ((2.0, 4.0), 6.0, 0.01),
    "residential": ((4.0, 8.5), 13.0, 0.0014),
    "grass": ((4.0, 9.0), 18.0, 0.0007),
}
"""Heights, least distance [m] and attempts on a square metre, by the kind of ground."""
_MOST = 6000  # Largest number of trees that are guessed
_KNOWN = 1 / 900.0  # Ground with more trees of the map than this on a square metre gets no others
_OCCUPIED = 0.6  # Share of the bays with a car
_WIDE = 3.5  # Width of pavements from which things may stand anywhere on them [m]
_AT_KERB = 1.3  # On narrower ones they stand nearer to the kerb [m]
_EVERY = 62.0  # Distance from one lamp to the next along a kerb [m]
_APART = 24.0  # Least distance between two lamps [m]
_CLEAR = 1.3  # Room around furniture [m]
_STOP_SIGN, _FROM_KERB = 0.3, 12.0
"""Distance from a kerb to the sign of a bus stop, and largest one to where it is mapped [m]."""
_FROM_END = 8.0  # Least distance of lamps from the end of a street [m]


_CHANCES = ("town trees", "town gardens")


def completed(
    plan: MapPlan,  # The plan; one without a survey is complete already
    network: RoadNetwork,  # What SUMO has made of its roads
) -> MapPlan:
    """Return a plan with layers for all that its survey knows, and for what usually is there.

    Its own layers stay in front of them. The same plan is completed in the same way each time.
    """
    known, seed = plan.survey, plan.seed
    if known is None:
        return plan
    level = _level(network, known)
    layers = [_levelled(one, level) if isinstance(one, Hills) else one for one in plan.layers]
    town = lay_out(network, known, plan.size, _occupied(layers, seed), stream(seed, "town kerbs"))
    buildings = [building_of(house, seed) for house in town.houses]
    # The largest occluders come first: they are drawn first, so less is drawn twice.
    buildings.sort(key=lambda one: -_outside(one.parts[0]))
    bays, cars = _parked(town, stream(seed, "town cars"))
    bays += town.kerbside.lines
    cars += _at_kerbs(town, stream(seed, "town kerb cars"))
    lights = _signals(network, town, known)
    poles = [shapely.Point(one.x, one.y).buffer(1.0) for one in lights]
    wet, ends = town.ground["water"], kept_free(town.crosswalks)
    taken = shapely.union_all([town.roads, town.kerbside.bays, town.built, wet, *poles, ends])
    places = known.lamps or _usual_lamps(network, taken, stream(seed, "town lamps"))
    lamps = _lamps(network, places, taken)
    taken = shapely.union_all([taken, *shapely.buffer(shapely.points(lit_by(lamps)), 4.0)])
    rng = stream(seed, "town furniture")
    furnished = furniture_along(network, _room_to_furnish(town), taken, KERB_HEIGHT, rng)
    dressed = _dressing(network, known, town, taken, furnished, stream(seed, "town clutter"))
    green = _greenery(town, known, stream(seed, "town plants"))
    ours = (
        *(ThingKind(name=name, make="street tree", variant=k, chance="town trees")
          for k, name in enumerate(_TREES)),
        *plant_kinds("town gardens"), *STREET_KINDS[1:], *FURNITURE_KINDS, *CAR_KINDS,
        *CLUTTER_KINDS,
        ThingKind(name="traffic light", make="dark traffic light"),
    )  # fmt: skip
    given = {kind.name for kind in plan.library}
    walks = town.crosswalks
    return replace(
        plan,
        library=(*plan.library, *(kind for kind in ours if kind.name not in given)),
        chances={**{name: Chance(stream=name) for name in _CHANCES}, **plan.chances},
        layers=(
            things([], _TREES),
            *layers,
            Buildings(items=tuple(buildings)),
            things(cars, CARS),
            *_ground(town, network, known, bays, seed),
            things(lights, ("traffic light",)),
            things(lamps, ("street lamp",)),
            things(furnished, tuple(FURNITURE)),
            things(dressed),
            things(green, tuple(kind.name for kind in plant_kinds(""))),
        ),
        walkways=Walkways(
            lines=tuple(walk.line for walk in walks), lights=tuple(walk.light for walk in walks)
        ),
        survey=None,
    )


def _level(network: RoadNetwork, known: Survey) -> shapely.Geometry:
    """Return where hills leave room for streets, pavements and buildings [m]."""
    streets_ = shapely.buffer(road_area(network), _BESIDE_ROAD + known.sidewalks)
    built = [shapely.buffer(house.shape, _BESIDE_WALL) for house in known.houses]
    return shapely.union_all([streets_, *built])


def _levelled(hills: Hills, level: shapely.Geometry) -> Hills:
    return replace(hills, flat=shapely.union_all([level, hills.flat or shapely.Polygon()]))


def _occupied(layers: Sequence[Layer], seed: int) -> Occupied:
    """Return what the layers of a plan have already put somewhere."""
    built, covered = [], []
    for layer in layers:
        if isinstance(layer, Buildings):
            shells = (one.parts[0] for one in layer.items)
            built += [one.outline for one in shells if one.bottom <= FLOOR_HEIGHT]
        elif isinstance(layer, GroundCover):
            covered += [piece.area for piece in layer.pieces if not isinstance(piece, Far)]
        elif isinstance(layer, Paved | Roadway):
            covered.append(layer.area)
        elif isinstance(layer, Hills):
            # Slightly below their feet, so that rounding leaves no gap between them and the ground.
            rising = shapely.buffer(relief_of(layer, seed).area, -0.4, join_style="mitre")
            built.append(rising)
            covered.append(rising)
    covered = [shapely.make_valid(area) for area in covered]
    return Occupied(shapely.union_all(built), shapely.union_all(covered))


def _outside(shell: BuildingPart) -> float:
    """Return about how much there is to see of a building [m^2]."""
    return float((shell.top + shell.rise) * shell.outline.length)


def _ground(
    town: Town, network: RoadNetwork, known: Survey, bays: Sequence[shapely.Polygon], seed: int
) -> list[Layer]:
    """Return streets with their paint, pavements, water and all other ground."""
    rng = stream(seed, "town ground")
    white, yellow = town_paint(
        network,
        town.roads,
        town.crosswalks,
        set(known.signals),
        known.crossing_paint,
        known.middle_paint,
    )
    paint = Paint(rule="none", lines=tuple(white), bars=tuple(yellow), shapes=tuple(bays))
    parking = ground.asphalt(town.ground["parking"], light=True)
    made: list[Layer] = [
        Roadway(
            area=town.roads,
            bays=None if town.kerbside.bays.is_empty else town.kerbside.bays,
            paint=paint,
            wear=Chance(stream="town road wear"),
            worn_from=_WORN_FROM,
        ),
        Paved(area=town.pavement, beside=_asphalt(town)),
        GroundCover(kind=ObjectClass.ROAD, pieces=(parking,)),
    ]
    for name, (kind, covers) in _COVERS.items():
        if not town.ground[name].is_empty:
            made.append(GroundCover(kind=kind, pieces=_covered(town.ground[name], covers, rng)))
    made.append(GroundCover(kind=ObjectClass.PAVEMENT, pieces=_covered(town.yards, _YARDS, rng)))
    nothing = shapely.difference(town.extent, town.lawn)
    lawn = ground.lawn(town.extent, nothing, rng, shapely.Polygon(), 0.0)
    crops, shares = zip(*outskirts.CROPS, strict=True)
    far = Far(rule="fields", covers=crops, shares=shares, chance=state_of(rng))
    made.append(GroundCover(pieces=(*lawn, far)))
    water = town.ground["water"]
    if not water.is_empty:
        below = shapely.buffer(water, _BELOW_BANK, join_style="mitre")
        below = shapely.intersection(below, town.extent)
        wet = Flat(area=below, z=-_WATER_DEPTH, cover=_WATER)
        made.append(GroundCover(kind=ObjectClass.WATER, pieces=(wet,)))
    if known.rails:
        made.append(GroundCover(kind=ObjectClass.STRUCTURE, pieces=(_rails(known),)))
    return made


def _covered(
    shape: shapely.Geometry, covers: tuple[Material, ...], rng: np.random.Generator
) -> tuple[Flat, ...]:
    """Return ground whose separate areas each have one of some materials."""
    areas = polygons_of(shape)
    kinds = rng.integers(len(covers), size=len(areas))
    made = []
    for index, cover in enumerate(covers):
        some = [area for area, kind in zip(areas, kinds, strict=True) if kind == index]
        if some:
            made.append(Flat(area=shapely.MultiPolygon(some), cover=cover))
    return tuple(made)


def _rails(known: Survey) -> Flat:
    """Return the rails of all tracks."""
    sides = [shapely.offset_curve(line, side) for line in known.rails for side in (-_GAUGE, _GAUGE)]
    strips = shapely.buffer(sides, 0.06, cap_style="flat", quad_segs=2)
    area = shapely.MultiPolygon([part for strip in strips for part in polygons_of(strip)])
    return Flat(area=area, z=FLOOR_HEIGHT + _RAIL_HEIGHT, cover=_RAIL)


def _signals(network: RoadNetwork, town: Town, known: Survey) -> list[Placed]:
    """Return a traffic light at the end of each street that has one."""
    lit, made = set(known.signals), []
    for name, street in zip(network.edges, streets(network), strict=True):
        if name not in lit or len(street.right) < 2:
            continue
        foot, turn = signals.pole_at(street)
        if shapely.distance(town.roads, shapely.Point(foot)) > signals.POLE_RADIUS:
            made.append(Placed.at("traffic light", foot, 0.0, turn))
    return made


def _asphalt(town: Town) -> shapely.Geometry:
    """Return the streets with the bays along them [m]."""
    bays = town.kerbside.bays
    return town.roads if bays.is_empty else shapely.union(town.roads, bays)


def _dressing(
    network: RoadNetwork,
    known: Survey,
    town: Town,
    taken: shapely.Geometry,
    furnished: Sequence[Placed],
    rng: np.random.Generator,
) -> list[Placed]:
    """Return signs, bus stops and what lies about along the kerbs, clear of all else."""
    beside = np.reshape([(one.x, one.y) for one in furnished], (-1, 2))
    thin = shapely.buffer(shapely.points(beside), _CLEAR, quad_segs=2)
    walks = shapely.difference(town.pavement, shapely.union_all([taken, *thin]))
    asphalt = shapely.difference(town.roads, shapely.buffer(town.kerbside.bays, 0.3))
    for area in (walks, asphalt):
        shapely.prepare(area)
    grounds = {"road": DressedGround(asphalt, 0.0), "pavement": DressedGround(walks, KERB_HEIGHT)}
    stops = _bus_stops(network, known, walks)
    clear = [shapely.Point(one.x, one.y).buffer(1.0) for one in stops]
    if clear:
        left = shapely.difference(walks, shapely.union_all(clear))
        shapely.prepare(left)
        grounds["pavement"] = DressedGround(left, KERB_HEIGHT)
    return [*along_kerbs(network, grounds, TOWN_KERBS, rng), *stops]


def _bus_stops(network: RoadNetwork, known: Survey, walks: shapely.Geometry) -> list[Placed]:
    """Return the signs of bus stops, at the kerbs that are nearest to them."""
    every = [street for street in streets(network) if len(street.right) >= 2]
    kerbs = [shapely.LineString(street.right) for street in every]
    tree, made = shapely.STRtree(kerbs), []
    for place in known.stops if kerbs else ():
        point = shapely.Point(place)
        which = int(tree.nearest(point))
        along = kerbs[which].project(point)
        low, high = max(along - 0.5, 0.0), min(along + 0.5, kerbs[which].length)
        ends = shapely.get_coordinates(kerbs[which].interpolate(np.array([low, high])))
        inwards = every[which].inwards(unit(ends[1] - ends[0]))
        here = shapely.get_coordinates(kerbs[which].interpolate(along))[0]
        foot = rounded(here - _STOP_SIGN * inwards)
        if kerbs[which].distance(point) < _FROM_KERB and shapely.contains_xy(walks, *foot):
            turn = float(exact.atan2(inwards[1], inwards[0]) - np.pi / 2)
            made.append(Placed.at("bus stop", foot, KERB_HEIGHT, turn))
    return made


def _room_to_furnish(town: Town) -> shapely.Geometry:
    """Return the pavements [m], of narrow ones only the side at the kerb, so that one can pass."""
    inside = shapely.buffer(town.pavement, -_WIDE / 2, join_style="mitre")
    wide = shapely.buffer(inside, _WIDE / 2, join_style="mitre")
    at_kerb = shapely.buffer(_asphalt(town), _AT_KERB, quad_segs=3)
    return shapely.union(
        shapely.intersection(town.pavement, wide), shapely.intersection(town.pavement, at_kerb)
    )


def _usual_lamps(
    network: RoadNetwork, taken: shapely.Geometry, rng: np.random.Generator
) -> list[tuple[float, float]]:
    """Return places beside all kerbs, those of both sides in turn [m]."""
    shapely.prepare(taken)
    kept = SpacedPoints(_APART)
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        beside = shapely.offset_curve(kerb, -street.side * BEYOND_KERB)
        start = _FROM_END + float(rng.uniform(0.0, 0.5 * _EVERY))
        along = np.arange(start, kerb.length - _FROM_END, _EVERY)
        if beside.geom_type != "LineString" or not len(along):
            continue
        points = shapely.line_interpolate_point(beside, along)
        for point in points[~shapely.intersects(taken, shapely.buffer(points, 0.6))]:
            kept.add(round(point.x, 3), round(point.y, 3))
    return kept.points


def _lamps(
    network: RoadNetwork, places: Sequence[tuple[float, float]], taken: shapely.Geometry
) -> list[Placed]:
    """Return street lamps, their arms towards the nearest lane, where nothing else stands."""
    first = network.lane_first
    lanes = [shapely.LineString(network.lane_points[a:b]) for a, b in pairwise(first)]
    tree = shapely.STRtree(lanes)
    shapely.prepare(taken)
    made = []
    for x, y in places:
        point = shapely.Point(x, y)
        if shapely.intersects(taken, point.buffer(POLE_RADIUS)):
            continue
        line = shapely.shortest_line(point, lanes[int(tree.nearest(point))])
        ends = shapely.get_coordinates(line)
        turn = round(float(exact.atan2(*(ends[1] - ends[0])[::-1])), 6)
        made.append(Placed("street lamp", x, y, 0.0, turn))
    return made


def _greenery(town: Town, known: Survey, rng: np.random.Generator) -> list[Placed]:
    """Return trees, and hedges along houses."""
    beside = town.ground["water"], town.ground["rail"]
    solid = shapely.union_all([_asphalt(town), town.built, *beside])
    occupied = shapely.buffer(solid, _TRUNK, quad_segs=2)
    shapely.prepare(occupied)
    told = np.array(known.trees, np.float64).reshape(-1, 3)
    told = told[~shapely.contains_xy(occupied, told[:, 0], told[:, 1])]
    made: list[Placed] = []
    for x, y, height in told.tolist():
        low, high = (height, height) if height else _USUAL
        spot = np.array([[x, y]])
        made += gardens.small_trees(spot, (low, high), FLOOR_HEIGHT, _TREES, rng)
    left = _MOST
    for kind, (heights, apart, density) in _GUESSED.items():
        spots = [np.zeros((0, 2))]
        for area in polygons_of(town.ground[kind]):
            there = int(shapely.contains_xy(area, told[:, 0], told[:, 1]).sum())
            if there < _KNOWN * area.area:
                room = shapely.difference(area, occupied)
                spots.append(gardens.scattered(room, apart, density, rng))
        chosen = np.concatenate(spots)[:left]
        left -= len(chosen)
        made += gardens.small_trees(chosen, heights, FLOOR_HEIGHT, _TREES, rng)
    corners = [rings(shape)[0] for shape in town.gardens]
    room = shapely.union(town.ground["residential"], town.lawn)
    return made + gardens.borders(corners, room, FLOOR_HEIGHT, rng)


def _parked(town: Town, rng: np.random.Generator) -> tuple[list[shapely.Polygon], list[Placed]]:
    """Return the paint between the bays of car parks [m], and the cars in them."""
    lines: list[shapely.Polygon] = []
    made = []
    walls = shapely.buffer(town.built, 0.8, quad_segs=3)
    for area in polygons_of(town.ground["parking"]):
        bays, paint = bays_in(shapely.difference(area, walls))
        lines += paint
        for x, y, turn in bays.tolist():
            if rng.random() < _OCCUPIED:
                way = turn + np.pi * float(rng.random() < 0.4) + exact.normal(rng, 0, 0.028)
                car = CARS[int(rng.integers(len(CARS)))]
                east, north = x + exact.normal(rng, 0, 0.06), y + exact.normal(rng, 0, 0.06)
                made.append(Placed(car, east, north, 0.0, way, float(rng.uniform(0.94, 1.04))))
    return lines, made


def _at_kerbs(town: Town, rng: np.random.Generator) -> list[Placed]:
    """Return the cars in the bays along kerbs."""
    return [
        Placed(CARS[int(rng.integers(len(CARS)))], x, y, 0.0, turn, float(rng.uniform(0.94, 1.04)))
        for x, y, turn in town.kerbside.cars.tolist()
    ]
