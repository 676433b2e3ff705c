"""On old buildings: awnings over shops, fire escapes on walls of brick, water tanks on roofs."""

from collections.abc import Iterator
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box, cylinder
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.millimetres import length, unit
from eyas.engine.world.build.scene_builder import Levels, SceneBuilder
from eyas.lanes import exact
from eyas.maps.build.heights import KERB_HEIGHT
from eyas.maps.plan.plan import BuildingPart

_SHOPS = ("facade_brick", "facade_red_white", "facade_old", "facade_plaster", "facade_stone")
_BRICK = ("facade_brick", "facade_red_white", "facade_old")
_AWNED, _ESCAPED = 0.5, 0.75
"""Shares of these fronts with awnings, and of old walls with a fire escape."""
_TALLEST = 27.0  # Height of the highest wall with a fire escape [m]
_STOREY = _BAY = 3.0
_ROOM = 5.0  # A front is longer than this and has a pavement at three fifths of it [m]
_CLOTH = (
    (0.16, 0.34, 0.22),
    (0.58, 0.12, 0.12),
    (0.14, 0.20, 0.38),
    (0.85, 0.80, 0.66),
    (0.80, 0.42, 0.12),
    (0.15, 0.15, 0.16),
)
_IRON = material("plain", (0.13, 0.13, 0.14))

_TANK, _LEGS, _DRUM, _CAP = 1.9, 3.0, 3.6, 1.3  # Radius, and heights of legs, drum and roof [m]
_STAVES = material("bark", (0.78, 0.60, 0.46))
_TANK_IRON = material("plain", (0.17, 0.16, 0.16))
_TAR = material("plain", (0.30, 0.28, 0.27))
_ON = ("facade_brick", "facade_stone", "facade_red_white", "facade_old", "facade_concrete")
_TOPS = (17.0, 130.0)
"""Heights of the roofs with tanks: below, the pressure of the mains is enough [m]."""
_ODDS = 0.62

Points = NDArray[np.float64]


def add_fronts(
    builder: SceneBuilder,
    building: BuildingPart,
    owner: int,
    pavement: shapely.Geometry,  # Pavements, prepared [m]
    rng: np.random.Generator,
) -> None:
    """Hang awnings and fire escapes on the walls of a building that face a street."""
    if building.facade not in _SHOPS:
        return
    cloth = int(rng.integers(len(_CLOTH)))
    awning = builder.prototype(f"awning {cloth}", partial(_awning, cloth))
    escape = builder.prototype("fire escape", _escape_levels)
    old = building.facade in _BRICK and 11.0 < building.height < _TALLEST
    for start, along in _fronts(building, pavement):
        turn = float(exact.atan2(along[1], along[0]))
        bays = max(round(length(along) / _BAY), 1)
        at = [start + k / (2 * bays) * along for k in range(2 * bays)]
        if rng.random() < _AWNED:
            first = int(rng.integers(0, max(bays - 2, 1)))
            last = min(first + int(rng.integers(1, 5)), bays)
            for x, y in at[2 * first + 1 : 2 * last : 2]:
                spot = (float(x), float(y), KERB_HEIGHT + 2.35)
                builder.add_copy(ObjectClass.BUILDING, awning, spot, turn, 1.0, owner)
        if old and bays >= 2 and rng.random() < _ESCAPED:
            x, y = at[2 * int(rng.integers(1, bays))]
            for floor in range(1, int(building.height // _STOREY)):
                spot = (float(x), float(y), building.bottom + _STOREY * floor + 0.35)
                builder.add_copy(ObjectClass.BUILDING, escape, spot, turn, 1.0, owner)


def _fronts(building: BuildingPart, pavement: shapely.Geometry) -> Iterator[tuple[Points, Points]]:
    """Yield the start of each wall that faces a pavement, and the vector along it [m]."""
    corners = building.footprint
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = end - start
        if length(along) > _ROOM:
            onwards = unit(along)
            out = start + along / 2 + 0.6 * _ROOM * np.array([onwards[1], -onwards[0]])
            if shapely.contains_xy(pavement, *np.round(out, 3)):
                yield start, along


def _awning(index: int) -> Levels:
    """Return an awning one bay wide over y < 0, in front of a wall along x."""
    cloth = Material(tint=_CLOTH[index])
    half, deep, high, hem = 0.48 * _BAY, 1.25, 0.75, -0.22
    left, right = (
        [(x, 0.0, high), (x, 0.0, hem), (x, -deep, hem), (x, -deep, 0.0)] for x in (-half, half)
    )
    slope = [right[0], left[0], left[3], right[3]]
    front = [left[3], left[2], right[2], right[3]]
    faces = np.array([slope, front, left, right[::-1]])
    return (quads(faces, np.zeros((len(faces), 4, 2)), cloth),)


def _escape_levels() -> Levels:
    """Return one storey of a fire escape: a platform, its rails, the stairs to the next."""
    platform = box((3.4, 1.0, 0.06), (0.0, -0.5, 0.0), _IRON, 1.0)
    rails = [box((3.4, 0.04, 0.05), (0.0, -0.98, z), _IRON, 1.0) for z in (0.95, 0.5)]
    ends = [box((0.05, 1.0, 0.05), (x, -0.5, 0.95), _IRON, 1.0) for x in (-1.68, 1.68)]
    posts = [
        box((0.05, 0.05, 0.95), (x, -0.98, 0.48), _IRON, 1.0) for x in (-1.68, -0.56, 0.56, 1.68)
    ]
    flight = np.array(
        [[-1.1, -0.72, 0.0], [-1.1, -0.24, 0.0], [1.2, -0.24, 3.0], [1.2, -0.72, 3.0]]
    )
    stairs = quads(np.stack([flight, flight[::-1]]), np.zeros((2, 4, 2)), _IRON)
    near = concatenate([platform, *rails, *ends, *posts, stairs])
    return near, concatenate([platform, rails[0], stairs])


def add_water_tank(
    builder: SceneBuilder,
    building: BuildingPart,  # The building or the part of it under the roof
    owner: int,
    free: shapely.Geometry,  # Roof on which nothing stands yet [m]
    rng: np.random.Generator,
) -> shapely.Geometry:
    """Add a tank to the roof of an old building; return the rest of the free roof."""
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
        cylinder((_TANK, 0.94 * _TANK), (_LEGS, top), sides, _STAVES, tile=2.0),
        cylinder((1.06 * _TANK, 0.0), (top, top + _CAP), sides, _TAR),
        cylinder((_TANK, _TANK), (_LEGS - 0.2, _LEGS), sides, _TANK_IRON, cap=True),
    ]
    if sides > 10:  # hoops, closer together below, where the pressure is higher
        parts += [
            cylinder((1.015 * _TANK, 1.01 * _TANK), (z, z + 0.09), sides, _TANK_IRON)
            for z in _LEGS + np.array([0.25, 0.75, 1.4, 2.2, 3.1])
        ]
    reach = 0.66 * _TANK
    if legs:
        parts += [
            box((0.22, 0.22, _LEGS), (x, y, _LEGS / 2), _TANK_IRON, 1.0)
            for x in (-reach, reach)
            for y in (-reach, reach)
        ]
        parts += [
            box((2.2 * reach, 0.12, 0.14), (0.0, y, 1.5), _TANK_IRON, 1.0) for y in (-reach, reach)
        ]
    else:
        parts.append(box((2 * reach, 2 * reach, _LEGS), (0.0, 0.0, _LEGS / 2), _TANK_IRON, 1.0))
    return concatenate(parts)
