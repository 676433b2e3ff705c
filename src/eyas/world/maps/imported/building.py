"""Imported buildings as triangles and solids; footprints may have courtyards."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import flat_polygon, walls
from eyas.state.mesh import Material, Mesh
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import GROUND_FLOORS, TEXTURES, facade, material
from eyas.world.buildings import parts
from eyas.world.buildings.placing import PARAPET
from eyas.world.buildings.roof_shapes import sloping_roof
from eyas.world.buildings.skyline import FLOOR
from eyas.world.maps.imported.looks import Look

__all__ = ["building_mesh", "solids_of"]

_BAND = 11
"""Number of storeys after which the windows of a high wall start at another bay."""
_NO_PARAPET = 60.0
"""Smaller flat roofs have none [m^2]."""
_STONE_TILE = 6.0

Outline = NDArray[np.float64]


def building_mesh(look: Look) -> Mesh:
    """Return the outside of a building; the same building always looks the same."""
    rng = np.random.Generator(np.random.PCG64(look.chance))
    stone = material("concrete", look.tint)
    made = _walls(look, stone, rng)
    if look.roof == "flat":
        made.append(_flat_roof(look, stone))
    else:
        made.append(
            sloping_roof(
                look.shape,
                look.roof,
                look.eaves,
                look.rise,
                (look.cover, stone),
                across=look.across,
            )
        )
    if look.bottom > FLOOR_HEIGHT + 2.0:
        made.append(_underside(look, stone))
    return concatenate(made)


def solids_of(look: Look) -> Iterator[tuple[Outline, float, float]]:
    """Yield outlines without holes, bottoms and tops of solids that fill a building [m]."""
    top = look.eaves + (0.5 * look.rise if look.roof != "flat" else _parapet(look))
    for part in _without_holes(look.shape):
        yield _ring(shapely.geometry.polygon.orient(part).exterior), look.bottom, top


def _walls(look: Look, stone: Material, rng: np.random.Generator) -> list[Mesh]:
    """Return the walls of all outlines: street level, and bands of storeys above it."""
    made: list[Mesh] = []
    high = look.eaves - look.bottom
    if high < 0.3:
        return made
    storeys = max(round(high / FLOOR), 1)
    # Storeys are stretched a little, so that whole ones fill the wall.
    storey = high / storeys
    street = int(look.front and storeys >= 2)
    cuts = [street, *range(street + _BAND, storeys - _BAND // 2, _BAND), storeys]
    walled = facade(look.facade, look.tint)
    front = facade(GROUND_FLOORS[int(rng.integers(len(GROUND_FLOORS)))], look.tint)
    outlines = _outlines(look.shape)
    for outline in outlines:
        if street:
            made.append(_storeys(outline, look.bottom, (0, 1), storey, front, rng))
        for low, top in pairwise(cuts):
            made.append(_storeys(outline, look.bottom, (low, top), storey, walled, rng))
    if street:
        made.append(parts.ledge(outlines[0], look.bottom + storey, stone))
    return made


def _storeys(
    outline: Outline,
    foot: float,
    span: tuple[int, int],
    storey: float,
    wall: Material,
    rng: np.random.Generator,
) -> Mesh:
    """Return walls of whole storeys, from one number to another, each `storey` high [m]."""
    mesh = parts.window_wall(outline, span[0] * FLOOR, span[1] * FLOOR, wall, rng)
    mesh.positions[:, 2] = foot + mesh.positions[:, 2] * (storey / FLOOR)
    return mesh


def _parapet(look: Look) -> float:
    return PARAPET if look.shape.area > _NO_PARAPET else 0.0


def _flat_roof(look: Look, stone: Material) -> Mesh:
    """Return a flat roof, with a parapet round its outlines unless it is small."""
    shape, top, tile = look.shape, look.eaves, TEXTURES[look.cover.texture]
    if not _parapet(look):
        return flat_polygon(shape, top, look.cover, tile)
    inside = shapely.buffer(shape, -0.35, join_style="mitre")
    rings = _outlines(shape)
    rings += [ring[::-1] for part in shapely.get_parts(inside) for ring in _outlines(part)]
    made = [walls(ring, top, top + PARAPET, stone, _STONE_TILE) for ring in rings]
    made.append(flat_polygon(shape - inside, top + PARAPET, stone, _STONE_TILE))
    return concatenate([*made, flat_polygon(inside, top, look.cover, tile)])


def _underside(look: Look, stone: Material) -> Mesh:
    mesh = flat_polygon(look.shape, look.bottom, stone, _STONE_TILE)
    mesh.triangles = np.ascontiguousarray(mesh.triangles[:, ::-1])
    mesh.normals = -mesh.normals
    return mesh


def _without_holes(shape: shapely.Polygon) -> list[shapely.Polygon]:
    """Return a shape cut through the middles of its holes until none is left."""
    if not shape.interiors:
        return [shape]
    middle = shape.interiors[0].centroid.x
    west, south, east, north = shape.bounds
    halves = (shapely.box(west, south, middle, north), shapely.box(middle, south, east, north))
    return [
        piece
        for half in halves
        for part in shapely.get_parts(shapely.intersection(shape, half))
        if isinstance(part, shapely.Polygon) and part.area > 1e-3
        for piece in _without_holes(part)
    ]


def _outlines(shape: shapely.Polygon) -> list[Outline]:
    """Return the outlines of a shape, each with the inside of the shape on its left [m]."""
    solid = shapely.geometry.polygon.orient(shape)
    return [_ring(ring) for ring in (solid.exterior, *solid.interiors)]


def _ring(ring: shapely.LinearRing) -> Outline:
    """Return the corners of a ring in its order, the first not repeated, shape (K, 2) [m]."""
    return np.ascontiguousarray(shapely.get_coordinates(ring)[:-1], np.float64)
