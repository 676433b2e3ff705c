"""Solid shapes of what stands on a map as copies of a mesh, and has no collider: crowns of trees,
hedges, parked cars, benches.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Mesh, Surface
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.lanes import exact

Row = NDArray[np.float64]

_SLICES = 5  # Cylinders in the stack

_SHARE = 0.85
"""Radius of a cylinder over that of the leaves at its height: the outermost stand alone."""

_CUTS = 4  # Parts into which each edge of a triangle is cut to find points on it


def crown_slices(
    mesh: Mesh,  # The tree, or a stand of trees
    low: Row,  # Lowest x, y, z of its leaves [m], shape (3,)
    high: Row,  # Highest x, y, z of its leaves [m], shape (3,)
) -> list[tuple[float, float, float]]:
    """Return bottom, top and radius of the cylinders of a crown, in the mesh's frame [m]."""
    middle = 0.5 * (low + high)[:2]
    most = 0.25 * float((high - low)[:2].sum())  # the corners of a square stand are further away
    points = _points_on(mesh)
    away = np.linalg.norm(points[:, :2] - middle, axis=1)
    ends = np.linspace(low[2], high[2], _SLICES + 1)
    slices = []
    for bottom, top in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        inside = (points[:, 2] >= bottom) & (points[:, 2] <= top)
        if inside.any():
            slices.append((bottom, top, _SHARE * min(float(away[inside].max()), most)))
    return slices


def leaves_of(mesh: Mesh) -> NDArray[np.bool_]:
    """Return which triangles are leaves; all if none is."""
    foliage = [m.surface in (Surface.FOLIAGE, Surface.CROWN) for m in mesh.palette]
    chosen = np.array(foliage, np.bool_)[mesh.materials]
    return chosen if chosen.any() else np.ones_like(chosen)


def _points_on(mesh: Mesh) -> NDArray[np.float64]:
    """Return points all over the leaves of a mesh, shape (K, 3)."""
    corners = mesh.positions[mesh.triangles[leaves_of(mesh)]].astype(np.float64)
    share = np.array(
        [(a, b, _CUTS - a - b) for a in range(_CUTS + 1) for b in range(_CUTS + 1 - a)]
    )
    points: NDArray[np.float64] = exact.product(share / _CUTS, corners).reshape(-1, 3)
    return points


_LONG = 1.4  # Length over width from which leaves are a hedge, and no crown

_TRUNK = 0.025  # Radius of a trunk over the height of its tree


@dataclass(frozen=True, slots=True)
class Prism:
    """An upright prism."""

    outline: NDArray[np.float64]  # Counter-clockwise [m], shape (4, 2)
    bottom: float
    top: float
    thing: int  # Object of the scene


@dataclass(frozen=True, slots=True)
class Cylinder:
    """An upright cylinder."""

    place: tuple[float, float, float]  # x, y, radius [m]
    bottom: float
    top: float
    thing: int  # Object of the scene


@dataclass(frozen=True, slots=True)
class Furniture:
    """The solids of all copies."""

    boxes: list[Prism]
    cylinders: list[Cylinder]


def furniture(scene: Scene) -> Furniture:
    """Return solids for the copies of a scene: crowns for all trees, and for what has no collider a
    box around it. Small parts of objects with a collider, such as those on roofs, get none, nor do
    stones and tufts, which are ground.
    """
    made, fixtures = Furniture([], []), scene.fixtures
    solid = {*scene.colliders.prism_object.tolist(), *scene.colliders.cylinder_object.tolist()}
    spans: dict[tuple[int, bool], _Span | None] = {}
    pairs = zip(fixtures.prototype.tolist(), fixtures.object_id.tolist(), strict=True)
    for copy, (prototype, thing) in enumerate(pairs):
        kind = scene.object_class[thing]
        tree = kind == ObjectClass.TREE
        if kind == ObjectClass.GROUND or (not tree and thing in solid):
            continue
        if (prototype, tree) not in spans:
            spans[prototype, tree] = _span(fixtures.levels[prototype][0], leaves=tree)
        span = spans[prototype, tree]
        if span is not None:
            pose = fixtures.pose[copy].astype(np.float64)
            _add(made, span, pose, thing, trunk=thing not in solid)
    return made


class _Span(NamedTuple):
    """The extent of a mesh, or of the leaves of a tree, in the mesh's frame."""

    low: list[float]  # Lowest x, y, z [m]
    high: list[float]
    slices: list[tuple[float, float, float]]
    """Bottom, top and radius of the cylinders of a crown [m]; none: it is a box."""


def _span(mesh: Mesh, *, leaves: bool) -> _Span | None:
    """Return the extent of a mesh, of its leaves if it is a tree with any; None if it is empty."""
    chosen = leaves_of(mesh) if leaves else np.ones(len(mesh.triangles), np.bool_)
    corners = mesh.positions[np.unique(mesh.triangles[chosen])].astype(np.float64)
    if not len(corners):
        return None
    low, high = corners.min(axis=0), corners.max(axis=0)
    length, width, _ = high - low
    crown = leaves and max(length, width) <= _LONG * min(length, width)
    slices = crown_slices(mesh, low, high) if crown else []
    return _Span(low.tolist(), high.tolist(), slices)


def _add(
    made: Furniture, span: _Span, pose: NDArray[np.float64], thing: int, *, trunk: bool
) -> None:
    """Add the solids of one copy."""
    (west, south, low), (east, north, high) = span.low, span.high
    foot, tall = float(pose[2, 3]), float(pose[2, 2])
    bottom, top = tall * low + foot, tall * high + foot
    if not span.slices:
        corners = np.array([[west, south], [east, south], [east, north], [west, north]])
        outline = exact.product(corners, pose[:2, :2].T) + pose[:2, 3]
        made.boxes.append(Prism(outline, bottom, top, thing))
        return
    middle = exact.product(pose[:2, :2], [0.5 * (west + east), 0.5 * (south + north)]) + pose[:2, 3]
    x, y, scale = float(middle[0]), float(middle[1]), exact.hypot(pose[0, 0], pose[1, 0])
    for begin, end, radius in span.slices:
        place = (x, y, scale * radius)
        made.cylinders.append(Cylinder(place, tall * begin + foot, tall * end + foot, thing))
    if trunk and bottom > foot:
        place = (float(pose[0, 3]), float(pose[1, 3]), _TRUNK * (top - foot))
        made.cylinders.append(Cylinder(place, foot, bottom, thing))
