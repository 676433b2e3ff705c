"""Layout of the village: the position of everything in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import length, rounded, snapped, unit
from eyas.engine.world.roads.areas import Street, blocks, road_area, streets
from eyas.lanes import exact
from eyas.maps.buildings.cottages import SIDE, Cottage
from eyas.maps.buildings.lots import largest
from eyas.maps.land.mounds import Mound, place_inside, place_ring, sizes
from eyas.maps.land.outlines import wavy
from eyas.maps.plants import trees
from eyas.maps.roads.tunnels import Tunnel
from eyas.maps.village.roads import road_graph

_TUNNEL = 40.0  # Length of a tunnel [m]
_PAIRS, _SINGLE = 2, 6
"""Number of roads with two tunnels one after the other, and of those with one."""
_BETWEEN = 5.0  # Distance of the two tunnels of a pair [m]
_FROM_BEND = 13.0  # Least distance from a tunnel to the end of its road [m]

_CLUSTERS = (8, 6, 4, 3, 3)  # Houses in each cluster
_SETBACKS = (4.2, 8.0)  # Least and largest distance from the kerb to a house [m]
_EVERY = 29.0  # Distance from one house to the next [m]
_APART = 6.5  # Least distance of two houses [m]

_GANTRIES = 7

Points = NDArray[np.float64]


def tunnels_along(
    ways: Sequence[Street], roads: shapely.Geometry, rng: np.random.Generator
) -> list[Tunnel]:
    """Return ten tunnels on straight roads, two pairs of which nearly touch."""
    one_way = [way for way in ways if way.start < way.end]
    order = [one_way[int(index)] for index in rng.permutation(len(one_way))]
    # A pair needs more room, so it chooses first.
    order.sort(key=lambda way: length(way.left[-1] - way.left[0]) < 140.0)
    made: list[Tunnel] = []
    pairs, single = _PAIRS, _SINGLE
    for way in order:
        start, end = way.left[0], way.left[-1]
        whole, along = length(end - start), unit(end - start)
        count = 2 if pairs else 1
        reach = count * _TUNNEL + (count - 1) * _BETWEEN
        spare = whole - reach - 2 * _FROM_BEND
        if spare < 0 or not (pairs or single):
            continue
        first = _FROM_BEND + rng.uniform(0.2, 0.8) * spare + _TUNNEL / 2
        steps = first + (_TUNNEL + _BETWEEN) * np.arange(count)
        some = [Tunnel(rounded(start + step * along), along, _TUNNEL) for step in steps]
        if all(_is_free(tunnel, made, roads) for tunnel in some):
            made += some
            pairs, single = (pairs - 1, single) if count == 2 else (pairs, single - 1)
    return made


def _is_free(tunnel: Tunnel, others: Sequence[Tunnel], roads: shapely.Geometry) -> bool:
    """Return whether no road passes the solid sides of a tunnel, and no other one is near."""
    solid = shapely.difference(tunnel.area, shapely.buffer(tunnel.passage, -1.0))
    near = [shapely.distance(tunnel.area, other.area) < 90.0 for other in others]
    return not shapely.intersects(solid, roads) and not any(near)


def cottages_along(
    ways: Sequence[Street],
    inside: shapely.Geometry,  # Area in which they stand [m]
    keep_free: shapely.Geometry,  # Area where none may stand [m]
    rng: np.random.Generator,
) -> list[Cottage]:
    """Return houses in clusters on both sides of roads."""
    sites = _sites(ways, rng)
    shapely.prepare(inside)
    free = shapely.buffer(keep_free, 3.9)
    shapely.prepare(free)
    shapes = [shapely.Polygon(site.outline) for site in sites]
    fits = [shapely.contains(inside, s) and not shapely.intersects(free, s) for s in shapes]
    chosen: list[int] = []
    centres = np.array([site.place for site in sites])
    for wanted in _CLUSTERS:
        for start in rng.permutation(np.flatnonzero(fits)):
            # A cluster keeps away from the others.
            away = np.linalg.norm(centres[chosen] - centres[start], axis=1)
            if away.min(initial=np.inf) < 130.0:
                continue
            cluster = _cluster(int(start), wanted, shapes, fits, centres)
            if len(cluster) == wanted:
                chosen += cluster
                break
    return [sites[index] for index in chosen]


def _cluster(
    start: int,
    wanted: int,
    shapes: Sequence[shapely.Polygon],
    fits: Sequence[bool],
    centres: Points,
) -> list[int]:
    """Return the sites nearest to one that have room beside each other."""
    made: list[int] = []
    away = np.round(np.linalg.norm(centres - centres[start], axis=1), 3)
    for index in np.argsort(away, kind="stable").tolist():
        apart = [shapely.distance(shapes[index], shapes[other]) for other in made]
        if len(made) < wanted and away[index] < 95.0 and fits[index]:
            if min(apart, default=math.inf) > _APART:
                made.append(index)
    return made


def _sites(ways: Sequence[Street], rng: np.random.Generator) -> list[Cottage]:
    """Return places beside all roads, each house with its front to the road."""
    made = []
    for way in ways:
        kerb = shapely.LineString(way.right)
        for along in np.arange(rng.uniform(12.0, 24.0), kerb.length - 12.0, _EVERY / 2):
            here, there = (
                shapely.get_coordinates(kerb.interpolate(s))[0] for s in (along, along + 0.5)
            )
            onwards = unit(there - here)
            inwards = way.inwards(onwards)
            setback = rng.uniform(*_SETBACKS) + SIDE / 2
            place = rounded(here - setback * inwards)
            # The front, at y, faces the road.
            turn = exact.atan2(inwards[1], inwards[0]) - math.pi / 2 + rng.uniform(-0.07, 0.07)
            storeys = int(rng.choice((2, 3, 4), p=(0.15, 0.7, 0.15)))
            made.append(Cottage(place, round(turn, 4), storeys, int(rng.integers(3))))
    return made


def gantries_along(
    ways: Sequence[Street], covered: shapely.Geometry, trunks: Points, rng: np.random.Generator
) -> list[tuple[Points, float]]:
    """Return where gantries stand: the middle of the road [m] and its direction [rad]."""
    thin = shapely.union_all(shapely.points(trunks))
    taken = shapely.union(shapely.buffer(covered, 8.0), shapely.buffer(thin, 7.0))
    made: list[tuple[Points, float]] = []
    for index in rng.permutation(len(ways)):
        way = ways[int(index)]
        line = shapely.LineString(way.left)
        if line.length < 50.0 or len(made) == _GANTRIES:
            continue
        at = line.length - rng.uniform(20.0, 34.0)
        place = rounded(shapely.get_coordinates(line.interpolate(at))[0])
        along = unit(way.left[-1] - way.left[0])
        apart = [length(place - other) for other, _ in made]
        clear = not shapely.intersects(taken, shapely.buffer(shapely.Point(place), 9.0))
        if clear and min(apart, default=math.inf) > 70.0:
            made.append((place, round(exact.atan2(along[1], along[0]), 4)))
    return made


FLOOR = (982.0, 998.0)  # Extent of the floor [m]

HALF = 730.0  # Half the side of the square that the hills fill [m]

EXTENT = shapely.box(-HALF, -HALF, HALF, HALF)  # Extent of the hills [m]

_INSIDE, _INSIDE_RADII = 15, (60.0, 86.0, 134.0)
_RING, _RING_RADII = 33, (87.0, 144.0, 201.0)
"""Numbers of hills, and their smallest, median and largest radius [m]."""
_STEEP, _RING_STEEP = (0.72, 0.86), (0.73, 0.84)
"""Least and largest height of a hill, as a share of its radius."""
_SPURS, _LEAN = 0.28, 0.1
"""Depth of the waves of a hill's outline, and most by which its summit is off its middle along an
axis, as shares of its radius."""
_KERB_TO_FOOT = 7.0  # Least distance from a kerb to the foot of a hill [m]
_RING_GAPS = (14.0, 73.0)
_LAKESIDE = "o14"  # Node of the outer road beside the lake's block
_LAKE = 41_979.0  # Area of the lake, as in the original [m^2]
_LAKE_SHARE = 0.64  # Most that the lake takes of its block
_TREES, _TREE_SPACING = 41, (11.0, 17.0)
_BEYOND_KERB = 5.0  # Distance from the kerb to the trunks [m]


@dataclass(frozen=True, slots=True)
class VillageLayout:
    """Positions in plan view."""

    roads: shapely.Geometry  # Asphalt [m]
    blocks: list[shapely.Polygon]  # Ground between roads [m]
    lake: shapely.Polygon  # Water [m]
    tunnels: list[Tunnel]  # Tunnels over the roads
    cottages: list[Cottage]  # Houses
    trees: Points  # Trunks [m], shape (K, 2)
    gantries: list[tuple[Points, float]]
    """Middle of the road [m] and its direction [rad] at each gantry."""
    hills: list[Mound]  # Hills between the roads, then those of the ring

    @property
    def walls(self) -> shapely.Geometry:
        """Footprints of the houses [m]."""
        return shapely.union_all([shapely.Polygon(house.outline) for house in self.cottages])

    @property
    def covered(self) -> shapely.Geometry:
        """What the tunnels cover [m]."""
        return shapely.union_all([tunnel.area for tunnel in self.tunnels])


def lay_out(network: RoadNetwork, seed: int) -> VillageLayout:
    """Return the plan of a village."""
    roads = road_area(network)
    closed, _ = blocks(roads, EXTENT)
    ways = streets(network)
    shore = {node.name: (node.x, node.y) for node in road_graph(seed).nodes}[_LAKESIDE]
    beside = min(closed, key=lambda block: float(block.distance(shapely.Point(shore))))
    lake = _lake(beside, stream(seed, "village lake"))
    tunnels = tunnels_along(ways, roads, stream(seed, "village tunnels"))
    covered = shapely.union_all([tunnel.area for tunnel in tunnels])
    taken = shapely.union_all([roads, shapely.buffer(lake, 7.0), shapely.buffer(covered, 5.0)])
    inside = shapely.union_all(closed)
    cottages = cottages_along(ways, inside, taken, stream(seed, "village houses"))
    walls = shapely.union_all([shapely.Polygon(house.outline) for house in cottages])
    taken = shapely.union_all([roads, shapely.buffer(covered, 6.0), shapely.buffer(walls, 6.0)])
    trunks = _tree_rows(ways, taken, stream(seed, "village trees"))
    gantries = gantries_along(ways, covered, trunks, stream(seed, "village gantries"))
    keep = [shapely.buffer(walls, 7.0), shapely.buffer(lake, 6.0)]
    keep += [shapely.buffer(tunnel.passage, 2.0) for tunnel in tunnels]
    hills = _hills(roads, closed, keep, stream(seed, "village hills"))
    return VillageLayout(roads, closed, lake, tunnels, cottages, trunks, gantries, hills)


def _lake(block: shapely.Polygon, rng: np.random.Generator) -> shapely.Polygon:
    """Return the lake, which fills most of its block."""
    wanted = min(_LAKE, _LAKE_SHARE * block.area)
    low, high = 5.0, 120.0
    for _ in range(24):
        middle = (low + high) / 2
        inner = largest(shapely.buffer(block, -middle - 30.0))
        shape = shapely.buffer(inner, 30.0, quad_segs=6)
        low, high = (middle, high) if shape.area > wanted else (low, middle)
    return snapped(wavy(shape, 7.0, rng))


def _tree_rows(
    ways: Sequence[Street], keep_free: shapely.Geometry, rng: np.random.Generator
) -> Points:
    """Return trunks along both sides of three roads."""
    trunks = np.zeros((0, 2))
    longest = sorted(ways, key=lambda way: -round(shapely.LineString(way.right).length, 1))
    both = [way for way in longest if way.start < way.end][:12]
    for index in rng.permutation(len(both)):
        street = both[int(index)]
        sides = [w for w in ways if {w.start, w.end} == {street.start, street.end}]
        for side in sides:
            kerb = shapely.LineString(side.right)
            line = shapely.offset_curve(kerb, -side.side * _BEYOND_KERB)
            found = trees.place_along(line, _TREE_SPACING, rng, keep_free)
            trunks = np.concatenate([trunks, found[: _TREES - len(trunks)]])
    return trunks


def _hills(
    roads: shapely.Geometry,
    closed: Sequence[shapely.Polygon],
    keep: list[shapely.Geometry],
    rng: np.random.Generator,
) -> list[Mound]:
    """Return the hills, with outlines of their own."""
    free = shapely.union_all(keep)
    room = shapely.difference(
        shapely.union_all([shapely.buffer(block, -_KERB_TO_FOOT) for block in closed]), free
    )
    radii = sizes(_INSIDE, _INSIDE_RADII, rng).tolist()
    made = place_inside(radii, _STEEP, room, rng)
    filled = shapely.Polygon(shapely.get_exterior_ring(shapely.get_parts(roads)[0]))
    ring = place_ring(sizes(_RING, _RING_RADII, rng).tolist(), _RING_GAPS, _RING_STEEP, filled, rng)
    shaped = []
    for hill in (*made, *ring):  # with spurs and gullies, and steep on one side: no two are alike
        phases, lean = rng.uniform(0, 2 * math.pi, 6), rounded(rng.uniform(-_LEAN, _LEAN, 2))
        shaped.append(
            replace(
                hill,
                phases=tuple(phases.tolist()),
                waviness=_SPURS,
                lean=(float(lean[0]), float(lean[1])),
            )
        )
    return shaped
