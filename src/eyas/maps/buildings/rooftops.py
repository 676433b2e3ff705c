"""Equipment of flat roofs: stair heads, cooling units, ducts, skylights, tanks, masts."""

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.solids import box, cylinder, tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels, SceneBuilder
from eyas.lanes import exact

_ROOM = {"stairs": 3.6, "plant": 5.2, "cooler": 1.8, "coolers": 3.4, "duct": 4.6,
         "skylights": 3.4, "tank": 2.0, "vents": 1.6, "panels": 3.3, "mast": 1.2}  # fmt: skip
"""Radius of the free circle that each unit needs [m]."""
_SMALL = ("cooler", "vents", "skylights", "panels", "vents")
_LARGE = ("coolers", "duct", "skylights", "cooler", "vents", "tank", "panels", "duct")
_AREA_EACH = 120.0  # Roof area for each unit [m^2]
_MOST = 16
_HIGH = 45.0  # Roofs above this height have a mast [m]
_FROM_PARAPET = 1.3

_PLASTER = material("concrete", (0.93, 0.92, 0.9))
_SHEET = material("concrete", (0.84, 0.88, 0.92))
_DARK = material("plain", (0.26, 0.27, 0.28))
_ZINC = material("plain", (0.62, 0.64, 0.66))
_GLASS = material("plain", (0.44, 0.54, 0.60))
_SOLAR = Material(tint=(0.10, 0.13, 0.20), surface=Surface.GLASS)

Outline = NDArray[np.float64]


def add_rooftop(builder: SceneBuilder, outline: Outline, top: float, owner: int,
                keep_free: shapely.Geometry, rng: np.random.Generator) -> None:  # fmt: skip
    """Furnish a flat roof; its equipment is part of the building.

    Args:
        outline: Corners of the roof [m], shape (K, 2).
        top: z of the roof [m].
        keep_free: Area where a tower stands on the roof [m].
    """
    units = {kind: builder.prototype(f"roof {kind}", make) for kind, make in UNITS.items()}
    shape = shapely.Polygon(outline)
    free = shapely.buffer(shape, -_FROM_PARAPET, join_style="mitre")
    free = shapely.difference(free, shapely.buffer(keep_free, 1.0))
    axis = outline[1] - outline[0]
    turn = float(exact.atan2(axis[1], axis[0]))
    for kind in _wanted(free.area, top, rng):
        spot = _spot(free, _ROOM[kind], rng)
        if spot is not None:
            free = shapely.difference(free, shapely.Point(spot).buffer(_ROOM[kind] + 0.3))
            quarter = float(rng.integers(4)) * np.pi / 2
            scale = float(rng.uniform(0.85, 1.15))
            place = (float(spot[0]), float(spot[1]), top)
            way = turn + quarter
            builder.add_copy(ObjectClass.BUILDING, units[kind], place, way, scale, owner)


def _wanted(area: float, top: float, rng: np.random.Generator) -> list[str]:
    """Return the units for a roof, the largest first."""
    count = int(np.clip(area / _AREA_EACH, 1 if area > 20.0 else 0, _MOST))
    choice = _LARGE if area > 250.0 else _SMALL
    things = [choice[int(k)] for k in rng.integers(len(choice), size=count)]
    if area > 90.0:
        things.append("stairs")
    if area > 700.0 or (top > _HIGH and area > 250.0):
        things.append("plant")
    if top > _HIGH:
        things.append("mast")
    return sorted(things, key=lambda kind: -_ROOM[kind])


def _spot(free: shapely.Geometry, radius: float, rng: np.random.Generator) -> Outline | None:
    """Return a point at least `radius` within a shape, or None if a few tries find none."""
    room = shapely.buffer(free, -radius)
    if room.is_empty:
        return None
    west, south, east, north = room.bounds
    for _ in range(12):
        point = rng.uniform((west, south), (east, north))
        if shapely.contains_xy(room, *point):
            return np.asarray(point, np.float64)
    return None


def _block(x: float, y: float, z: float, cover: Material, foot: float = 0.0) -> Mesh:
    """Return a box on the roof without its floor."""
    mesh = box((x, y, z), (0.0, 0.0, foot + z / 2), cover, 6.0)
    keep = mesh.normals[mesh.triangles[:, 0], 2] > -0.5
    mesh.triangles, mesh.materials = mesh.triangles[keep], mesh.materials[keep]
    return mesh


def _at(mesh: Mesh, x: float, y: float, z: float = 0.0) -> Mesh:
    return transformed(mesh, np.array([[1.0, 0, 0, x], [0, 1.0, 0, y], [0, 0, 1.0, z]]))


def _fan(x: float, y: float, z: float, radius: float) -> Mesh:
    """Return a dark round opening with a rim: the fan of a cooling unit."""
    rim = cylinder((radius, radius), (z, z + 0.12), 8, _ZINC, cap=False)
    hole = cylinder((radius * 0.9, radius * 0.9), (z, z + 0.07), 8, _DARK, cap=True)
    return concatenate([_at(rim, x, y), _at(hole, x, y)])


def _stairs() -> Mesh:
    """Return the head of a staircase: a door, an overhanging roof, a ladder of grey steps."""
    door = _at(_block(0.06, 1.0, 2.1, _DARK), 2.31, 0.0)
    slab = _at(_block(5.0, 3.8, 0.16, _ZINC), 0.0, 0.0, 2.7)
    return concatenate([_block(4.6, 3.4, 2.7, _PLASTER), door, slab])


def _plant() -> Mesh:
    """Return a plant room with louvres and two large fans."""
    louvres = [_at(_block(0.08, 3.6, 1.4, _DARK), side * 3.82, 0.0, 0.9) for side in (-1, 1)]
    fans = [_fan(x, 0.0, 3.2, 1.2) for x in (-1.8, 1.8)]
    return concatenate([_block(7.6, 5.2, 3.2, _SHEET), *louvres, *fans])


def _coolers() -> Mesh:
    return concatenate([_cooler(x) for x in (-2.1, 0.0, 2.1)])


def _cooler(x: float) -> Mesh:
    body = _at(_block(1.9, 1.7, 1.2, _SHEET, 0.3), x, 0.0)
    grille = _at(_block(1.5, 1.74, 0.7, _DARK, 0.5), x, 0.0)
    return concatenate([body, grille, _fan(x, 0.0, 1.5, 0.66)])


def _duct() -> Mesh:
    """Return an air duct with a bend, on feet."""
    run = _at(_block(6.4, 0.8, 0.6, _ZINC, 0.4), -0.6, 0.0)
    bend = _at(_block(0.8, 2.6, 0.6, _ZINC, 0.4), 3.0, 0.9)
    inlet = _at(_block(1.1, 1.1, 1.3, _SHEET), -3.6, 0.0)
    feet = [_at(_block(0.12, 0.9, 0.4, _DARK), x, 0.0) for x in (-2.0, 0.5)]
    return concatenate([run, bend, inlet, *feet])


def _far_duct() -> Mesh:
    run = _at(_block(7.5, 0.8, 1.0, _ZINC), -0.4, 0.0)
    return concatenate([run, _at(_block(0.8, 2.6, 1.0, _ZINC), 3.0, 0.9)])


def _skylights() -> Mesh:
    """Return four domes on kerbs, two by two."""
    pieces = []
    for x in (-1.4, 1.4):
        for y in (-0.9, 0.9):
            pieces.append(_at(_block(1.7, 1.2, 0.3, _ZINC), x, y))
            dome = cylinder((0.62, 0.42), (0.3, 0.52), 6, _GLASS, cap=True)
            pieces.append(_at(dome, x, y))
    return concatenate(pieces)


def _tank(sides: int) -> Mesh:
    drum = cylinder((1.0, 1.0), (0.5, 2.3), sides, _ZINC, cap=True)
    legs = [_at(_block(0.12, 0.12, 0.5, _DARK), x, y) for x in (-0.6, 0.6) for y in (-0.6, 0.6)]
    return concatenate([drum, *(legs if sides > 5 else [])])


def _panels() -> Mesh:
    """Return three rows of solar panels, which lean against one side."""
    rows = [box((4.6, 1.1, 0.08), (0.0, 0.0, 0.35), _SOLAR, 1.0) for _ in range(3)]
    for row, y in zip(rows, (-1.5, 0.0, 1.5), strict=True):
        row.positions[:, 2] += 0.4 * row.positions[:, 1]
        row.positions[:, 1] += y
    return concatenate(rows)


def _vents(sides: int) -> Mesh:
    """Return a few pipes with caps."""
    spots = ((-0.8, -0.3, 0.9), (0.0, 0.5, 0.7), (0.7, -0.2, 1.1))
    return concatenate([_pipe(*spot, sides) for spot in spots])


def _pipe(x: float, y: float, height: float, sides: int) -> Mesh:
    pipe = cylinder((0.13, 0.13), (0.0, height), sides, _ZINC)
    hat = cylinder((0.26, 0.1), (height, height + 0.16), sides, _DARK, cap=True)
    return concatenate([_at(pipe, x, y), _at(hat, x, y)])


def _mast(sides: int) -> Mesh:
    """Return a mast with a few aerials."""
    spars = np.array([(3.6, 0.7), (5.0, 0.5), (5.8, 0.35)])
    ends = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    arms = [tube(ends * half + np.array([0, 0, z]), [0.03, 0.03], 3, _DARK) for z, half in spars]
    return concatenate([tube(np.diag([0, 0, 7.0])[[0, 2]], [0.09, 0.04], sides, _ZINC), *arms])


UNITS: dict[str, Callable[[], Levels]] = {
    "stairs": lambda: (_stairs(), _block(4.6, 3.4, 2.7, _PLASTER)),
    "plant": lambda: (_plant(), _block(7.6, 5.2, 3.2, _SHEET)),
    "cooler": lambda: (_cooler(0.0), _block(1.9, 1.7, 1.5, _SHEET)),
    "coolers": lambda: (_coolers(), _block(6.1, 1.7, 1.5, _SHEET)),
    "duct": lambda: (_duct(), _far_duct()),
    "skylights": lambda: (_skylights(), _block(4.6, 3.0, 0.5, _GLASS)),
    "tank": lambda: (_tank(10), _tank(5)),
    "panels": lambda: (_panels(), _block(4.6, 4.0, 0.4, _SOLAR)),
    "vents": lambda: (_vents(6), _vents(3)),
    "mast": lambda: (_mast(5), _mast(3)),
}
"""Maker of each kind of unit; origin on the roof, in metres."""
