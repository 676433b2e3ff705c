"""Shrubs, hedges and planted islands as fixtures. Origins on the ground, lengths in metres."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels
from eyas.lanes import exact
from eyas.maps.plants.foliage import Crown, leaf_cards, shell

PIECE = 4.0  # Length of a piece of a hedge or of a border of shrubs, along x [m]

Array = NDArray[np.float64]
Tints = tuple[tuple[float, float, float], ...]

_OLIVE: Tints = ((0.62, 0.68, 0.50), (0.82, 0.88, 0.62), (1.0, 1.0, 0.76))
_DARK: Tints = ((0.50, 0.60, 0.50), (0.66, 0.78, 0.62), (0.84, 0.96, 0.76))
_BRIGHT: Tints = ((0.72, 0.76, 0.44), (0.92, 0.96, 0.54), (1.0, 1.0, 0.66))
_CORE = (0.51, 0.6, 0.43)
_KERB = material("stone", (0.95, 0.92, 0.9))
_MULCH = material("soil", (0.62, 0.56, 0.52))

_LOW, _TALL, _MIDDLE = (1.0, 0.5, _BRIGHT), (0.6, 0.95, _DARK), (0.75, 0.62, _OLIVE)


def _border(shrubs: Sequence[tuple[float, float, Tints]], rng: np.random.Generator) -> Levels:
    """Return a row of shrubs; each is given by half its width, its height and its greens."""
    made = []
    for x, (wide, tall, tints) in zip((-1.35, 0.0, 1.3), shrubs, strict=True):
        centres, radii = _clump(wide * rng.uniform(0.8, 1.1), tall * rng.uniform(0.8, 1.15), rng)
        centres[:, :2] += (x + rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2))
        made.append(_bush(centres, radii, tints, rng))
    fine, middle, coarse = (concatenate(level) for level in zip(*made, strict=True))
    return fine, middle, coarse


def _hedge(rng: np.random.Generator) -> Levels:
    """Return a clipped hedge: a box with an uneven surface of leaves."""
    row = np.linspace(-PIECE / 2 + 0.2, PIECE / 2 - 0.2, 11)
    centres = np.array([(x, y, z) for x in row for y, z in ((-0.1, 0.36), (0.1, 0.62))])
    crown = Crown(centres, np.full(len(centres), 0.34), np.array([0.0, 0.0, 0.1]))
    core = Material("foliage", _DARK[1], Surface.CROWN)
    cut = box((PIECE, 0.74, 0.9), (0.0, 0.0, 0.43), core, 3.0)
    inner = box((PIECE, 0.6, 0.8), (0.0, 0.0, 0.4), Material("foliage", _CORE, Surface.CROWN), 3.0)
    return (
        concatenate([inner, leaf_cards(crown, 330, (0.24, 0.38), _DARK, rng, bent=False)]),
        concatenate([inner, leaf_cards(crown, 190, (0.32, 0.46), _DARK, rng, bent=False)]),
        cut,
    )


def _clump(wide: float, tall: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return balls that overlap in a heap of a half width and a height of twice `tall`."""
    angle = np.arange(4) * np.pi / 2 + rng.uniform(-0.4, 0.4, 4)
    reach = wide * rng.uniform(0.4, 0.6, 4)
    low = np.stack(
        [reach * exact.cos(angle), reach * exact.sin(angle), tall * rng.uniform(0.5, 0.9, 4)], 1
    )
    radii = np.append(wide * rng.uniform(0.42, 0.56, 4), 0.6 * wide)
    return np.concatenate([low, [[0.0, 0.0, 1.1 * tall]]]), radii


def _bush(centres: Array, radii: Array, tints: Tints, rng: np.random.Generator) -> Levels:
    middle = np.array([*centres[:, :2].mean(axis=0), 0.2])
    crown = Crown(centres, radii, middle)
    near = leaf_cards(crown, 62, (0.34, 0.54), tints, rng, bent=True)
    far = leaf_cards(crown, 22, (0.5, 0.74), tints, rng, bent=False)
    return (
        concatenate([shell(crown, 1, 0.9, _CORE), near]),
        concatenate([shell(crown, 1, 0.95, _CORE), far]),
        shell(crown, 0, 1.04, tints[1]),
    )


def _island(rng: np.random.Generator) -> Levels:
    """Return a bed with a kerb and low plants, of the size of a bay of a car park."""
    kerb = box((5.0, 2.3, 0.2), (0.0, 0.0, 0.05), _KERB, 4.0)
    bed = box((4.7, 2.0, 0.05), (0.0, 0.0, 0.16), _MULCH, 8.0)
    centres = np.array([(x, rng.uniform(-0.4, 0.4), 0.25) for x in (-1.8, -1.2, 1.1, 1.8)])
    crown = Crown(centres, rng.uniform(0.32, 0.45, 4), np.array([0.0, 0.0, 0.0]))
    cards = leaf_cards(crown, 70, (0.25, 0.4), _OLIVE, rng, bent=False)
    return concatenate([kerb, bed, cards]), concatenate([kerb, bed])


PLANTS: dict[str, Callable[[np.random.Generator], Levels]] = {
    "border": lambda rng: _border((_MIDDLE, _TALL, _MIDDLE), rng),
    "low border": lambda rng: _border((_LOW, _LOW, _MIDDLE), rng),
    "tall border": lambda rng: _border((_TALL, _LOW, _TALL), rng),
    "hedge": _hedge,
    "island": _island,
}
"""Makers of borders of shrubs along walls, hedges, beds in car parks."""

DECIDUOUS = ("border", "low border", "tall border")  # Shrubs whose leaves turn in autumn
