"""Meshes made from arrays and from other meshes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.lanes import exact


def of_one_material(
    positions: NDArray[np.floating],
    normals: NDArray[np.floating],
    uvs: NDArray[np.floating],
    triangles: NDArray[np.integer],
    material: Material,
) -> Mesh:
    """Return a mesh from arrays, with one material; shapes as in `Mesh`."""
    return Mesh(
        positions=np.ascontiguousarray(positions, np.float32),
        normals=np.ascontiguousarray(normals, np.float32),
        uvs=np.ascontiguousarray(uvs, np.float32),
        triangles=np.ascontiguousarray(triangles, np.int32),
        materials=np.zeros(len(triangles), np.int32),
        palette=(material,),
    )


def concatenate(meshes: Sequence[Mesh]) -> Mesh:
    """Return all meshes as one; its palette has no duplicates."""
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


_OTHER = {
    Surface.INDICATOR_LEFT: Surface.INDICATOR_RIGHT,
    Surface.INDICATOR_RIGHT: Surface.INDICATOR_LEFT,
}


def mirrored(mesh: Mesh) -> Mesh:
    """Return a mesh with y and -y exchanged; its indicators blink on the side where they are."""
    across = np.array([1.0, -1.0, 1.0], np.float32)
    return replace(
        mesh,
        positions=mesh.positions * across,
        normals=mesh.normals * across,
        triangles=np.ascontiguousarray(mesh.triangles[:, ::-1]),
        palette=tuple(
            replace(one, surface=_OTHER.get(one.surface, one.surface)) for one in mesh.palette
        ),
    )


def transformed(
    mesh: Mesh,  # The mesh
    pose: NDArray[np.floating],  # Rotation (times a uniform scale) and translation, shape (3, 4)
) -> Mesh:
    """Return the mesh transformed by a pose."""
    linear = np.asarray(pose[:, :3], np.float64)
    positions = exact.product(mesh.positions, linear.T) + pose[:, 3]
    normals = exact.product(mesh.normals, (linear / exact.cbrt(exact.determinant(linear))).T)
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
