"""What lies and stands about in streets: litter, leaves, drains, signs, cafes, bicycles, rubbish.

Origins are on the ground; the side towards the road faces along y. Lengths are in metres. Nothing
of it is solid, and nobody walks where it stands, see `eyas.maps.street.dressing`.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Final

import numpy as np

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box, cylinder, sphere
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact
from eyas.maps.street.parked_cars import bicycle_levels

_ABOVE: Final = 0.02  # Height of flat things above the ground, which keeps two surfaces apart [m]

_LAYER: Final = 0.003
"""Height between scraps of different colours, of which one may lie on another [m]."""

_IRON = material("plain", (0.16, 0.17, 0.18))
_STEEL = material("plain", (0.58, 0.60, 0.62))
_WOOD = material("bark", (0.70, 0.54, 0.42))
_STONE = material("concrete", (0.78, 0.75, 0.70))
_LEAVES = material("foliage", (0.7, 0.85, 0.5))
_CABINET = material("plain", (0.42, 0.47, 0.43))
_WHITE = material("plain", (0.90, 0.90, 0.88))
_CARD = material("plain", (0.62, 0.48, 0.32))
_BAGS = (material("plain", (0.07, 0.07, 0.08)), material("plain", (0.10, 0.14, 0.24)))
_LIDDED = tuple(
    material("plain", tint)
    for tint in ((0.14, 0.27, 0.18), (0.13, 0.20, 0.38), (0.26, 0.26, 0.27), (0.45, 0.30, 0.10))
)
_PARASOLS = ((0.66, 0.13, 0.11), (0.90, 0.87, 0.78), (0.15, 0.36, 0.25), (0.88, 0.60, 0.14))
_FLOWERS = ((0.85, 0.20, 0.26), (0.93, 0.76, 0.20), (0.72, 0.42, 0.78))
_PAPER = (
    *((0.93, 0.93, 0.90), (0.82, 0.80, 0.74), (0.74, 0.16, 0.12), (0.62, 0.48, 0.32)),
    *((0.20, 0.36, 0.62), (0.92, 0.90, 0.55)),
)
_FALLEN = ((0.44, 0.31, 0.15), (0.52, 0.41, 0.20), (0.33, 0.23, 0.12), (0.47, 0.45, 0.22))
_SIGNS = ((0.10, 0.26, 0.60), (0.72, 0.10, 0.10), (0.13, 0.38, 0.24))

_SPREAD: Final = (1.1, 0.35)  # Half the length and half the width of a patch of litter [m]


def _part(
    size: tuple[float, float, float], centre: tuple[float, float, float], cover: Material
) -> Mesh:
    return box(size, centre, cover, 1.0)


def _moved(mesh: Mesh, place: Sequence[float], size: float = 1.0) -> Mesh:
    return transformed(mesh, np.column_stack([size * np.eye(3), place]))


def _scraps(
    which: int, tints: Sequence[tuple[float, float, float]], sizes: tuple[float, float], count: int
) -> Levels:
    """Return scraps that lie about, the largest of them also in the far level."""
    rng = np.random.Generator(np.random.PCG64(7919 * which + count))
    place = rng.uniform(-1.0, 1.0, (count, 2)) * _SPREAD
    half = 0.5 * np.sort(rng.uniform(*sizes, count))[::-1]
    made = []
    for k in range(count):
        turn, aspect = float(rng.uniform(0.0, np.pi)), float(rng.uniform(0.5, 1.0))
        ahead = half[k] * np.array([exact.cos(turn), exact.sin(turn)])
        aside = aspect * np.array([-ahead[1], ahead[0]])
        corners = [ahead + aside, aside - ahead, -ahead - aside, ahead - aside]
        tint = int(rng.integers(len(tints)))
        height = _ABOVE + (5 + tint) * _LAYER  # over the bars of a drain, too
        flat = np.array([[*(place[k] + corner), height] for corner in corners])
        cover = material("plain", tints[tint])
        made.append(quads([flat], np.zeros((1, 4, 2)), cover))
    return concatenate(made), concatenate(made[: count // 3])


def _drain() -> Levels:
    """Return the grate of a gully, a frame with bars across a dark hole."""
    plate = np.array([[-0.24, -0.13], [0.24, -0.13], [0.24, 0.13], [-0.24, 0.13]])
    bars = []
    for x in np.linspace(-0.2, 0.2, 6):
        bar = np.array([[x - 0.018, -0.1], [x + 0.018, -0.1], [x + 0.018, 0.1], [x - 0.018, 0.1]])
        bars.append(np.column_stack([bar, np.full(4, _ABOVE + 0.012)]))
    low = np.column_stack([plate, np.full(4, _ABOVE)])
    hole = quads([low], np.zeros((1, 4, 2)), material("plain", (0.06, 0.06, 0.06)))
    grate = quads(bars, np.zeros((len(bars), 4, 2)), material("plain", (0.24, 0.23, 0.22)))
    return concatenate([hole, grate]), hole


def _sign(which: int) -> Levels:
    """Return a traffic sign on its pole: square, round, or the stop of a bus line."""
    pole = cylinder((0.035, 0.035), (0.0, 2.5), 6, _STEEL)
    face = material("plain", _SIGNS[which])
    plate = _part((0.5, 0.03, 0.5 if which < 2 else 0.7), (0.0, 0.06, 2.2), face)
    mark = _part((0.22, 0.02, 0.3), (0.0, 0.095, 2.22), _WHITE)
    return concatenate([pole, plate, mark]), concatenate(
        [_part((0.06, 0.06, 2.5), (0, 0, 1.25), _STEEL), plate]
    )


def _cabinet() -> Levels:
    body = _part((1.1, 0.38, 1.15), (0.0, 0.0, 0.575), _CABINET)
    top = _part((1.16, 0.44, 0.05), (0.0, 0.0, 1.19), _STEEL)
    return (concatenate([body, top]),)


def _planter(which: int) -> Levels:
    """Return a long box with a low hedge of flowers."""
    trough = _part((1.6, 0.5, 0.5), (0.0, 0.0, 0.25), _STONE)
    green = _part((1.48, 0.4, 0.22), (0.0, 0.0, 0.61), _LEAVES)
    bloom = material("plain", _FLOWERS[which])
    rng = np.random.Generator(np.random.PCG64(104729 + which))
    heads = [
        _moved(sphere(0, bloom), (*(rng.uniform(-1.0, 1.0, 2) * (0.7, 0.17)), 0.75), 0.06)
        for _ in range(14)
    ]
    return concatenate([trough, green, *heads]), concatenate([trough, green, *heads[:4]])


def _rubbish() -> Levels:
    """Return tied bags and a carton that wait to be fetched."""
    lying = ((-0.45, 0.05, 0.26, 0), (0.02, 0.12, 0.3, 1), (0.42, -0.02, 0.24, 0))
    bags = [_moved(sphere(1, _BAGS[k]), (x, y, 0.72 * r), r) for x, y, r, k in lying]
    carton = _part((0.45, 0.34, 0.3), (-0.05, -0.42, 0.15), _CARD)
    rough = [_moved(sphere(0, _BAGS[k]), (x, y, 0.72 * r), r) for x, y, r, k in lying]
    return concatenate([*bags, carton]), concatenate([*rough, carton])


def _wheeled_bins(which: int) -> Levels:
    """Return two bins with lids, one in another colour."""
    made, far = [], []
    for k, x in enumerate((-0.36, 0.36)):
        cover = _LIDDED[(which + k) % len(_LIDDED)]
        body = _part((0.54, 0.62, 0.86), (x, 0.0, 0.5), cover)
        lid = _part((0.58, 0.72, 0.09), (x, -0.02, 0.98), _LIDDED[(which + 2 * k) % len(_LIDDED)])
        handle = _part((0.5, 0.05, 0.05), (x, -0.42, 0.93), _IRON)
        made += [body, lid, handle]
        far += [body, lid]
    return concatenate(made), concatenate(far)


def _board() -> Levels:
    """Return an advertising board that folds, before a shop."""
    face = material("plain", (0.12, 0.13, 0.12))
    sides = np.array(
        [[[-0.3, y, 0.0], [0.3, y, 0.0], [0.3, 0.0, 1.0], [-0.3, 0.0, 1.0]] for y in (-0.28, 0.28)]
    )
    sides[1] = sides[1][::-1]
    edge = [_part((0.04, 0.04, 1.0), (x, 0.0, 0.5), _WOOD) for x in (-0.32, 0.32)]
    return (concatenate([quads(sides, np.zeros((2, 4, 2)), face), *edge]),)


def _chair(x: float, y: float, turn: float) -> Mesh:
    seat = _part((0.42, 0.42, 0.04), (0.0, 0.0, 0.45), _WOOD)
    back = _part((0.42, 0.04, 0.38), (0.0, -0.2, 0.68), _WOOD)
    legs = [_part((0.03, 0.38, 0.43), (side, 0.0, 0.215), _IRON) for side in (-0.18, 0.18)]
    cosine, sine = exact.cos(turn), exact.sin(turn)
    pose = np.array([[cosine, -sine, 0.0, x], [sine, cosine, 0.0, y], [0.0, 0.0, 1.0, 0.0]])
    return transformed(concatenate([seat, back, *legs]), pose)


def _parasol(which: int, sides: int) -> Mesh:
    cloth = Material(texture="cloth", tint=_PARASOLS[which])
    top = cylinder((1.35, 0.04), (2.25, 2.75), sides, cloth)
    below = cylinder((1.33, 0.04), (2.23, 2.73), sides, cloth)
    under = Mesh(
        positions=below.positions,
        normals=-below.normals,
        uvs=below.uvs,
        triangles=np.ascontiguousarray(below.triangles[:, ::-1]),
        materials=below.materials,
        palette=below.palette,
    )
    return concatenate([top, under, _part((0.05, 0.05, 2.3), (0.0, 0.0, 1.15), _WOOD)])


def _cafe(which: int) -> Levels:
    """Return a table with chairs under a parasol."""
    table = cylinder((0.38, 0.38), (0.70, 0.74), 12, _WHITE, cap=True)
    foot = _part((0.07, 0.5, 0.04), (0.0, 0.0, 0.04), _IRON)
    turns = (0.4, 2.3, 4.1)[: 2 + which % 2]
    chairs = [_chair(0.72 * exact.sin(t), -0.72 * exact.cos(t), t) for t in turns]
    far = _part((0.9, 0.9, 0.5), (0.0, 0.0, 0.45), _WOOD)
    return concatenate([_parasol(which, 8), table, foot, *chairs]), concatenate(
        [_parasol(which, 6), far]
    )


def _crates() -> Levels:
    """Return a greengrocer's crates on a trestle before his shop."""
    fruit = ((0.85, 0.45, 0.10), (0.70, 0.12, 0.10), (0.42, 0.62, 0.15), (0.92, 0.80, 0.25))
    made = [_part((2.3, 0.75, 0.5), (0.0, 0.0, 0.25), _WOOD)]
    for k, tint in enumerate(fruit):
        x = -0.84 + 0.56 * k
        made.append(_part((0.5, 0.62, 0.16), (x, 0.0, 0.6), _CARD))
        made.append(_part((0.42, 0.54, 0.06), (x, 0.0, 0.72), material("plain", tint)))
    return (concatenate(made),)


def _rack() -> Levels:
    """Return a rack with three bicycles, which stand across it."""
    near, far = list[Mesh](), list[Mesh]()
    for k, (x, turn) in enumerate(((-0.75, 0.05), (0.0, -0.08), (0.62, 0.1))):
        angle = 0.5 * np.pi * (1.0 if k != 1 else -1.0) + turn
        cosine, sine = exact.cos(angle), exact.sin(angle)
        pose = np.array([[cosine, -sine, 0.0, x], [sine, cosine, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
        for own, level in zip((near, far), bicycle_levels(k), strict=True):
            own.append(transformed(level, pose))
    hoops = [_part((0.05, 0.7, 0.05), (x, 0.0, 0.8), _STEEL) for x in (-1.1, -0.38, 0.32, 1.0)]
    posts = [
        _part((0.05, 0.05, 0.77), (x, y, 0.385), _STEEL)
        for x in (-1.1, -0.38, 0.32, 1.0)
        for y in (-0.32, 0.32)
    ]
    return concatenate([*near, *hoops, *posts]), concatenate([*far, *hoops])


def _trampoline() -> Levels:
    mat = cylinder((1.7, 1.7), (0.6, 0.7), 14, material("plain", (0.08, 0.08, 0.09)), cap=True)
    rim = cylinder((1.95, 1.95), (0.62, 0.68), 14, material("plain", (0.15, 0.35, 0.62)), cap=True)
    legs = [
        _part((0.06, 0.06, 0.62), (x, y, 0.31), _STEEL) for x in (-1.3, 1.3) for y in (-1.3, 1.3)
    ]
    return concatenate([rim, mat, *legs]), concatenate([rim, mat])


def _washing() -> Levels:
    """Return a line with washing between two poles."""
    poles = [_part((0.07, 0.07, 2.0), (x, 0.0, 1.0), _STEEL) for x in (-3.0, 3.0)]
    line = _part((6.0, 0.02, 0.02), (0.0, 0.0, 1.95), _WHITE)
    tints = (*_PAPER[:3], (0.25, 0.33, 0.52), *_PAPER[1:2], (0.55, 0.62, 0.70))
    cloths = [
        _part((0.7, 0.03, 0.9 - 0.12 * (k % 3)), (-2.3 + 0.92 * k, 0.0, 1.48 + 0.06 * (k % 3)),
              material("plain", tint))
        for k, tint in enumerate(tints)
    ]  # fmt: skip
    return concatenate([*poles, line, *cloths]), concatenate(cloths)


def _pool() -> Levels:
    water = Material("water", (0.35, 0.70, 0.82), Surface.WATER)
    wall = cylinder((1.5, 1.5), (0.0, 0.55), 14, material("plain", (0.25, 0.48, 0.70)))
    brim = cylinder((1.48, 1.48), (0.40, 0.46), 14, water, cap=True)
    return (concatenate([wall, brim]),)


def _logs() -> Levels:
    return (
        concatenate(
            [_part((2.2, 0.6, 0.9), (0.0, 0.0, 0.45), material("bark", (0.62, 0.46, 0.34))),
             _part((2.4, 0.8, 0.06), (0.0, 0.0, 1.0), _CABINET)]
        ),
    )  # fmt: skip


def _letter_box() -> Levels:
    post = _part((0.08, 0.08, 1.0), (0.0, 0.0, 0.5), _WOOD)
    return (concatenate([post, _part((0.26, 0.42, 0.26), (0.0, 0.05, 1.13), _STEEL)]),)


# order: bytes of plans depend on it, whose library lists these names in turn
CLUTTER: dict[str, Callable[[], Levels]] = {
    **{f"litter {k}": partial(_scraps, k, _PAPER, (0.06, 0.24), 9) for k in range(3)},
    **{f"fallen leaves {k}": partial(_scraps, 3 + k, _FALLEN, (0.07, 0.2), 24) for k in range(2)},
    "drain": _drain,
    **{f"road sign {k}": partial(_sign, k) for k in range(2)},
    "bus stop": partial(_sign, 2),
    "cabinet": _cabinet,
    **{f"planter {k}": partial(_planter, k) for k in range(len(_FLOWERS))},
    "rubbish": _rubbish,
    **{f"wheeled bins {k}": partial(_wheeled_bins, k) for k in range(2)},
    "shop board": _board,
    **{f"cafe table {k}": partial(_cafe, k) for k in range(len(_PARASOLS))},
    "crates": _crates,
    "bicycle rack": _rack,
    "trampoline": _trampoline,
    "washing line": _washing,
    "garden pool": _pool,
    "logs": _logs,
    "letter box": _letter_box,
}
"""Maker of each kind."""
