"""Level land around a map, up to the horizon."""

import numpy as np

from eyas.mesh.flat import quads
from eyas.state.mesh import Material, Mesh
from eyas.world.build.materials import TEXTURES

__all__ = ["plain"]

_LINES = (1.0, 1.5, 2.2, 3.5, 6.0, 10.0, 16.0)
"""Borders of its squares, as multiples of where it begins."""
_BELOW = 0.05
"""Depth below the floor, so that rounding never makes it show through [m]."""


def plain(half: float, floor: float, cover: Material) -> Mesh:
    """Return the land beyond a square.

    Args:
        half: Half the side of the square [m].
        floor: z of the floor [m].
        cover: Material of the land.
    """
    line = half * np.array([*(-np.array(_LINES[::-1])), -0.4, 0.4, *_LINES])
    x, y = np.meshgrid(line, line, indexing="ij")
    corner = np.stack([x, y, np.full_like(x, floor - _BELOW)], axis=-1)
    cells = np.stack([corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=2)
    middle = np.abs(line[:-1] + line[1:]) / 2 < half
    outside = ~(middle[:, None] & middle[None])
    some = cells[outside]
    return quads(some, some[..., :2] / TEXTURES[cover.texture], cover)
