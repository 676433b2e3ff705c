"""Appearance of a building: street level, base, shaft and top, roof."""

import zlib
from itertools import pairwise

import numpy as np

from eyas.mesh.assembly import concatenate
from eyas.state.mesh import Material, Mesh
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import GROUND_FLOORS, facade, material
from eyas.world.buildings import parts
from eyas.world.buildings.placing import PARAPET, Building
from eyas.world.buildings.skyline import FLOOR

__all__ = ["chance_of", "mesh_of"]

_TALL = 10
"""Number of storeys from which a building has a base and a top."""

_BAND = 11
"""Number of storeys after which the windows of a high wall start at another bay."""

_CROWNS = {
    "facade_brick": "facade_stone",
    "facade_plaster": "facade_old",
    "facade_office": "facade_glass",
    "facade_highrise": "facade_glass",
    "facade_concrete": "facade_bands",
    "facade_red_white": "facade_plaster",
}
"""Facades of the top storeys of high buildings, where they differ from the rest."""


def mesh_of(building: Building) -> Mesh:
    """Return the outside of a building; the same building always looks the same."""
    rng = chance_of(building)
    foot, outline = building.bottom, building.footprint
    top = foot + building.height
    street = min(FLOOR, building.height - FLOOR) if foot <= FLOOR_HEIGHT else 0.0
    front = facade(GROUND_FLOORS[int(rng.integers(len(GROUND_FLOORS)))], building.tint)
    stone = material("concrete", building.tint)
    meshes = _shaft_walls(building, foot + street, top, stone, rng)
    if street > 0:
        meshes.append(parts.window_wall(outline, foot, foot + street, front, rng))
        meshes.append(parts.ledge(outline, foot + street, stone))
    if building.roof == "flat":
        meshes.append(parts.flat_roof(outline, top, PARAPET, stone, building.roof_material))
    else:
        meshes.append(parts.pyramid_roof(outline, top, stone, building.roof_material))
    return concatenate(meshes)


def chance_of(building: Building) -> np.random.Generator:
    """Return the random numbers for the appearance of a building."""
    # Seeded by whole millimetres: the last bits of the corners differ between processors.
    corners = np.rint(1000.0 * building.footprint).astype("<i8")
    return np.random.Generator(np.random.PCG64(zlib.crc32(corners.tobytes())))


def _shaft_walls(
    building: Building, low: float, top: float, stone: Material, rng: np.random.Generator
) -> list[Mesh]:
    """Return the walls above the street: high ones in a base, a shaft of bands, and a top.

    Each band starts at its own bay, so that the pattern of blinds does not repeat up the wall.
    """
    made = []
    walled = facade(building.facade, building.tint)
    floors = round((top - low) / FLOOR)
    cuts = [low, top]
    if floors >= _TALL:
        base, crown = (int(n) for n in rng.integers(1, 4, 2))
        dark = (0.8 * building.tint[0], 0.8 * building.tint[1], 0.8 * building.tint[2])
        crowned = facade(_CROWNS.get(building.facade, building.facade), building.tint)
        between = np.arange(base, floors - crown - _BAND // 2, _BAND) * FLOOR + low
        cuts = [low, *between.tolist(), top - crown * FLOOR, top]
        made += [parts.ledge(building.footprint, z, stone) for z in (cuts[1], cuts[-2])]
    for k, (bottom, upper) in enumerate(pairwise(cuts)):
        look = walled
        if floors >= _TALL and k in (0, len(cuts) - 2):
            look = crowned if k else facade(building.facade, dark)
        made.append(parts.window_wall(building.footprint, bottom, upper, look, rng))
    return made
