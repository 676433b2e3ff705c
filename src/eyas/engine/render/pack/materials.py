"""Materials as the kernels read them: texture, tint, and what snow does on them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.surface.snow import Bed
from eyas.engine.render.textures.mipmap import linear
from eyas.engine.state.draw import PartLibrary
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ObjectClass, Scene

_POROUS = {"lawn", "lawn_mown", "soil", "sand", "dry_leaves"}
"""Textures of ground into which rain soaks; crops let none be seen."""

_SIGNALS = range(Surface.TAIL_LAMP, Surface.INDICATOR_RIGHT + 1)
_BARE = {Surface.WATER, Surface.LAMP, Surface.SIGNAL, *_SIGNALS}  # Surfaces on which snow melts

_MIDDLE = 0.3  # Height of a crown's middle between its lower end and its top: crowns are flat below


@dataclass(frozen=True, slots=True)
class MaterialTable:
    """Columns of `Geometry.look`."""

    layer: NDArray[np.int32]
    surface: NDArray[np.int32]
    tint: NDArray[np.float32]
    emission: NDArray[np.float32]
    snow_bed: NDArray[np.int32]
    crown_middle: NDArray[np.float32]


def material_table(
    scene: Scene, parts: PartLibrary, palette: Sequence[Material], names: Sequence[str]
) -> MaterialTable:
    """Return the materials of a palette; textures are numbered as in `names`."""
    tint = linear(np.array([material.tint for material in palette]).reshape(-1, 3))
    return MaterialTable(
        layer=np.array([names.index(material.texture) for material in palette], np.int32),
        surface=np.array([material.surface for material in palette], np.int32),
        tint=tint.astype(np.float32),
        emission=np.array([material.emission for material in palette], np.float32),
        snow_bed=snow_beds(scene, parts, palette),
        crown_middle=crown_middles(scene, palette),
    )


def snow_beds(scene: Scene, parts: PartLibrary, palette: Iterable[Material]) -> NDArray[np.int32]:
    """Return the `Bed` of each material: snow lies, is driven on, clings to leaves or melts."""
    driven_on = _road_materials(scene)
    moving = {material for levels in parts.parts for mesh in levels for material in mesh.palette}

    def bed(material: Material) -> Bed:
        if material in moving:
            return Bed.VEHICLE if material.surface == Surface.PAINT else Bed.BARE
        if material.surface in _BARE:
            return Bed.BARE
        if material.surface in (Surface.FOLIAGE, Surface.CROWN):
            return Bed.LEAVES
        if material in driven_on:
            return Bed.DRIVEN
        return Bed.POROUS if material.texture in _POROUS else Bed.OPEN

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
    found = {mesh.palette[index] for index in np.unique(mesh.materials[road])}
    # Snow lies on the plain lines of flyovers, unlike on paint, which has a texture.
    return {material for material in found if material.texture != "plain"}
