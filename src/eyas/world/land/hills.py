"""Hills: heights of the ground, and its surface."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eyas.core import exact
from eyas.state.mesh import Material, Mesh
from eyas.state.terrain import Terrain
from eyas.world.build.materials import TEXTURES

__all__ = ["Hill", "hilly", "relief_mesh"]


class Hill(NamedTuple):
    """A round hill whose slope is gentle at its foot and its top."""

    x: float
    """East [m]."""
    y: float
    """North [m]."""
    radius: float
    """Radius of its foot [m]."""
    height: float
    """Height above the floor [m]."""


def hilly(
    size: tuple[float, float], floor: float, hills: Sequence[Hill], spacing: float = 5.0
) -> Terrain:
    """Return the ground with hills; where two overlap, the higher one counts.

    Args:
        size: Extent of the floor, centred on the origin [m].
        floor: z of the floor [m].
        hills: The hills.
        spacing: Largest distance between neighbouring points of the raster [m].
    """
    columns, rows = (max(int(np.ceil(side / spacing)), 1) + 1 for side in size)
    spacing = max(size[0] / (columns - 1), size[1] / (rows - 1))
    west, south = -0.5 * size[0], -0.5 * size[1]
    x = west + spacing * np.arange(columns)
    y = south + spacing * np.arange(rows)[:, None]
    relief = np.zeros((rows, columns))
    for hill in hills:
        apart = np.minimum(exact.hypot(x - hill.x, y - hill.y) / hill.radius, 1.0)
        relief = np.maximum(relief, hill.height * (0.5 + 0.5 * exact.cos(np.pi * apart)))
    # Whole millimetres: the last bits of a cosine differ between machines.
    return Terrain(floor, np.round(relief, 3).astype(np.float32), west, south, spacing)


def relief_mesh(terrain: Terrain, material: Material) -> Mesh:
    """Return the smooth-shaded surface of a raster, two triangles for each of its squares.

    Args:
        terrain: The ground; not flat.
        material: Material of the whole surface.
    """
    rows, columns = terrain.relief.shape
    relief, spacing = terrain.relief.astype(np.float64), terrain.spacing
    x, y = np.meshgrid(
        terrain.west + spacing * np.arange(columns), terrain.south + spacing * np.arange(rows)
    )
    north, east = np.gradient(relief, spacing)
    normals = np.stack([-east, -north, np.ones_like(east)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1, 1)
    cells = first + np.array([0, 1, columns + 1, 0, columns + 1, columns])
    count = 2 * len(first)
    return Mesh(
        positions=np.stack([x, y, terrain.floor + relief], axis=-1)
        .reshape(-1, 3)
        .astype(np.float32),
        normals=normals.reshape(-1, 3).astype(np.float32),
        uvs=(np.stack([x, y], axis=-1) / TEXTURES[material.texture])
        .reshape(-1, 2)
        .astype(np.float32),
        triangles=cells.reshape(-1, 3).astype(np.int32),
        materials=np.zeros(count, np.int32),
        palette=(material,),
    )
