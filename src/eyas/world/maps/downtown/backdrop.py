"""The city beyond the grid: plain blocks that close the view, one object in all."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.state.mesh import Material
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import facade
from eyas.world.maps.downtown.massing import STOREY
from eyas.world.maps.downtown.roads import Grid
from eyas.world.maps.downtown.skyline import facade_of, roof_of
from eyas.world.plan.plan import Backdrop

__all__ = ["backdrop"]

_STEP = (72.0, 66.0)
"""Distances between the middles of neighbours, along the streets and the avenues [m]."""
_REACH = 420.0
"""From the outermost roads to the farthest [m]."""
_APART = 36.0
"""Least distance from blocks, fronts and the park [m]."""
_FROM_EDGE = 30.0
_SHARE = 0.7
"""Share of the places that are built on."""
_SIDES = (17.0, 40.0)
_MEDIAN, _SPREAD, _HIGHEST = 26.0, 0.75, 150.0
"""Median height [m], spread of its logarithm, and limit [m]."""


def backdrop(
    grid: Grid, floor: shapely.Polygon, city: shapely.Geometry, rng: np.random.Generator
) -> Backdrop:
    """Return the city beyond the outer streets.

    Args:
        grid: The grid of the streets.
        floor: The whole floor [m].
        city: Roads, fronts and park [m].
        rng: Random numbers of the backdrop.
    """
    free = shapely.difference(shapely.buffer(floor, -_FROM_EDGE), shapely.buffer(city, _APART))
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
