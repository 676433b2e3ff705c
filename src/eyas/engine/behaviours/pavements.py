"""Ways along pavements."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.surface import WalkedSurface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.traffic.smoothing import runs
from eyas.engine.world.roads.areas import blocks, polygons_of, road_area

LANES: Final = (1.0, 1.9)
"""Distances from the kerb of those who have the road on their left, and on their right [m]."""

_SHORTEST: Final = 25.0  # Least length of a pavement on which one walks [m]

_DRIVEWAY: Final = 12.0  # Largest width of asphalt that interrupts a pavement [m]

_LAWN: Final = -0.05  # Height above that of lawns [m]

_BESIDE: Final = 5.0
"""Largest distance from the road of those who walk along its edge, round what stands there [m]."""

_EVERY: Final = 1.0  # Distance between points that are tested for pavement [m]


class Walkway(NamedTuple):
    """A way that ends where it begins: round a block, or there and back."""

    corners: NDArray[np.float64]  # [m], shape (K, 2), the last not the first again
    length: float  # [m]
    lane: int  # Of those who have the road on their left: 0; on their right: 1

    @property
    def line(self) -> shapely.LineString:
        """All of it, from its first corner to its first corner."""
        return shapely.LineString([*self.corners, self.corners[0]])


def pavement_ways(
    closed: Sequence[shapely.Polygon],  # Blocks with roads all round [m]
    obstacles: GroundObstacles,  # What stands in the way
    surface: WalkedSurface,  # The ground
    radius: float,  # Distance to obstacles that is kept [m]
    *,
    verges: bool = False,  # Whether one walks wherever the way is near the road, on pavement or not
    lanes: Sequence[float] = LANES,  # See `LANES`; those of the first have the road on their left
) -> list[Walkway]:
    """Return the ways along the pavements of all blocks, round what stands on them.

    Where a block has no pavement all round, they lead there and back.
    """
    found = []
    for block in closed:
        for lane, beyond in enumerate(lanes):
            ring = _ring(block, beyond, obstacles, radius)
            if ring is not None:
                line = ring if shapely.is_ccw(ring) == (lane == 1) else shapely.reverse(ring)
                points = along(line)
                if verges:
                    walked = shapely.distance(block.exterior, shapely.points(points)) < _BESIDE
                else:
                    under = surface.at(points)
                    walked = bridged(under.pavement, is_hard(under.height))
                found += paved_parts(line, walked, lane)
    return found


def closed_blocks(
    network: RoadNetwork,
    size: tuple[float, float],  # Extent of the map [m]
) -> list[shapely.Polygon]:
    """Return the blocks with roads all round."""
    if not len(network.lane_width):
        return []
    extent = shapely.box(-size[0] / 2, -size[1] / 2, size[0] / 2, size[1] / 2)
    return blocks(road_area(network), extent)[0]


def _ring(
    block: shapely.Polygon, beyond: float, obstacles: GroundObstacles, radius: float
) -> shapely.LinearRing | None:
    """Return the way at a distance from the kerb of a block [m]; None if there is none."""
    inner = shapely.buffer(block, -beyond, join_style="round", quad_segs=2)
    parts = polygons_of(inner)
    if not parts:
        return None
    inner = max(parts, key=shapely.area)
    near = obstacles.near(inner.exterior, radius + 0.1)
    kept = shapely.buffer(near, radius + 0.15, quad_segs=2)
    free = shapely.difference(shapely.Polygon(inner.exterior), shapely.union_all(kept))
    parts = polygons_of(shapely.simplify(free, 0.04))
    return max(parts, key=shapely.area).exterior if parts else None


def paved_parts(
    ring: shapely.LinearRing,  # [m]
    paved: NDArray[np.bool_],  # Whether there is pavement at each of its points, from `along`
    lane: int,  # Index into `LANES`
) -> list[Walkway]:
    """Return the parts of a ring that are on pavement, or all of it."""
    if paved.all():
        return [Walkway(shapely.get_coordinates(ring)[:-1], ring.length, lane)]
    made = []
    for first, last in runs(paved):
        if (last - first) * _EVERY < _SHORTEST:
            continue
        part = substring(ring, first * _EVERY, (last - 1) * _EVERY)
        corners = shapely.get_coordinates(part)
        made.append(Walkway(np.concatenate([corners, corners[-2:0:-1]]), 2.0 * part.length, lane))
    return made


def along(ring: shapely.LinearRing) -> NDArray[np.float64]:
    """Return points along a ring, shape (K, 2) [m]."""
    places = np.arange(int(ring.length / _EVERY)) * _EVERY
    corners = shapely.get_coordinates(ring)
    side = np.diff(corners, axis=0)
    length = np.sqrt(np.square(side).sum(axis=1))
    ends = np.cumsum(length)
    at = np.searchsorted(ends, places, side="right")
    share = (places - np.append(0.0, ends)[at]) / length[at]
    points: NDArray[np.float64] = corners[at] + share[:, None] * side[at]
    return points


def bridged(
    paved: NDArray[np.bool_],  # Which are on pavement, shape (K,)
    hard: NDArray[np.bool_],  # Which are on hard ground, shape (K,)
) -> NDArray[np.bool_]:
    """Return which points are paved, with the driveways that interrupt pavements."""
    paved = paved.copy()
    for first, last in runs(~paved):
        if last - first <= _DRIVEWAY / _EVERY and hard[first:last].all():
            paved[first:last] = True
    return paved


def is_hard(height: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether ground at heights [m] is no lawn."""
    return height > _LAWN
