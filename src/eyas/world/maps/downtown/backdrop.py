"""The city beyond the grid: plain blocks that close the view, one object in all."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import quads
from eyas.state.mesh import Mesh
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES, facade
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.buildings.parts import window_wall
from eyas.world.maps.downtown.massing import STOREY
from eyas.world.maps.downtown.roads import Grid
from eyas.world.maps.downtown.skyline import facade_of, roof_of

__all__ = ["add_backdrop"]

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


def add_backdrop(
    builder: SceneBuilder,
    grid: Grid,
    floor: shapely.Polygon,
    city: shapely.Geometry,
    rng: np.random.Generator,
) -> None:
    """Add the city beyond the outer streets.

    Args:
        builder: The builder to add to.
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
    made: list[tuple[NDArray[np.float64], float]] = []
    meshes: list[Mesh] = []
    for place in places:
        side = np.round(rng.uniform(*_SIDES, 2) / 3.0) * 1.5
        height = min(_MEDIAN * float(exact.exp(exact.normal(rng, 0.0, _SPREAD))), _HIGHEST)
        top = FLOOR_HEIGHT + STOREY * max(round(height / STOREY), 2)
        corners = place + side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        outline = grid.world(corners)
        if rng.random() < _SHARE and shapely.contains(free, shapely.Polygon(outline)):
            meshes.append(_block(outline, top, rng))
            made.append((outline, top))
    if made:
        owner = builder.add(ObjectClass.BUILDING, concatenate(meshes))
        for outline, top in made:
            builder.add_prism(outline, FLOOR_HEIGHT, top, owner)


def _block(outline: NDArray[np.float64], top: float, rng: np.random.Generator) -> Mesh:
    """Return a box with windows and a flat roof."""
    kind, tint = facade_of(top, rng)
    cover = roof_of(rng)
    walls = window_wall(outline, FLOOR_HEIGHT, top, facade(kind, tint), rng)
    corners = np.column_stack([outline, np.full(4, top)])
    return concatenate([walls, quads([corners], [outline / TEXTURES[cover.texture]], cover)])
