"""Triangles and what they are made of."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

__all__ = ["Material", "Mesh", "Surface", "concatenate", "transformed"]


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


def concatenate(meshes: Sequence[Mesh]) -> Mesh:
    """Return one mesh of all, with one palette without repeats."""
    palette: dict[Material, int] = {}
    triangles, materials, offset = [], [], 0
    for mesh in meshes:
        lookup = np.array([palette.setdefault(m, len(palette)) for m in mesh.palette], np.int32)
        triangles.append(mesh.triangles + np.int32(offset))
        materials.append(lookup[mesh.materials])
        offset += len(mesh.positions)
    return Mesh(
        positions=_joined([m.positions for m in meshes], (0, 3), np.float32),
        normals=_joined([m.normals for m in meshes], (0, 3), np.float32),
        uvs=_joined([m.uvs for m in meshes], (0, 2), np.float32),
        triangles=_joined(triangles, (0, 3), np.int32),
        materials=_joined(materials, (0,), np.int32),
        palette=tuple(palette),
    )


def transformed(mesh: Mesh, pose: NDArray[np.floating]) -> Mesh:
    """Return the mesh moved by a pose.

    Args:
        mesh: What to move.
        pose: Rotation (times a uniform scale) and translation, shape (3, 4).
    """
    linear = np.asarray(pose[:, :3], np.float64)
    positions = mesh.positions @ linear.T + pose[:, 3]
    normals = mesh.normals @ (linear / np.cbrt(np.linalg.det(linear))).T
    return Mesh(
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        uvs=mesh.uvs,
        triangles=mesh.triangles,
        materials=mesh.materials,
        palette=mesh.palette,
    )


def _joined(parts: list, empty: tuple[int, ...], dtype: type) -> NDArray:  # type: ignore[type-arg]
    return np.ascontiguousarray(np.concatenate([np.zeros(empty, dtype), *parts]), dtype=dtype)
