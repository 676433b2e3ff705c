"""What stands on a map, part by part: for files of other programs, which want names and classes."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import Fixtures, ObjectClass, Scene

__all__ = ["Copies", "Part", "copies_of", "parts_of", "prototypes_of", "subset"]


class Part(NamedTuple):
    """An object that is there once."""

    name: str  # Its own, such as `building-12`
    object_class: ObjectClass
    mesh: Mesh  # World-space triangles


class Copies(NamedTuple):
    """All copies of a prototype that are of one class."""

    name: str  # Of the prototype, such as `street lamp`
    object_class: ObjectClass
    prototype: int
    pose: NDArray[np.float32]  # Rotation times scale, and translation [m], shape (K, 3, 4)


def parts_of(scene: Scene) -> Iterator[Part]:
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
        yield Part(f"{found.name.lower()}-{owner}", found, mesh)


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


def prototypes_of(fixtures: Fixtures, detail: int) -> list[Mesh]:
    """Return the mesh of each prototype, without vertices that no triangle has.

    Args:
        fixtures: The repeated things.
        detail: Level of detail; 0 is the finest.
    """
    chosen = [levels[min(detail, len(levels) - 1)] for levels in fixtures.levels]
    return [subset(mesh, np.arange(len(mesh.triangles))) for mesh in chosen]
