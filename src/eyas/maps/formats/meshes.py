"""What stands on a map, part by part, as meshes for files of other programs.

Each part has a name and a class, each point once, and no triangle without area.
"""

from collections.abc import Iterator
from typing import NamedTuple, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import Fixtures, ObjectClass, Scene


class MeshPart(NamedTuple):
    """An object that is there once."""

    name: str  # Name of the object, such as `building-12`
    object_class: ObjectClass
    mesh: Mesh  # World-space triangles


class Copies(NamedTuple):
    """All copies of a prototype that are of one class."""

    name: str  # Name of the prototype, such as `street lamp`
    object_class: ObjectClass
    prototype: int
    pose: NDArray[np.float32]  # Rotation times scale, and translation [m], shape (K, 3, 4)


def parts_of(scene: Scene) -> Iterator[MeshPart]:
    """Yield the objects of the static mesh, by class and then by number."""
    owners = np.unique(scene.static_object)
    classes = scene.object_class[owners]
    order = np.lexsort((owners, classes))
    by_owner = np.argsort(scene.static_object, kind="stable")
    sorted_owners = scene.static_object[by_owner]
    for owner, kind in zip(owners[order].tolist(), classes[order].tolist(), strict=True):
        low, high = np.searchsorted(sorted_owners, [owner, owner + 1]).tolist()
        found = ObjectClass(kind)
        mesh = subset(scene.static, np.sort(by_owner[low:high]))
        yield MeshPart(f"{found.name.lower()}-{owner}", found, mesh)


def subset(mesh: Mesh, triangles: NDArray[np.int64]) -> Mesh:
    """Return some triangles of a mesh, with their vertices alone."""
    used, corners = np.unique(mesh.triangles[triangles], return_inverse=True)
    return Mesh(
        positions=mesh.positions[used],
        normals=mesh.normals[used],
        uvs=mesh.uvs[used],
        triangles=corners.reshape(-1, 3).astype(np.int32),
        materials=mesh.materials[triangles],
        palette=mesh.palette,
    )


def copies_of(scene: Scene) -> Iterator[Copies]:
    """Yield the repeated things, by class and then by prototype."""
    fixtures = scene.fixtures
    classes = scene.object_class[fixtures.object_id]
    pairs = sorted(set(zip(classes.tolist(), fixtures.prototype.tolist(), strict=True)))
    for kind, prototype in pairs:
        ours = (classes == kind) & (fixtures.prototype == prototype)
        name = fixtures.names[prototype] if fixtures.names else f"prototype {prototype}"
        yield Copies(name, ObjectClass(kind), prototype, fixtures.pose[ours])


def prototypes_of(
    fixtures: Fixtures,
    detail: int,  # Level of detail; 0 is the finest
) -> list[Mesh]:
    """Return the mesh of each prototype, without vertices that no triangle has."""
    chosen = [levels[min(detail, len(levels) - 1)] for levels in fixtures.levels]
    return [subset(mesh, np.arange(len(mesh.triangles))) for mesh in chosen]


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


def welded(
    mesh: Mesh,
    step: float = 0.0,  # Numbers are rounded to whole multiples of this; 0: they stay as they are
) -> Welded:
    """Return a mesh with every point once, without triangles that have no area."""
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


def prism(
    outline: NDArray[np.float64], span: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the points and triangles of a prism on a counter-clockwise outline."""
    count = len(outline)
    sides = np.concatenate([np.column_stack([outline, np.full(count, z)]) for z in span])
    here, there = np.arange(count), (np.arange(count) + 1) % count
    walls = [[here, there, there + count], [here, there + count, here + count]]
    floor, roof = (flat_polygon(shapely.Polygon(outline), z, Material(), 1.0) for z in span)
    below = 2 * count
    above = below + len(floor.positions)
    triangles: list[NDArray[np.signedinteger]] = [np.stack(wall, axis=1) for wall in walls]
    triangles += [floor.triangles[:, ::-1] + below, roof.triangles + above]
    every = np.concatenate([sides, floor.positions, roof.positions])
    # Floor and roof have single numbers: so must the sides, or they share no point with these.
    points, where = distinct(every.astype(np.float32).astype(np.float64))
    return points, where[np.concatenate(triangles)].astype(np.int32)
