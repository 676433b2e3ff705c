"""Plan of the village: the position of everything in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import Street, blocks, road_area, streets
from eyas.maps.buildings.cottages import Cottage
from eyas.maps.buildings.lots import largest
from eyas.maps.land.mounds import Mound, place_inside, place_ring, sizes
from eyas.maps.land.outlines import wavy
from eyas.maps.plants import trees
from eyas.maps.roads.tunnels import Tunnel
from eyas.maps.village.places import cottages_along, gantries_along, tunnels_along
from eyas.maps.village.roads import road_graph

__all__ = ["EXTENT", "FLOOR", "HALF", "VillageLayout", "lay_out"]

FLOOR = (982.0, 998.0)  # Extent of the floor [m]

HALF = 730.0  # Half the side of the square that the hills fill [m]

EXTENT = shapely.box(-HALF, -HALF, HALF, HALF)  # That square

_INSIDE, _INSIDE_RADII = 15, (60.0, 86.0, 134.0)
_RING, _RING_RADII = 33, (87.0, 144.0, 201.0)
"""Numbers of hills, and their smallest, median and largest radius [m]."""
_STEEP, _RING_STEEP = (0.72, 0.86), (0.73, 0.84)
"""Least and largest height of a hill, as a share of its radius."""
_KERB_TO_FOOT = 7.0  # Least distance from a kerb to the foot of a hill [m]
_RING_GAPS = (14.0, 73.0)
_LAKESIDE = "o14"  # Node of the outer road beside the lake's block
_LAKE = 41_979.0  # Area of the lake, as in the original [m^2]
_LAKE_SHARE = 0.64  # Most that the lake takes of its block
_TREES, _TREE_SPACING = 41, (11.0, 17.0)
_BEYOND_KERB = 5.0  # From the kerb to the trunks [m]

Points = NDArray[np.float64]


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
    """Return the plan of a village.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
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
            line = shapely.offset_curve(shapely.LineString(side.right), -_BEYOND_KERB)
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
    return [
        Mound(
            *(hill.x, hill.y, hill.radius, hill.height),
            phases=tuple(rng.uniform(0, 2 * math.pi, 3).tolist()),
            waviness=0.14,
        )
        for hill in (*made, *ring)
    ]
