"""Water tanks of wood on iron legs, and where they stand on the roofs of old buildings."""

import numpy as np
import shapely

from eyas.core import exact
from eyas.mesh.assembly import concatenate
from eyas.mesh.solids import box, cylinder
from eyas.state.mesh import Mesh
from eyas.state.scene import ObjectClass
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import Levels, SceneBuilder
from eyas.world.buildings.placing import Building

__all__ = ["add_water_tank"]

_RADIUS, _LEGS, _DRUM, _CAP = 1.9, 3.0, 3.6, 1.3
"""Radius, and heights of legs, drum and roof [m]."""
_STAVES = material("bark", (0.78, 0.60, 0.46))
_IRON = material("plain", (0.17, 0.16, 0.16))
_TAR = material("plain", (0.30, 0.28, 0.27))
_ON = ("facade_brick", "facade_stone", "facade_red_white", "facade_old", "facade_concrete")
_TOPS = (17.0, 130.0)
"""Heights of the roofs with tanks: below, the pressure of the mains is enough [m]."""
_ODDS = 0.62


def add_water_tank(
    builder: SceneBuilder,
    building: Building,
    owner: int,
    free: shapely.Geometry,
    rng: np.random.Generator,
) -> shapely.Geometry:
    """Add a tank to the roof of an old building; return the rest of the free roof.

    Args:
        builder: The builder to add to.
        building: The building or the part of it under the roof.
        owner: Its object.
        free: Roof on which nothing stands yet [m].
        rng: Random numbers of the building.
    """
    top = building.bottom + building.height
    fits = building.facade in _ON and _TOPS[0] < top < _TOPS[1] and building.roof == "flat"
    room = shapely.buffer(free, -2.6)
    if not fits or rng.random() > _ODDS or room.is_empty:
        return free
    west, south, east, north = room.bounds
    for _ in range(8):
        x, y = np.round(rng.uniform((west, south), (east, north)), 3)
        if shapely.contains_xy(room, x, y):
            kind = builder.prototype("water tank", tank_levels)
            side = building.footprint[1] - building.footprint[0]
            turn = float(exact.atan2(side[1], side[0]))
            scale = float(rng.uniform(0.85, 1.2))
            place = (float(x), float(y), top)
            builder.add_copy(ObjectClass.BUILDING, kind, place, turn, scale, owner)
            return shapely.difference(free, shapely.Point(x, y).buffer(2.9))
    return free


def tank_levels() -> Levels:
    """Return a water tank that stands on the origin, the finest level of detail first."""
    return _tank(14, legs=True), _tank(7, legs=True), _tank(5, legs=False)


def _tank(sides: int, *, legs: bool) -> Mesh:
    top = _LEGS + _DRUM
    parts = [
        cylinder((_RADIUS, 0.94 * _RADIUS), (_LEGS, top), sides, _STAVES, tile=2.0),
        cylinder((1.06 * _RADIUS, 0.0), (top, top + _CAP), sides, _TAR),
        cylinder((_RADIUS, _RADIUS), (_LEGS - 0.2, _LEGS), sides, _IRON, cap=True),
    ]
    if sides > 10:  # hoops, closer together below, where the pressure is higher
        parts += [
            cylinder((1.015 * _RADIUS, 1.01 * _RADIUS), (z, z + 0.09), sides, _IRON)
            for z in _LEGS + np.array([0.25, 0.75, 1.4, 2.2, 3.1])
        ]
    reach = 0.66 * _RADIUS
    if legs:
        parts += [
            box((0.22, 0.22, _LEGS), (x, y, _LEGS / 2), _IRON, 1.0)
            for x in (-reach, reach)
            for y in (-reach, reach)
        ]
        parts += [
            box((2.2 * reach, 0.12, 0.14), (0.0, y, 1.5), _IRON, 1.0) for y in (-reach, reach)
        ]
    else:
        parts.append(box((2 * reach, 2 * reach, _LEGS), (0.0, 0.0, _LEGS / 2), _IRON, 1.0))
    return concatenate(parts)
