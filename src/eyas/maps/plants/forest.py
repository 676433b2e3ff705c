"""Small woods planted densely, tree by tree: stands of twenty trees that are copied.

A stand is one fixture, so that a thousand trees cost as much as fifty.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels
from eyas.engine.world.weather import Season
from eyas.lanes import exact
from eyas.maps.plants.foliage import Crown, leaf_cards, shell

STAND = 10.0  # Side of the square of a stand [m]
TREES = 20  # Trees in a stand: one on five square metres

_COLUMNS, _ROWS = 5, 4
_SHAPES = 5  # Different trees in a stand; the others are copies of another size and turn

Tint = tuple[float, float, float]
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Species:
    """A kind of tree."""

    name: str
    shape: str  # `round`, `cone` or `palm`
    heights: tuple[float, float]  # Least and largest height [m]
    width: float  # Width of the crown, as a share of the height
    leaves: Tint  # Colour of the sunlit leaves, sRGB
    bark: Tint = (0.80, 0.76, 0.70)
    autumn: Tint | None = None  # Tint in autumn; None: evergreen

    def look(self, season: Season) -> Tint:
        """Return the colour of its leaves in a season."""
        if season is Season.WINTER:
            return FROSTED
        return (self.autumn or self.leaves) if season is Season.AUTUMN else self.leaves


# order: bytes of plans depend on it, whose strips hold an index of it
SPECIES = (
    Species("crab apple", "round", (3.0, 6.5), 0.72, (0.86, 0.62, 0.68), autumn=(0.74, 0.34, 0.20)),
    Species("hackberry", "round", (4.0, 9.0), 0.58, (0.74, 0.92, 0.32), autumn=(0.94, 0.78, 0.26)),
    Species("oak", "round", (4.5, 10.0), 0.62, (0.36, 0.50, 0.22), autumn=(0.58, 0.38, 0.18)),
    Species("cherry", "round", (3.0, 7.0), 0.64, (0.98, 0.86, 0.90), autumn=(0.82, 0.40, 0.20)),
    Species(
        "birch", "round", (5.0, 10.0), 0.42, (0.62, 0.78, 0.40), (1.0, 1.0, 1.0), (0.96, 0.82, 0.34)
    ),
    Species("palm", "palm", (4.5, 9.0), 0.52, (0.52, 0.72, 0.30), (0.78, 0.68, 0.54)),
    Species("spruce", "cone", (4.0, 10.0), 0.40, (0.26, 0.42, 0.32), (0.66, 0.58, 0.50)),
)
"""The kinds of the original's strips of forest, from the west."""

FROSTED: Tint = (0.84, 0.82, 0.90)  # Colour of leaves under frost


def stand_levels(kinds: Sequence[Species], rng: np.random.Generator, season: Season) -> Levels:
    """Return a stand about the origin, the finest level of detail first; lengths in metres.

    The levels have about 3,400, 1,200, 400 and 32 triangles.

    Args:
        kinds: Kinds of its trees.
        season: Of their leaves; frost covers them in winter.
    """
    if len(kinds) == 1 and kinds[0].shape == "round":  # a wood of one kind has others in it
        kinds = (kinds[0], SPECIES[2], kinds[0], SPECIES[1], kinds[0])
    shapes = [_unit_levels(kinds[k % len(kinds)], rng, season) for k in range(_SHAPES)]
    levels: list[list[Mesh]] = [[], [], []]
    tops = np.zeros((_COLUMNS, _ROWS))
    for index in range(TREES):
        column, row = index % _COLUMNS, index // _COLUMNS
        which = int(rng.integers(_SHAPES))
        height = float(rng.uniform(*kinds[which % len(kinds)].heights))
        spacing = np.array([STAND / _COLUMNS, STAND / _ROWS])
        place = (np.array([column, row]) + rng.uniform(0.2, 0.8, 2)) * spacing - STAND / 2
        pose = _pose(place, float(rng.uniform(0, 2 * np.pi)), height)
        for level, mesh in zip(levels, shapes[which], strict=True):
            level.append(transformed(mesh, pose))
        tops[column, row] = height
    main = kinds[int(rng.integers(len(kinds)))]
    cover = _leafy("pale_foliage", main, season, 0.76)
    return (*(concatenate(level) for level in levels), _canopy(tops, cover, rng))


def _pose(place: Array, turn: float, size: float) -> Array:
    cosine, sine = size * exact.cos(turn), size * exact.sin(turn)
    return np.array(
        [[cosine, -sine, 0.0, place[0]], [sine, cosine, 0.0, place[1]], [0.0, 0.0, size, 0.0]]
    )


def _leafy(texture: str, kind: Species, season: Season, light: float) -> Material:
    red, green, blue = kind.look(season)
    surface = Surface.FOLIAGE if texture == "pale_leaves" else Surface.CROWN
    return Material(texture, (light * red, light * green, light * blue), surface)


def _unit_levels(
    kind: Species, rng: np.random.Generator, season: Season
) -> tuple[Mesh, Mesh, Mesh]:
    """Return a tree of height 1: with many cards, with few, and as a closed shape."""
    crown = _CROWNS[kind.shape](kind.width / 2, rng)
    dark, closed = (_leafy("pale_foliage", kind, season, light) for light in (0.66, 0.78))
    age = rng.uniform(0.72, 1.0)  # no two trees are of one green
    tints = tuple(_leafy("pale_leaves", kind, season, age * k).tint for k in (0.7, 0.88, 1.0))
    trunk = _trunk(kind)
    wide = kind.width
    fine = leaf_cards(crown, 42, (0.3 * wide, 0.5 * wide), tints, rng, bent=False)
    rough = leaf_cards(crown, 16, (0.45 * wide, 0.65 * wide), tints, rng, bent=False)
    return (
        concatenate([trunk, _shell(crown, 1, 0.86, dark), _pale(fine)]),
        concatenate([trunk, _shell(crown, 0, 0.95, dark), _pale(rough)]),
        _shell(crown, 0, 1.15, closed),
    )


def _shell(crown: Crown, subdivisions: int, size: float, cover: Material) -> Mesh:
    mesh = shell(crown, subdivisions, size, cover.tint, 1.0)
    mesh.palette = (cover,)
    return mesh


def _pale(cards: Mesh) -> Mesh:
    """Return leaf cards with pale leaves instead of green ones."""
    cards.palette = tuple(
        Material("pale_leaves", one.tint, Surface.FOLIAGE) for one in cards.palette
    )
    return cards


def _trunk(kind: Species) -> Mesh:
    top = 0.9 if kind.shape == "palm" else 0.5
    line = np.array([[0.0, 0.0, -0.02], [0.0, 0.0, top]])
    return tube(line, [0.02, 0.012], 3, material("bark", kind.bark), 0.1)


def _round(half: float, rng: np.random.Generator) -> Crown:
    angle = np.arange(4) * np.pi / 2 + rng.uniform(0, np.pi / 2)
    ring = np.column_stack([exact.cos(angle), exact.sin(angle), np.zeros(4)]) * 0.45 * half
    ring[:, 2] = rng.uniform(0.3, 0.64, 4)
    centres = np.concatenate([ring, [[0.0, 0.0, 0.76]]])
    radii = np.append(0.58 * half * rng.uniform(0.85, 1.1, 4), min(0.55 * half, 0.2))
    return Crown(centres, radii, np.array([0.0, 0.0, 0.55]))


def _cone(half: float, rng: np.random.Generator) -> Crown:
    z = np.array([0.2, 0.4, 0.6, 0.78, 0.92])
    centres = np.column_stack([rng.uniform(-0.02, 0.02, (5, 2)), z])
    return Crown(centres, half * np.array([0.9, 0.72, 0.52, 0.34, 0.2]), np.array([0.0, 0.0, 0.35]))


def _palm(half: float, rng: np.random.Generator) -> Crown:
    angle = np.arange(7) * 2 * np.pi / 7 + rng.uniform(-0.2, 0.2, 7)
    ring = np.column_stack([exact.cos(angle), exact.sin(angle), np.zeros(7)]) * 0.62 * half
    ring[:, 2] = rng.uniform(0.84, 0.9, 7)
    centres = np.concatenate([ring, [[0.0, 0.0, 0.9]]])
    return Crown(centres, np.append(np.full(7, 0.3 * half), 0.3 * half), np.array([0.0, 0.0, 0.7]))


_CROWNS = {"round": _round, "cone": _cone, "palm": _palm}


def _canopy(tops: Array, cover: Material, rng: np.random.Generator) -> Mesh:
    """Return the outside of a stand seen from afar: a bumpy cushion."""
    steps = np.linspace(-0.5, 0.5, 5) * (STAND + 1.0)
    x, y = np.meshgrid(steps, steps, indexing="ij")
    z = tops.mean() * rng.uniform(0.75, 1.05, x.shape)
    z[[0, -1]] *= 0.8
    z[:, [0, -1]] *= 0.8
    points = np.stack([x, y, z], axis=2)
    corners = np.stack([points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]], axis=2)
    flat = corners.reshape(-1, 4, 3)
    return quads(flat, flat[..., :2] / 3.0, cover)
