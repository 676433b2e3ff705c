"""Round bales of hay on harvested fields."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.mesh.assembly import transformed
from eyas.mesh.solids import cylinder
from eyas.state.mesh import Mesh
from eyas.state.scene import ObjectClass
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import Levels, SceneBuilder
from eyas.world.plants.gardens import scattered

__all__ = ["add_bales"]

_RADIUS, _LENGTH = 0.75, 1.3
"""Of a bale [m]."""
_APART, _DENSITY = 17.0, 0.0035
"""Least distance between bales [m], and number of attempts on a square metre."""
_FROM_EDGE = 7.0
"""From the edge of a field to its bales [m]."""
_HAY = material("crops_tan", (0.98, 0.9, 0.66))


def add_bales(
    builder: SceneBuilder, areas: Sequence[shapely.Polygon], z: float, rng: np.random.Generator
) -> None:
    """Scatter bales over some of the fields.

    Args:
        builder: The builder to add to.
        areas: Harvested fields [m].
        z: Height of the stubble [m].
        rng: Random numbers of the bales.
    """
    bale = builder.prototype("bale", _bale)
    for area in areas:
        if rng.random() < 0.5:
            continue
        for x, y in scattered(shapely.buffer(area, -_FROM_EDGE), _APART, _DENSITY, rng):
            place, turn = (float(x), float(y), z), float(rng.uniform(0, np.pi))
            owner = builder.add_copy(ObjectClass.STRUCTURE, bale, place, turn, 1.0)
            builder.add_cylinder(place[:2], _RADIUS, z, z + 2 * _RADIUS, owner)


def _bale() -> Levels:
    return tuple(_lying(sides) for sides in (14, 7))


def _lying(sides: int) -> Mesh:
    half = _LENGTH / 2
    drum = cylinder((_RADIUS, _RADIUS), (-half, half), sides, _HAY, cap=True, tile=1.6)
    onto_side = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, _RADIUS]])
    return transformed(drum, onto_side)
