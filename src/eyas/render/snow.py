"""How much snow stays on each material: on roads little, on what moves none."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from eyas.state.draw import PartLibrary
from eyas.state.mesh import Material, Surface
from eyas.state.scene import ObjectClass, Scene

__all__ = ["ON_ROADS", "snow_held"]

ON_ROADS = 0.08
"""Share of the snow that traffic and salt leave on roads and their paint: as in the original, roads
stay black but for a thin dusting."""


def snow_held(scene: Scene, parts: PartLibrary, palette: Iterable[Material]) -> NDArray[np.float32]:
    """Return the share of fallen snow that stays on each material of a palette, 0 to 1."""
    driven_on = _road_materials(scene)
    moving = {material for levels in parts.parts for mesh in levels for material in mesh.palette}

    def share(material: Material) -> float:
        if material in moving or material.surface in (Surface.WATER, Surface.LAMP):
            return 0.0
        return ON_ROADS if material in driven_on else 1.0

    return np.array([share(material) for material in palette], np.float32)


def _road_materials(scene: Scene) -> set[Material]:
    """Return what faces up on roads: their edges may be of what is elsewhere a roof."""
    mesh = scene.static
    if len(mesh.triangles) == 0:
        return set()
    kind = scene.object_class[scene.static_object]
    flat = mesh.normals[mesh.triangles[:, 0], 2] > 0.7
    road = flat & np.isin(kind, (ObjectClass.ROAD, ObjectClass.MARKING))
    return {mesh.palette[index] for index in np.unique(mesh.materials[road])}
