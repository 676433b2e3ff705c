"""Shrubs, hedges and planted islands as fixtures. Origins on the ground, lengths in metres."""

import numpy as np
from numpy.typing import NDArray

from eyas.state.mesh import Mesh, concatenate
from eyas.world.foliage import Crown, leaf_cards, shell
from eyas.world.materials import material
from eyas.world.shapes import box

__all__ = ["HEDGE_LENGTH", "KINDS", "plant_levels"]

KINDS = ("round", "wide", "tall", "hedge", "island")
"""The prototypes, in the order of `plant_levels`."""

HEDGE_LENGTH = 2.0
"""Of one piece of a hedge, which runs along x [m]."""

Array = NDArray[np.float64]
Tints = tuple[tuple[float, float, float], ...]

_OLIVE: Tints = ((0.46, 0.52, 0.36), (0.66, 0.72, 0.50), (0.90, 0.94, 0.66))
_DARK: Tints = ((0.34, 0.44, 0.36), (0.48, 0.60, 0.48), (0.66, 0.80, 0.60))
_BRIGHT: Tints = ((0.54, 0.60, 0.30), (0.76, 0.82, 0.42), (1.0, 1.0, 0.58))
_CORE = (0.42, 0.5, 0.36)
_KERB = material("stone", (0.95, 0.92, 0.9))
_MULCH = material("soil", (0.62, 0.56, 0.52))


def plant_levels(rng: np.random.Generator) -> list[tuple[Mesh, ...]]:
    """Return each kind, the finest level of detail first."""
    row = np.linspace(-0.8, 0.8, 5)
    hedge = np.array([(x, y, z) for x in row for y, z in ((-0.12, 0.38), (0.12, 0.62))])
    return [
        _bush(*_clump(0.75, 0.62, rng), _OLIVE, rng),
        _bush(*_clump(1.1, 0.55, rng), _BRIGHT, rng),
        _bush(*_clump(0.6, 1.0, rng), _DARK, rng),
        _bush(hedge, np.full(len(hedge), 0.36), _DARK, rng),
        _island(rng),
    ]


def _clump(wide: float, tall: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return balls that overlap in a heap of a half width and a height of twice `tall`."""
    angle = np.arange(4) * np.pi / 2 + rng.uniform(-0.4, 0.4, 4)
    reach = wide * rng.uniform(0.4, 0.6, 4)
    low = np.stack(
        [reach * np.cos(angle), reach * np.sin(angle), tall * rng.uniform(0.5, 0.9, 4)], 1
    )
    radii = np.append(wide * rng.uniform(0.42, 0.56, 4), 0.6 * wide)
    return np.concatenate([low, [[0.0, 0.0, 1.1 * tall]]]), radii


def _bush(centres: Array, radii: Array, tints: Tints, rng: np.random.Generator) -> tuple[Mesh, ...]:
    crown = Crown(centres, radii, np.array([0.0, 0.0, 0.2]))
    return (
        concatenate(
            [shell(crown, 1, 0.9, _CORE), leaf_cards(crown, 84, (0.3, 0.5), tints, rng, bent=True)]
        ),
        concatenate(
            [
                shell(crown, 1, 0.95, _CORE),
                leaf_cards(crown, 26, (0.5, 0.7), tints, rng, bent=False),
            ]
        ),
        shell(crown, 0, 1.04, tints[1]),
    )


def _island(rng: np.random.Generator) -> tuple[Mesh, ...]:
    """Return a bed with a kerb, as long and wide as a bay of a car park, with low plants."""
    kerb = box((5.0, 2.3, 0.2), (0.0, 0.0, 0.05), _KERB, 4.0)
    bed = box((4.7, 2.0, 0.05), (0.0, 0.0, 0.16), _MULCH, 8.0)
    centres = np.array([(x, rng.uniform(-0.4, 0.4), 0.25) for x in (-1.8, -1.2, 1.1, 1.8)])
    crown = Crown(centres, rng.uniform(0.32, 0.45, 4), np.array([0.0, 0.0, 0.0]))
    cards = leaf_cards(crown, 70, (0.25, 0.4), _OLIVE, rng, bent=False)
    return concatenate([kerb, bed, cards]), concatenate([kerb, bed])
