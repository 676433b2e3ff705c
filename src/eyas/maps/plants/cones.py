"""Cone-shaped evergreen trees: wide at the foot, pointed, dark green."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.solids import tube
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.world.build.materials import material
from eyas.lanes import exact
from eyas.maps.plants.foliage import Crown, leaf_cards

__all__ = ["VARIANTS", "cone_tree_levels"]

VARIANTS = 3  # Number of shapes

Array = NDArray[np.float64]

_GREENS = (
    ((0.36, 0.47, 0.40), (0.50, 0.64, 0.51), (0.66, 0.83, 0.62), (0.82, 0.98, 0.70)),
    ((0.38, 0.51, 0.35), (0.54, 0.69, 0.46), (0.72, 0.89, 0.55), (0.88, 1.0, 0.64)),
    ((0.33, 0.45, 0.42), (0.45, 0.61, 0.53), (0.58, 0.76, 0.64), (0.76, 0.93, 0.74)),
)
_CORE = (0.34, 0.42, 0.34)
_HALF_WIDTH = (0.46, 0.40, 0.43)
"""Half the width of the crown, as a share of the height: in the original, 0.5."""
_LOW = 0.10  # Height of the lowest branches
_RINGS = 6


def cone_tree_levels(rng: np.random.Generator, variant: int) -> tuple[Mesh, ...]:
    """Return a tree of height 1 that stands on the origin, the finest level of detail first.

    The levels have about 1,700, 480 and 40 triangles.
    """
    kind = variant % VARIANTS
    half, greens = _HALF_WIDTH[kind], _GREENS[kind]
    crown = _crown(half, rng)
    fine = concatenate(
        [
            _trunk(7),
            _cone(half, 12, 0.80, _CORE),
            leaf_cards(crown, 400, (0.11, 0.19), greens, rng, bent=True),
        ]
    )
    middle = concatenate(
        [
            _trunk(5),
            _cone(half, 9, 0.84, _CORE),
            leaf_cards(crown, 190, (0.17, 0.27), greens, rng, bent=False),
        ]
    )
    coarse = concatenate([_trunk(3), _cone(half, 7, 1.0, greens[2])])
    return fine, middle, coarse


def _crown(half: float, rng: np.random.Generator) -> Crown:
    """Return balls in rings that become smaller towards the top."""
    centres, radii = [np.array([[0.0, 0.0, 0.94]])], [np.array([0.045])]
    for ring in range(_RINGS):
        share = ring / (_RINGS - 1)
        reach, height = half * (1.0 - share), _LOW + 0.10 + 0.72 * share
        size = 0.055 + 0.42 * reach
        count = max(1, round(2 * np.pi * max(reach - size, 0.0) / size))
        angle = rng.uniform(0, 2 * np.pi) + np.arange(count) * 2 * np.pi / count
        out = max(reach - size, 0.0) * rng.uniform(0.9, 1.06, count)
        z = height + rng.uniform(-0.025, 0.025, count)
        centres.append(np.column_stack([out * exact.cos(angle), out * exact.sin(angle), z]))
        radii.append(np.full(count, size))
    return Crown(np.concatenate(centres), np.concatenate(radii), np.array([0.0, 0.0, 0.4]))


def _cone(half: float, sides: int, size: float, tint: tuple[float, float, float]) -> Mesh:
    """Return the dark inside of a crown."""
    stuff = Material("foliage", tint, Surface.CROWN)
    path = np.array([[0, 0, _LOW], [0, 0, _LOW + 0.08], [0, 0, 0.5], [0, 0, 0.5 + 0.48 * size]])
    wide = [0.45 * half * size, half * size, 0.55 * half * size, 0.005]
    return tube(path, wide, sides, stuff, 0.5)


def _trunk(sides: int) -> Mesh:
    path = np.array([[0, 0, -0.02], [0, 0, 0.04], [0, 0, 0.3]])
    return tube(path, [0.032, 0.024, 0.02], sides, material("bark"), 0.1)
