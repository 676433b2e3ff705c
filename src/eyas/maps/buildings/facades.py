"""Appearance of a building: street level, base, shaft and top, roof."""

import zlib
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.state.mesh import Mesh
from eyas.engine.world.build.materials import GROUND_FLOORS, TEXTURES, facade, material
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings import parts
from eyas.maps.buildings.roof_shapes import sloping_roof
from eyas.maps.buildings.skyline import FLOOR
from eyas.maps.plan.plan import BuildingPart

_LOWEST = 0.3  # Lower walls are left out [m]

_LEDGES = 0.08  # How far ledges may lie above or below the edge that they hide [m]

_TALL = 10  # Number of storeys from which a building has a base and a top

_BAND = 11  # Number of storeys after which the windows of a high wall start at another bay

_CROWNS = {
    "facade_brick": "facade_stone",
    "facade_plaster": "facade_old",
    "facade_office": "facade_glass",
    "facade_highrise": "facade_glass",
    "facade_concrete": "facade_bands",
    "facade_red_white": "facade_plaster",
}
"""Facades of the top storeys of high buildings, where they differ from the rest."""


def mesh_of(building: BuildingPart) -> Mesh:
    """Return the outside of a building; the same building always looks the same."""
    rng = chance_of(building)
    shape, foot, top = building.outline, building.bottom, building.top
    # Storeys are stretched a little, so that whole ones fill the wall.
    storeys = max(round(building.height / FLOOR), 1)
    storey = building.height / storeys
    street = storey if building.shops and foot <= FLOOR_HEIGHT and storeys >= 2 else 0.0
    front = facade(GROUND_FLOORS[int(rng.integers(len(GROUND_FLOORS)))], building.tint)
    stone = material("concrete", building.tint)
    meshes: list[Mesh] = []
    for outline in parts.rings(shape) if building.height > _LOWEST else ():
        meshes += _shaft_walls(building, outline, foot + street, storey, rng)
        if street > 0:
            starts = _starts(outline, rng)
            meshes.append(
                parts.window_wall(outline, foot, foot + street, front, starts, storey / FLOOR)
            )
    if street > 0:
        # Not at one height with the next house's, whose plane it would share at the party wall.
        ledge = foot + street + rng.uniform(-_LEDGES, _LEDGES)
        meshes.append(parts.ledge(building.footprint, ledge, stone))
    if building.roof == "pyramid":
        meshes.append(parts.pyramid_roof(building.footprint, top, stone, building.cover))
    elif building.roof != "flat":
        rise, across, covers = building.rise, building.across, (building.cover, stone)
        meshes.append(sloping_roof(shape, building.roof, top, rise, covers, across=across))
    elif building.parapet:
        meshes.append(parts.flat_roof(shape, top, stone, building.cover))
    else:
        meshes.append(flat_polygon(shape, top, building.cover, TEXTURES[building.cover.texture]))
    if building.underside:
        meshes.append(parts.underside(shape, foot, stone))
    return concatenate(meshes)


def prisms_of(building: BuildingPart) -> Iterator[tuple[NDArray[np.float64], float, float]]:
    """Yield outlines without holes, bottoms and tops of solids that fill a building [m]."""
    top = building.top
    if building.roof == "pyramid":
        top += parts.pyramid_rise(building.footprint) / 2
    elif building.roof != "flat":
        top += building.rise / 2
    elif building.parapet:
        top += parts.PARAPET
    for part in _without_holes(building.outline):
        yield parts.rings(part)[0], building.bottom, top


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


def chance_of(building: BuildingPart) -> np.random.Generator:
    """Return the random numbers for the appearance of a building."""
    rings = (building.outline.exterior, *building.outline.interiors)
    points = np.concatenate([shapely.get_coordinates(ring)[:-1] for ring in rings])
    # Seeded by whole millimetres: the last bits of the corners differ between processors.
    corners = np.rint(1000.0 * points).astype("<i8")
    return np.random.Generator(np.random.PCG64(zlib.crc32(corners.tobytes())))


def _starts(outline: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.int64]:
    return rng.integers(0, 4, (len(outline), 1, 2))


def _shaft_walls(
    building: BuildingPart,
    outline: NDArray[np.float64],
    low: float,
    storey: float,
    rng: np.random.Generator,
) -> list[Mesh]:
    """Return the walls above the street: high ones in a base, a shaft of bands, and a top.

    Each band starts at its own bay, so that the pattern of blinds does not repeat up the wall.
    """
    made, top = [], building.top
    stone = material("concrete", building.tint)
    walled = facade(building.facade, building.tint)
    floors = round((top - low) / storey)
    cuts = [low, top]
    if floors >= _TALL:
        base, crown = (int(n) for n in rng.integers(1, 4, 2))
        dark = (0.8 * building.tint[0], 0.8 * building.tint[1], 0.8 * building.tint[2])
        crowned = facade(_CROWNS.get(building.facade, building.facade), building.tint)
        between = np.arange(base, floors - crown - _BAND // 2, _BAND) * storey + low
        cuts = [low, *between.tolist(), top - crown * storey, top]
        made += [parts.ledge(outline, z, stone) for z in (cuts[1], cuts[-2])]
    for k, (bottom, upper) in enumerate(pairwise(cuts)):
        look = walled
        if floors >= _TALL and k in (0, len(cuts) - 2):
            look = crowned if k else facade(building.facade, dark)
        starts = _starts(outline, rng)
        made.append(parts.window_wall(outline, bottom, upper, look, starts, storey / FLOOR))
    return made
