"""Scenery of downtown: its park, what stands along the kerbs, bridges between buildings."""

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import rounded, snapped, unit
from eyas.engine.world.roads.areas import Street, blocks, joints, polygons_of, streets
from eyas.lanes import exact
from eyas.maps.buildings.lots import largest, turned
from eyas.maps.buildings.towers import STOREY, Box, TowerLot
from eyas.maps.downtown.layout import EXTENT, DowntownLayout
from eyas.maps.downtown.roads import Grid
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.plants import gardens
from eyas.maps.street.kerbside import (
    BAY_DEPTH,
    BAY_LENGTH,
    beside,
    cars_in,
    lines_between,
    rows_along,
)
from eyas.maps.things.skyways import FLOORS_UNDER, Skyway

_FROM_CROSSING = 17.0  # Distance from the end of a street to the nearest bay [m]
_BAYS = (4, 9)  # Least number of bays in a row, and above the largest
_GREAT_SPACING, _GREAT_BEYOND = 21.0, 2.6
"""Distances along the park of its great trees, and from the kerb to their trunks [m]."""
_GREAT = 32
_SLIM_SPACING, _SLIM_BEYOND = 10.6, 1.5  # The same for the slim trees of the street that they line
_SLIM = 59
_SLIM_STREET = 5  # The street with slim trees on both sides, counted from the south
_PARK_STREET = 7
_PAST_LINE = 2.2  # Distance from a stop line to the lamp at the crossing for walkers beyond it [m]

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Kerbs:
    """What stands along the kerbs, world frame."""

    bays: shapely.Geometry  # Asphalt of the parking bays [m]
    lines: list[shapely.Polygon]  # Paint between them [m]
    cars: Points  # Middle of each parked car [m] and its heading [rad], shape (K, 3)
    great_trees: Points  # Trunks of the great trees along the park [m], shape (K, 2)
    slim_trees: Points  # Trunks of the slim trees [m], shape (K, 2)


def _kerbs(network: RoadNetwork, railway: shapely.Geometry, rng: np.random.Generator) -> Kerbs:
    """Return what stands along the kerbs; no tree stands on the ground of the railway."""
    every = streets(network)
    slim = [s for s in every if _is_along(s, _SLIM_STREET)]
    # Where traffic keeps right, the kerb of the westbound side is the park's.
    park = [s for s in every if _is_along(s, _PARK_STREET) and min(s.start, s.end) < "E"]
    great = [s for s in park if (s.start > s.end) != network.left_hand]
    bays: list[shapely.Geometry] = []
    lines: list[shapely.Polygon] = []
    cars: list[list[float]] = []
    for street in every:
        if not street.dividers and street not in slim and street.start[1:] == street.end[1:]:
            kerb, side = shapely.LineString(street.right), street.side
            span = _FROM_CROSSING, kerb.length - _FROM_CROSSING
            for row in rows_along(kerb, span, _BAYS, rng):
                bays.append(beside(row, side, (0.0, BAY_DEPTH), 0.0, row.length))
                count = round(row.length / BAY_LENGTH)
                lines += lines_between(row, side, count)
                cars += cars_in(row, side, count, rng)
    slim_trees = _row_of_trees(slim, _SLIM_SPACING, _SLIM_BEYOND, 13.0)
    return Kerbs(
        bays=snapped(shapely.union_all(bays)),
        lines=lines,
        cars=np.array(cars).reshape(-1, 3),
        great_trees=_row_of_trees(great, _GREAT_SPACING, _GREAT_BEYOND, 4.0)[:_GREAT],
        slim_trees=slim_trees[shapely.distance(railway, shapely.points(slim_trees)) > 1.0][:_SLIM],
    )


def crossing_lamps(network: RoadNetwork, beyond: float) -> list[tuple[Points, float]]:
    """Return the foot of a lamp at each crossing, and the direction of its arm [rad].

    The lamp stands beside the crossing for walkers that lies on the widest road into it.

    Args:
        beyond: From the kerb to the pole [m].
    """
    meeting = joints(network)
    ways: dict[str, list[Street]] = {}
    for street in streets(network):
        if meeting[street.end] >= 3:
            ways.setdefault(street.end, []).append(street)
    made = []
    for node in sorted(ways):
        street = max(ways[node], key=lambda s: (len(s.dividers), s.start))
        onwards = unit(street.right[-1] - street.right[-2])
        inwards = street.inwards(onwards)
        foot = street.right[-1] - beyond * inwards + _PAST_LINE * onwards
        made.append((rounded(foot), float(exact.atan2(inwards[1], inwards[0]))))
    return made


def _is_along(street: Street, index: int) -> bool:
    return street.start[1:] == street.end[1:] == str(index + 1)


def _row_of_trees(rows: list[Street], spacing: float, beyond: float, clear: float) -> Points:
    """Return trunks along kerbs, evenly spaced between crossings."""
    trunks = [np.zeros((0, 2))]
    for street in rows:
        kerb = shapely.LineString(street.right)
        count = max(int((kerb.length - 2 * clear) // spacing), 0) + 1
        first = (kerb.length - (count - 1) * spacing) / 2
        for k in range(count):
            piece = substring(kerb, first + k * spacing, first + k * spacing + 0.5)
            start, end = shapely.get_coordinates(piece)[[0, -1]]
            along = unit(end - start)
            trunks.append(rounded(start - beyond * street.inwards(along))[None])
    return np.concatenate(trunks)


_DEPTH = 345.0  # Distance from the street along its south side to its far end [m]
_WALK = 4.2  # Width of the pavement along its edge [m]
_POND_AREA = 15_325.0  # As in the original [m^2]
_POND_LINE = ((-72.0, -34.0), (-50.0, 26.0), (4.0, 40.0), (46.0, 10.0), (88.0, 44.0))
"""Backbone of the pond about its middle, in the frame of the grid [m]."""
_POND_REACH = 34.0
_FOUNTAIN = 11.3  # Radius of the basin of the fountain: 401 m^2, as in the original [m]
_SMALL_PONDS = ((0.10, 0.72, 9.0, 6.0), (0.82, 0.74, 12.0, 7.0), (0.60, 0.90, 8.0, 8.0),
                (0.30, 0.92, 10.0, 5.0))  # fmt: skip
"""Position as a share of width and depth, and half axes [m]."""
_PATH = 3.6
_TREES = 243
_GROUPS = 34  # Number of groups in which the trees of the park stand


@dataclass(frozen=True, slots=True)
class Park:
    """The park in plan view, world frame [m]."""

    ground: shapely.Polygon  # All of it, from the kerbs on
    walk: shapely.Geometry  # Raised pavement along the kerbs
    water: shapely.Geometry  # Ponds, and the basin of the fountain
    rim: shapely.Geometry  # Stone around the water
    paths: shapely.Geometry  # Paths and the square around the fountain
    fountain: tuple[float, float]  # Middle of the fountain
    trees: Points  # Trunks, shape (K, 2)
    shrubs: Points  # Middle of each group of shrubs and its direction [rad], shape (K, 3)
    benches: Points  # Position of each bench and direction that it faces [rad], shape (K, 3)


def _park(grid: Grid, roads: shapely.Geometry, rng: np.random.Generator) -> Park:
    """Return the park of a city."""
    west, east, south = grid.avenues[0] - 8.0, grid.avenues[4], grid.streets[7]
    whole = turned(shapely.box(west, south, east, south + _DEPTH), grid.turn)
    ground = largest(shapely.difference(shapely.intersection(whole, EXTENT), roads))
    walk = shapely.intersection(ground, shapely.buffer(roads, _WALK, join_style="mitre"))
    inner = shapely.difference(ground, walk)
    middle = np.array([west + 0.47 * (east - west), south + 205.0])
    pond = _pond(grid, middle)
    fountain = grid.world(np.array([[east - 118.0, south + 62.0]]))[0]
    basin = snapped(shapely.buffer(shapely.Point(fountain), _FOUNTAIN, quad_segs=12))
    small = [
        _oval(grid, west + x * (east - west), south + y * _DEPTH, a, b)
        for x, y, a, b in _SMALL_PONDS
    ]
    water = shapely.union_all([pond, basin, *small])
    rim = snapped(shapely.difference(shapely.buffer(water, 0.9, quad_segs=4), water))
    wet = shapely.union(water, rim)
    square = snapped(shapely.buffer(shapely.Point(fountain), _FOUNTAIN + 9.0, quad_segs=12))
    trails = _trails(grid, (west, south, east), middle, pond)
    paths = shapely.intersection(shapely.union(trails, square), inner)
    paths = snapped(shapely.difference(paths, wet))
    trees = _trees(shapely.difference(inner, shapely.union(wet, paths)), rng)
    return Park(
        ground=ground,
        walk=walk,
        water=water,
        rim=rim,
        paths=paths,
        fountain=(float(fountain[0]), float(fountain[1])),
        trees=trees,
        shrubs=_shrubs(shapely.difference(inner, shapely.union(wet, paths)), wet, rng),
        benches=_benches(trails, shapely.union(wet, paths), inner),
    )


def _pond(grid: Grid, middle: Points) -> shapely.Polygon:
    """Return the pond: winding, and exactly as large as the original's."""
    line = shapely.LineString(np.array(_POND_LINE) + middle)
    shape = shapely.buffer(line, _POND_REACH, quad_segs=6)
    island = shapely.buffer(shapely.Point(middle + np.array([-26.0, 8.0])), 9.0, quad_segs=4)
    bays = [
        shapely.buffer(shapely.Point(middle + at), 13.0) for at in ([30.0, -26.0], [-6.0, 74.0])
    ]
    shape = shapely.difference(shape, shapely.union_all([island, *bays]))
    shape = shapely.buffer(shapely.buffer(shape, -6.0), 6.0, quad_segs=4)
    factor = math.sqrt(_POND_AREA / shape.area)
    shape = shapely.transform(shape, lambda xy: rounded(middle + factor * (xy - middle)))
    return largest(turned(shapely.simplify(shape, 0.3), grid.turn))


def _oval(grid: Grid, u: float, v: float, a: float, b: float) -> shapely.Polygon:
    angle = np.linspace(0.0, 2 * np.pi, 28, endpoint=False)
    ring = np.column_stack([u + a * exact.cos(angle), v + b * exact.sin(angle)])
    return shapely.Polygon(grid.world(ring))


def _trails(
    grid: Grid, corner: tuple[float, float, float], middle: Points, pond: shapely.Polygon
) -> shapely.Geometry:
    """Return a loop around the pond, and winding ways from it to the edges of the park."""
    west, south, east = corner
    loop = shapely.buffer(pond, 7.0, quad_segs=6).exterior
    ends = [
        (west + 20.0, south), (west + 190.0, south), (middle[0] + 90.0, south),
        (east - 40.0, south), (east, south + 120.0), (east, south + 300.0), (west, south + 160.0),
        (west + 90.0, south + _DEPTH), (middle[0] + 160.0, south + _DEPTH),
    ]  # fmt: skip
    lines: list[shapely.Geometry] = [shapely.LineString(loop.coords)]
    for k, end in enumerate(ends):
        straight = np.array(end) - middle
        aside = np.array([-straight[1], straight[0]]) * (0.16 if k % 2 else -0.16)
        t = np.linspace(0.0, 1.0, 15)[:, None]
        curve = middle + t * straight + np.round(exact.sin(np.pi * t), 6) * aside
        lines.append(shapely.LineString(grid.world(curve)))
    ways = shapely.union_all([shapely.buffer(line, _PATH / 2, quad_segs=3) for line in lines])
    return snapped(shapely.simplify(ways, 0.05))


def _trees(room: shapely.Geometry, rng: np.random.Generator) -> Points:
    """Return trunks in groups and alone, at least 4 m apart."""
    free = shapely.buffer(room, -2.2)
    shapely.prepare(free)
    centres = gardens.scattered(free, 26.0, 0.004, rng)
    centres = centres[rng.permutation(len(centres))[:_GROUPS]]
    grouped = gardens.clustered(np.round(centres, 3), 9.0, (5, 11), free, rng)
    alone = gardens.scattered(free, 13.0, 0.012, rng)
    # Whole millimetres, as normal numbers differ from processor to processor in their last bits.
    every = rounded(np.concatenate([grouped, rng.permutation(alone)]))
    chosen: list[Points] = []
    for place in every:
        if len(chosen) < _TREES and all(np.abs(place - c).max() > 3.2 for c in chosen):
            chosen.append(place)
    return np.array(chosen).reshape(-1, 2)


def _shrubs(room: shapely.Geometry, wet: shapely.Geometry, rng: np.random.Generator) -> Points:
    """Return groups of shrubs: thickets on the meadows, and some along the water."""
    free = shapely.buffer(room, -2.4)
    shore = shapely.intersection(free, shapely.buffer(wet, 5.0))
    shapely.prepare(free)
    thickets = gardens.clustered(gardens.scattered(free, 40.0, 0.002, rng), 4.5, (2, 6), free, rng)
    places = np.concatenate([thickets, gardens.scattered(shore, 7.0, 0.012, rng)])
    turns = np.round(rng.uniform(0.0, np.pi, (len(places), 1)), 6)
    return np.column_stack([rounded(places), turns])


def _benches(trails: shapely.Geometry, taken: shapely.Geometry, inner: shapely.Geometry) -> Points:
    """Return benches beside the paths, which face them."""
    made = []
    shapely.prepare(taken)
    for part in polygons_of(trails):
        for ring in (part.exterior, *part.interiors):
            line = shapely.LineString(ring.coords)
            for at in np.arange(12.0, line.length - 1.0, 58.0):
                here, there = (
                    shapely.get_coordinates(line.interpolate(s))[0] for s in (at, at + 0.2)
                )
                onwards = (there - here) / exact.hypot(*(there - here))
                # The path lies on the left or right of its edge; a bench on the other side.
                for side in (1.0, -1.0):
                    out = side * np.array([-onwards[1], onwards[0]])
                    place = rounded(here + 0.75 * out)
                    if not taken.intersects(shapely.Point(place).buffer(0.6)) and inner.contains(
                        shapely.Point(place)
                    ):
                        made.append([*place, round(exact.atan2(-out[1], -out[0]), 6)])
    return np.array(made).reshape(-1, 3)


_COUNT = 46  # Number of skyways, if there are so many places
_APART = 44.0  # Least distance between two [m]
_WIDEST_STREET = 32.0  # Fronts farther apart than this are not joined [m]
_FROM_CORNER = 5.0  # Distance from the corners of blocks to the side of a skyway [m]
_STEP = 3.0  # Distance between the places tried along a street [m]


_Gap = tuple[Box, int, int, bool]
"""Ground between two fronts, the numbers of their lots, and whether the fronts lie north and
south."""


def _skyways(
    city: DowntownLayout, keep_free: shapely.Geometry, rng: np.random.Generator
) -> list[Skyway]:
    """Return skyways between fronts that are high enough on both sides."""
    buildings, roads = city.buildings, city.roads
    high = [parts[0].height >= STOREY * (FLOORS_UNDER + 2) for parts in buildings]
    shapely.prepare(keep_free)
    shapely.prepare(roads)
    made: list[Skyway] = []
    taken: list[Points] = []
    for place, width, gap in _places(city.lots, high, rng):
        skyway = _skyway(city.grid, place, width, gap, buildings, rng)
        middle = (skyway.start + skyway.end) / 2
        near = min((float(exact.hypot(*(middle - other))) for other in taken), default=np.inf)
        free = not keep_free.intersects(shapely.Polygon(skyway.outline()))
        # Elsewhere a yard lies between the two.
        if near > _APART and free and shapely.contains_xy(roads, *middle):
            made.append(skyway)
            taken.append(middle)
        if len(made) == _COUNT:
            break
    return made


def _places(
    lots: list[TowerLot], high: list[bool], rng: np.random.Generator
) -> list[tuple[float, float, _Gap]]:
    """Return places along streets, widths [m] and gaps that a skyway can span, in any order."""
    found = []
    for gap in _gaps(lots, high):
        west, south, east, north = gap[0]
        low, top = (west, east) if gap[3] else (south, north)
        width = float(rng.choice((4.5, 6.0, 7.5, 9.0), p=(0.3, 0.25, 0.25, 0.2)))
        room = _FROM_CORNER + width / 2
        found += [(float(at), width, gap) for at in np.arange(low + room, top - room, _STEP)]
    return [found[k] for k in rng.permutation(len(found)).tolist()]


def _gaps(lots: list[TowerLot], high: list[bool]) -> list[_Gap]:
    """Return the ground between each two high fronts that face each other over a street."""
    boxes = np.array([lot.box for lot in lots])
    made: list[_Gap] = []
    for k in np.flatnonzero(high).tolist():
        for across, near, along in ((1, 3, 0), (0, 2, 1)):
            front = boxes[k, near]
            gap = boxes[:, across] - front
            low = np.maximum(boxes[:, along], boxes[k, along])
            top = np.minimum(boxes[:, along + 2], boxes[k, along + 2])
            facing = (gap > 12.0) & (gap < _WIDEST_STREET) & (top - low > 16.0) & high
            for other in np.flatnonzero(facing).tolist():
                back = boxes[other, across]
                sides = (low[other], front, top[other], back)
                if not across:
                    sides = (front, low[other], back, top[other])
                made.append((sides, k, other, bool(across)))
    return made


def _skyway(
    grid: Grid,
    place: float,
    width: float,
    gap: _Gap,
    buildings: list[list[BuildingPart]],
    rng: np.random.Generator,
) -> Skyway:
    (west, south, east, north), one, other, across = gap
    ends = [(place, south), (place, north)] if across else [(west, place), (east, place)]
    start, end = grid.world(np.array(ends))
    floors = 1 if width < 5.0 else 2
    glazed = floors == 1 or rng.random() < 0.5
    owner = buildings[one if rng.random() < 0.5 else other][0]
    look = ("facade_glass", (0.86, 0.95, 0.98)) if glazed else (owner.facade, owner.tint)
    return Skyway(start, end, width, floors, *look)


_OUTER_WALK = 6.5  # Width of the pavement on the far side of the outer streets [m]
_CROWN = 5.0  # No skyway comes nearer to a trunk [m]


@dataclass(frozen=True, slots=True)
class DowntownScenery:
    """What stands and lies between the buildings."""

    park: Park  # The park
    kerbs: Kerbs  # Parked cars and trees along the streets
    pavement: shapely.Geometry  # Raised pavements beside the streets, without parking bays [m]
    skyways: list[Skyway]  # Bridges between buildings


def scenery_of(network: RoadNetwork, city: DowntownLayout, seed: int) -> DowntownScenery:
    """Return the scenery of a city."""
    roads, railway = city.roads, city.viaduct.ground
    park = _park(city.grid, roads, stream(seed, "downtown park"))
    kerbs = _kerbs(network, railway, stream(seed, "downtown kerbs"))
    inside, outside = blocks(roads, EXTENT)
    rings = shapely.difference(shapely.union_all(inside), shapely.union_all(city.courts))
    verge = shapely.intersection(
        shapely.union_all(outside),
        shapely.buffer(roads, _OUTER_WALK, join_style="mitre", mitre_limit=2.0),
    )
    verge = shapely.difference(verge, park.ground)
    pavement = shapely.union_all([rings, verge, park.walk])
    trunks = shapely.points(np.concatenate([kerbs.great_trees, kerbs.slim_trees]))
    taken = shapely.union_all([railway, *shapely.buffer(trunks, _CROWN)])
    return DowntownScenery(
        park=park,
        kerbs=kerbs,
        pavement=shapely.difference(pavement, kerbs.bays),
        skyways=_skyways(city, taken, stream(seed, "downtown skyways")),
    )
