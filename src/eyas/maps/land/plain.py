"""Wide, level ground: cut into small squares where roads are, into large ones elsewhere."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.flat import flat_polygons
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES
from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.roads.areas import polygons_of, split_on_grid
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT

__all__ = ["blob", "far_plain", "plain", "rectangle"]

_CELL, _WIDE_CELL = 128.0, 1280.0  # Sides of the squares near roads and elsewhere [m]
_FAR, _FAR_CELL = 28_000.0, 1750.0
"""Extent of the ground beyond the floor, and the side of its squares [m]."""
_BELOW = 0.05
"""Depth of that ground below the floor, so that rounding never makes it show through [m]."""
_CORNERS = 24


def plain(
    area: shapely.Geometry, near: shapely.Geometry, cover: Material, z: float = FLOOR_HEIGHT
) -> Mesh:
    """Return level ground.

    Args:
        area: The ground [m].
        near: Where it is cut into small squares, so that those out of sight are skipped [m].
        z: Its height [m].
    """
    pieces = []
    # First into large squares: cutting small ones out of everything at once takes far longer.
    for piece in split_on_grid(area, _WIDE_CELL):
        pieces += split_on_grid(shapely.intersection(piece, near), _CELL)
        pieces += polygons_of(shapely.difference(piece, near))
    return flat_polygons(pieces, z, cover, TEXTURES[cover.texture])


def far_plain(floor: tuple[float, float], cover: Material) -> Mesh:
    """Return the ground beyond a floor, up to the horizon.

    Args:
        floor: Extent of the floor [m].
    """
    ring = shapely.difference(rectangle(_FAR, _FAR), rectangle(*floor))
    pieces = split_on_grid(ring, _FAR_CELL)
    return flat_polygons(pieces, FLOOR_HEIGHT - _BELOW, cover, TEXTURES[cover.texture])


def blob(middle: NDArray[np.float64], radius: float, rng: np.random.Generator) -> shapely.Polygon:
    """Return a round shape with an uneven outline, such as a lake.

    Args:
        middle: Its middle, shape (2,) [m].
        radius: Its mean radius [m].
    """
    angle = np.linspace(0.0, 2 * np.pi, _CORNERS, endpoint=False)
    phase, swing = rng.uniform(0, 2 * np.pi, (3, 1)), rng.uniform(0.05, 0.16, (3, 1))
    waves = 1.0 + (swing * exact.sin(angle * [[1], [2], [3]] + phase)).sum(axis=0)
    ring = np.stack([exact.cos(angle), exact.sin(angle)], axis=1)
    return shapely.Polygon(rounded(middle + radius * waves[:, None] * ring))


def rectangle(width: float, height: float) -> shapely.Polygon:
    """Return a rectangle about the origin [m]."""
    return shapely.box(-width / 2, -height / 2, width / 2, height / 2)
