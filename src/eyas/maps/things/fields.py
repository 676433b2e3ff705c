"""Fields: the crop, its edges, and the tracks of the tractor through it."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.panels import cells, closed
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.roads.areas import GRID, surface
from eyas.engine.world.weather import Season
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.parts import rings
from eyas.maps.plan.plan import Field

_TRAMLINES = 20.0  # Distance from one pair of wheel tracks in a crop to the next [m]
_TRACK, _GAUGE = 0.38, 1.8  # Width of a wheel track, and from its middle to that of the other [m]
_HEADLAND = 5.0  # Distance from the edge of a field to the ends of its tracks [m]
_EDGE = 0.5  # Width of the slope around a crop, whose outermost plants are low [m]
_ABOVE = 0.02  # Height of the tracks above the crop, so that they never flicker [m]


def field_mesh(field: Field, cover: Material, season: Season) -> Mesh:
    """Return a field with its cover of a season."""
    tile = TEXTURES[cover.texture]
    top = surface(field.area, field.z, cover, tile, np.pi / 2 if field.north else 0.0)
    edge = slope(field.area, field.z, _EDGE, cover)
    return concatenate([_tracks(field, season), top, edge])


def slope(area: shapely.Polygon, z: float, width: float, cover: Material) -> Mesh:
    """Return the sides of a heap or a crop, which slope down into the ground around it."""
    rim = rings(area)[0]
    ahead = np.roll(rim, -1, axis=0) - np.roll(rim, 1, axis=0)
    away = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)
    foot = rim + width * away / np.linalg.norm(away, axis=1, keepdims=True)
    low = np.column_stack([foot, np.full(len(foot), FLOOR_HEIGHT - 0.02)])
    high = np.column_stack([rim, np.full(len(rim), z)])
    sides = cells(closed([low, high]))
    return quads(sides, sides[..., :2] / TEXTURES[cover.texture], cover)


def _tracks(field: Field, season: Season) -> Mesh:
    """Return the wheel tracks of a field, cut along the grid."""
    west, south, east, north = field.area.bounds
    low, high, first, last = (
        (south, north, west, east) if field.north else (west, east, south, north)
    )
    middle = np.arange(first + _TRAMLINES / 2, last - _HEADLAND, _TRAMLINES)
    lines = np.concatenate([middle - _GAUGE / 2, middle + _GAUGE / 2])
    steps = int(np.ceil((high - low) / GRID))
    cuts = np.linspace(low + _HEADLAND, high - _HEADLAND, steps + 1)
    across, along = np.meshgrid(lines, np.arange(steps), indexing="ij")
    corners = _strips(across.ravel(), cuts[along.ravel()], cuts[along.ravel() + 1])
    if not field.north:
        corners = corners[:, ::-1, ::-1]
    z = np.full((*corners.shape[:2], 1), field.z + _ABOVE)
    soil = material("soil", (0.82, 0.82, 0.78))
    worn = soil if season is not Season.WINTER else material("soil", (0.9, 0.84, 0.7))
    uvs = corners / TEXTURES["soil"]
    return quads(np.concatenate([corners, z], axis=2), uvs, worn)


def _strips(
    middle: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the corners of strips along y, counter-clockwise, shape (K, 4, 2) [m]."""
    left, right = middle - _TRACK / 2, middle + _TRACK / 2
    x = np.stack([left, right, right, left], axis=1)
    y = np.stack([low, low, high, high], axis=1)
    return np.stack([x, y], axis=2)
