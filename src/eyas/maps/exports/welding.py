"""Meshes for files of other programs: each point once, and no triangles without area."""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Mesh

__all__ = ["Indexed", "Welded", "distinct", "welded"]

_LEAST = 1e-8  # Area below which a triangle is left out [m^2]: a tenth of a millimetre squared

Floats = NDArray[np.float64]
Number = TypeVar("Number", bound=np.floating)


class Indexed(NamedTuple):
    """Vectors at the corners of triangles."""

    values: NDArray[np.floating]  # The different ones, shape (K, parts)
    corners: NDArray[np.int64]  # Index of that of each corner, shape (T, 3)


class Welded(NamedTuple):
    """T triangles whose corners share points, normals and texture coordinates."""

    points: Indexed  # [m]
    normals: Indexed
    uvs: Indexed
    materials: NDArray[np.int32]  # Index into the mesh's palette, shape (T,)
    across: Floats  # Unit vectors on the faces, shape (T, 3)


def welded(mesh: Mesh, step: float = 0.0) -> Welded:
    """Return a mesh with every point once, without triangles that have no area.

    Args:
        mesh: The mesh.
        step: Numbers are rounded to whole multiples of this; 0: they stay as they are.
    """
    points, where = distinct(_rounded(mesh.positions, step))
    faces = where[mesh.triangles]
    corners = points.astype(np.float64)[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice = np.sqrt(np.square(across).sum(axis=1))
    kept = twice > 2.0 * _LEAST
    triangles, faces = mesh.triangles[kept], faces[kept]
    return Welded(
        _used(points, faces),
        _told(mesh.normals, triangles, step),
        _told(mesh.uvs, triangles, step),
        mesh.materials[kept],
        across[kept] / twice[kept, None],
    )


def _told(values: NDArray[np.floating], triangles: NDArray[np.int32], step: float) -> Indexed:
    found, where = distinct(_rounded(values, step))
    return _used(found, where[triangles])


def _used(values: NDArray[np.floating], corners: NDArray[np.int64]) -> Indexed:
    """Return those values alone that a corner has."""
    used, where = np.unique(corners, return_inverse=True)
    return Indexed(values[used], where.reshape(-1, 3))


def _rounded(values: NDArray[np.floating], step: float) -> NDArray[np.floating]:
    whole = values if step == 0.0 else np.rint(values.astype(np.float64) / step) * step
    return whole + 0.0  # never -0, which is another number to a reader of bytes


def distinct(rows: NDArray[Number]) -> tuple[NDArray[Number], NDArray[np.int64]]:
    """Return the different rows in order, and which of them each row is.

    Several times as fast as `np.unique` of rows, which compares them byte by byte.
    """
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    new = np.ones(len(rows), np.bool_)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    where = np.zeros(len(rows), np.int64)
    where[order] = np.cumsum(new) - 1
    return ordered[new], where
