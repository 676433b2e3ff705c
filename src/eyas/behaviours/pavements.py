"""Ways round blocks on their pavements."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.behaviours.obstacles import Obstacles
from eyas.behaviours.surface import Surface
from eyas.state.roads import RoadNetwork
from eyas.world.roads.areas import blocks, corridors, polygons_of

__all__ = ["LANES", "pavement_rings"]

LANES: Final = (1.0, 1.9)
"""Distances from the kerb of those who have the block on their left, and on their right [m]."""

_SHARE: Final = 0.97
"""Least share of a way that lies on a pavement."""

_SHORTEST: Final = 60.0
"""Least length of a way [m]."""

_EVERY: Final = 1.0
"""Distance between points that are tested for pavement [m]."""


class _Ring(NamedTuple):
    """A closed way."""

    corners: NDArray[np.float64]
    """[m], shape (K, 2), the last not the first again; the block on the left if `LANES[0]`."""
    length: float
    """[m]"""


def pavement_rings(
    network: RoadNetwork,
    size: tuple[float, float],
    obstacles: Obstacles,
    surface: Surface,
    radius: float,
) -> list[_Ring]:
    """Return the ways round all blocks that have pavements all round, in both directions.

    They lead round what stands on the pavement.

    Args:
        network: The roads.
        size: Extent of the map [m].
        obstacles: What stands in the way.
        surface: The ground.
        radius: Distance to obstacles that is kept [m].
    """
    if not len(network.lane_width):
        return []
    extent = shapely.box(-size[0] / 2, -size[1] / 2, size[0] / 2, size[1] / 2)
    closed, _ = blocks(corridors(network), extent)
    found = []
    for block in closed:
        for lane, beyond in enumerate(LANES):
            ring = _ring(block, beyond, obstacles, radius)
            if ring is None or ring.length < _SHORTEST:
                continue
            points = shapely.line_interpolate_point(ring, np.arange(0.0, ring.length, _EVERY))
            if surface.at(shapely.get_coordinates(points)).pavement.mean() < _SHARE:
                continue
            corners = shapely.get_coordinates(ring)[:-1]
            anticlockwise = shapely.is_ccw(ring) == (lane == 0)
            found.append(_Ring(corners if anticlockwise else corners[::-1], ring.length))
    return found


def _ring(
    block: shapely.Polygon, beyond: float, obstacles: Obstacles, radius: float
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
