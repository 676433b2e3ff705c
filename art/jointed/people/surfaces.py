"""Closed surfaces through level outlines, wrapped in a region of a texture."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from art.cars.regions import Region
from eyas.engine.mesh.panels import cells, fan
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Material
from eyas.lanes import exact

_CREASE = 1.35  # Bodies of five sides are round, boxes are not [rad]

_FEW = 6  # With fewer sides, every second outline is left out

Row = tuple[float, float, float, float]
"""z of an outline, how far it reaches ahead and back of the axis, and half its width [m]."""


def loop(
    row: Row,  # Its measures
    sides: int,  # Number of corners, even
    *,
    box: float = 0.0,  # 0 for half ellipses, 1 for almost rectangles
) -> NDArray[np.float64]:
    """Return an outline from the middle of the back over the right side, shape (sides, 3)."""
    z, ahead, back, half = row
    c, s = _unit(sides, box)
    x = np.where(c > 0.0, ahead, back) * c
    return np.column_stack([x, half * s, np.full(sides, z)])


@cache
def _unit(sides: int, box: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y of the outline of measures 1, which thousands of outlines share."""
    angle = np.arange(sides) * (2 * np.pi / sides) - np.pi
    c, s = exact.cos(angle), exact.sin(angle)
    power = 1.0 - 0.7 * box
    c = np.sign(c) * exact.power(np.maximum(np.abs(c), 1e-9), power)
    s = np.sign(s) * exact.power(np.maximum(np.abs(s), 1e-9), power)
    return c, s


def wrapped(
    shell: Shell,  # Shell to add it to
    rows: Sequence[Row],  # The outlines
    ups: Sequence[float],  # Where each is in the region, 0 below, 1 above
    region: Region,  # Of the texture of the material
    material: Material,  # Of all faces
    *,
    sides: int,  # See `loop`
    box: float = 0.0,  # See `loop`
    flip: bool = False,  # Whether the texture runs over the left side first
    caps: bool = True,  # Whether both ends are closed
) -> None:
    """Add the surface through outlines from the bottom up."""
    if sides < _FEW:  # from afar
        rows, ups = (*rows[:-1:2], rows[-1]), (*ups[:-1:2], ups[-1])
    shell.crease = _CREASE
    rings = np.stack([loop(row, sides, box=box) for row in rows])
    across = np.linspace(0.0, 1.0, sides + 1)
    uv = region.at((1.0 - across if flip else across)[None], np.asarray(ups)[:, None])
    shell.quads(cells(np.concatenate([rings, rings[:, :1]], axis=1)), material, uvs=cells(uv))
    if caps:
        for ring, edge in ((rings[0, ::-1], uv[0, 0]), (rings[-1], uv[-1, 0])):
            triangles = fan(ring)
            shell.triangles(triangles, material, uvs=np.tile(edge, (len(triangles), 3, 1)))
