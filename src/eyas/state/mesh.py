"""Triangles and what they are made of."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

__all__ = ["Material", "Mesh", "Surface"]


class Surface(IntEnum):
    """How light meets a material."""

    MATT = 0
    """Plain diffuse."""
    PAINT = 1
    """Car paint: tint times the colour of the instance, with a gloss."""
    GLASS = 2
    """Reflects the sky."""
    FOLIAGE = 3
    """Leaves: holes where the texture's alpha is low, lit from both sides."""
    FACADE = 4
    """A wall with windows: where the texture's alpha is low there is glass."""
    WATER = 5
    """Reflects the sky, with small waves."""
    LAMP = 6
    """Emits its own light by `emission` when the weather has lamps on."""
    CROWN = 7
    """What is behind leaves: matt. It throws no shadow of its own; the leaves in front do."""


@dataclass(frozen=True, slots=True)
class Material:
    """What a triangle is made of."""

    texture: str = "plain"
    """Name of a texture of `eyas.world.build.materials.TEXTURES`; `plain` is white."""
    tint: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Factor on the texture, sRGB, each 0 to 1."""
    surface: Surface = Surface.MATT
    """How light meets it."""
    emission: float = 0.0
    """Own light, as a factor on the colour."""


@dataclass(slots=True)
class Mesh:
    """Triangles, counter-clockwise seen from outside. V vertices, T triangles."""

    positions: NDArray[np.float32]
    """Vertices [m], shape (V, 3)."""
    normals: NDArray[np.float32]
    """Unit normals, shape (V, 3)."""
    uvs: NDArray[np.float32]
    """Texture coordinates in tiles (1 = one repeat), shape (V, 2); v grows upwards on walls."""
    triangles: NDArray[np.int32]
    """Vertex indices, shape (T, 3)."""
    materials: NDArray[np.int32]
    """Index into `palette` for each triangle, shape (T,)."""
    palette: tuple[Material, ...]
    """The materials used."""

    @classmethod
    def none(cls) -> "Mesh":
        """Return a mesh without triangles."""
        return cls(
            positions=np.zeros((0, 3), np.float32),
            normals=np.zeros((0, 3), np.float32),
            uvs=np.zeros((0, 2), np.float32),
            triangles=np.zeros((0, 3), np.int32),
            materials=np.zeros(0, np.int32),
            palette=(),
        )
