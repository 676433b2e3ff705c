"""Solid shapes of what stands on a map as copies of a mesh, and has no collider: crowns of trees,
hedges, parked cars, benches.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.state.mesh import Mesh, Surface
from eyas.state.scene import ObjectClass, Scene

__all__ = ["Box", "Cylinder", "Furniture", "furniture"]

_LONG = 1.4
"""Length over width from which leaves are a hedge, and no crown."""

_CROWN = 0.85
"""Radius of a crown's cylinder over that of its mesh, whose outermost leaves stand alone."""

_TRUNK = 0.025
"""Radius of a trunk over the height of its tree."""


@dataclass(frozen=True, slots=True)
class Box:
    """An upright prism."""

    outline: NDArray[np.float64]
    """Counter-clockwise [m], shape (4, 2)."""
    bottom: float
    top: float
    thing: int
    """Object of the scene."""


@dataclass(frozen=True, slots=True)
class Cylinder:
    """An upright cylinder."""

    place: tuple[float, float, float]
    """x, y, radius [m]."""
    bottom: float
    top: float
    thing: int
    """Object of the scene."""


@dataclass(frozen=True, slots=True)
class Furniture:
    """The solids of all copies."""

    boxes: list[Box]
    cylinders: list[Cylinder]


def furniture(scene: Scene) -> Furniture:
    """Return solids for the copies of a scene: crowns for all trees, and for what has no collider a
    box around it. Small parts of objects with a collider, such as those on roofs, get none.
    """
    made, fixtures = Furniture([], []), scene.fixtures
    solid = {*scene.colliders.prism_object.tolist(), *scene.colliders.cylinder_object.tolist()}
    spans: dict[tuple[int, bool], NDArray[np.float64] | None] = {}
    pairs = zip(fixtures.prototype.tolist(), fixtures.object_id.tolist(), strict=True)
    for copy, (prototype, thing) in enumerate(pairs):
        tree = scene.object_class[thing] == ObjectClass.TREE
        if not tree and thing in solid:
            continue
        if (prototype, tree) not in spans:
            spans[prototype, tree] = _span(fixtures.levels[prototype][0], leaves=tree)
        span = spans[prototype, tree]
        if span is not None:
            pose = fixtures.pose[copy].astype(np.float64)
            _add(made, span, pose, thing, tree=tree, trunk=thing not in solid)
    return made


def _span(mesh: Mesh, *, leaves: bool) -> NDArray[np.float64] | None:
    """Return lowest and highest x, y, z of a mesh, or of its leaves if it has any, shape (2, 3)."""
    chosen = np.ones(len(mesh.triangles), np.bool_)
    if leaves:
        foliage = [m.surface in (Surface.FOLIAGE, Surface.CROWN) for m in mesh.palette]
        chosen = np.array(foliage, np.bool_)[mesh.materials]
        chosen |= not chosen.any()
    corners = mesh.positions[np.unique(mesh.triangles[chosen])].astype(np.float64)
    return np.stack([corners.min(axis=0), corners.max(axis=0)]) if len(corners) else None


def _add(
    made: Furniture,
    span: NDArray[np.float64],
    pose: NDArray[np.float64],
    thing: int,
    *,
    tree: bool,
    trunk: bool,
) -> None:
    """Add the solids of one copy."""
    (west, south, low), (east, north, high) = span
    length, width = east - west, north - south
    bottom, top = pose[2, 2] * low + pose[2, 3], pose[2, 2] * high + pose[2, 3]
    if not tree or max(length, width) > _LONG * min(length, width):
        corners = np.array([[west, south], [east, south], [east, north], [west, north]])
        outline = corners @ pose[:2, :2].T + pose[:2, 3]
        made.boxes.append(Box(outline, float(bottom), float(top), thing))
        return
    middle = pose[:2, :2] @ [0.5 * (west + east), 0.5 * (south + north)] + pose[:2, 3]
    scale = math.hypot(pose[0, 0], pose[1, 0])
    x, y, radius = float(middle[0]), float(middle[1]), _CROWN * 0.25 * scale * (length + width)
    made.cylinders.append(Cylinder((x, y, radius), float(bottom), float(top), thing))
    if trunk and bottom > pose[2, 3]:
        foot, thick = float(pose[2, 3]), _TRUNK * float(top - pose[2, 3])
        x, y = float(pose[0, 3]), float(pose[1, 3])
        made.cylinders.append(Cylinder((x, y, thick), foot, float(bottom), thing))
