"""Behaviour of snow on each material: it lies, is driven on, clings to leaves or does not stay."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from eyas.render.kernels.surface.snow import Bed
from eyas.state.draw import PartLibrary
from eyas.state.mesh import Material, Surface
from eyas.state.scene import ObjectClass, Scene

__all__ = ["crown_middles", "snow_beds"]

_MIDDLE = 0.3
"""Height of a crown's middle between its lower end and its top: crowns are flat below."""


def snow_beds(scene: Scene, parts: PartLibrary, palette: Iterable[Material]) -> NDArray[np.int32]:
    """Return the `Bed` of each material of a palette."""
    driven_on = _road_materials(scene)
    moving = {material for levels in parts.parts for mesh in levels for material in mesh.palette}

    def bed(material: Material) -> Bed:
        if material in moving:
            return Bed.VEHICLE if material.surface == Surface.PAINT else Bed.BARE
        if material.surface in (Surface.WATER, Surface.LAMP, Surface.SIGNAL):
            return Bed.BARE
        if material.surface in (Surface.FOLIAGE, Surface.CROWN):
            return Bed.LEAVES
        return Bed.DRIVEN if material in driven_on else Bed.OPEN

    return np.array([bed(material) for material in palette], np.int32)


def crown_middles(scene: Scene, palette: Iterable[Material]) -> NDArray[np.float32]:
    """Return z of the middle of the crowns of each material of a palette, in their own frame."""
    middle: dict[Material, float] = {}
    for levels in scene.fixtures.levels:
        mesh = levels[0]
        leafy = np.array([material.surface == Surface.FOLIAGE for material in mesh.palette])
        leaves = mesh.triangles[leafy[mesh.materials]]
        if len(leaves):
            z = mesh.positions[leaves, 2]
            height = float(z.min() + _MIDDLE * np.ptp(z))
            middle |= {material: height for level in levels for material in level.palette}
    return np.array([middle.get(material, 0.0) for material in palette], np.float32)


def _road_materials(scene: Scene) -> set[Material]:
    """Return the upward-facing materials of roads; their edges may share materials with roofs."""
    mesh = scene.static
    if len(mesh.triangles) == 0:
        return set()
    kind = scene.object_class[scene.static_object]
    flat = mesh.normals[mesh.triangles[:, 0], 2] > 0.7
    road = flat & np.isin(kind, (ObjectClass.ROAD, ObjectClass.MARKING))
    return {mesh.palette[index] for index in np.unique(mesh.materials[road])}
