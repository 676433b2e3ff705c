"""Shapes of Webots: triangles with their materials."""

import numpy as np
from numpy.typing import NDArray

from eyas.dat.webots.vrml import Is, Node, Use, Value, floats, indices, label
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.maps.formats.gltf.file import PLAIN
from eyas.maps.formats.meshes import Indexed, subset, welded

_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}
_FLAT = 0.9999  # Cosine of the largest angle between the normals of a face's corners and its own
_STEP = 1e-4  # Resolution of positions, normals and texture coordinates, as they are written

Floats = NDArray[np.float64]


class Shapes:
    """Makes the shapes of one file; each material is told once.

    Attributes:
        textures: Names of the textures that they show.

    Args:
        folder: Folder of the textures, relative to the file.
        paint: Field of a PROTO that colours what is painted; empty: it is white.
        lit: Whether lamps shine.
    """

    def __init__(self, folder: str, paint: str = "", *, lit: bool = False) -> None:
        self.textures: set[str] = set()
        self._folder, self._paint = folder, paint
        self._names: dict[Material, str] = {}
        self._shining = {Surface.SIGNAL, Surface.LAMP} if lit else {Surface.SIGNAL}

    def of(self, mesh: Mesh) -> list[Node]:
        """Return a mesh as shapes, one for each material; none without triangles that have an
        area.
        """
        shapes = []
        for index in np.unique(mesh.materials).tolist():
            material = mesh.palette[index]
            part = subset(mesh, np.flatnonzero(mesh.materials == index))
            geometry = _geometry(part, textured=material.texture != PLAIN)
            if geometry is not None:
                shown: dict[str, Value] = {"appearance": self._look(material), "geometry": geometry}
                if material.surface is Surface.CROWN:
                    shown["castShadows"] = False
                shapes.append(Node("Shape", shown))
        return shapes

    def _look(self, material: Material) -> Node | Use:
        if material in self._names:
            return Use(self._names[material])
        name = label(f"{material.texture}_{len(self._names)}")
        self._names[material] = name
        painted = self._paint and material.surface is Surface.PAINT and min(material.tint) > 0.9
        tint = tuple(min(round(part, 4), 1.0) for part in material.tint)
        look: dict[str, Value] = {
            "baseColor": Is(self._paint) if painted else tint,
            "roughness": _ROUGH.get(material.surface, 1.0),
            "metalness": 0.0,
        }
        if material.texture != PLAIN:
            self.textures.add(material.texture)
            url = f"{self._folder}/{material.texture}.png"
            look["baseColorMap"] = Node("ImageTexture", {"url": [url]})
        if material.surface in self._shining:
            look["emissiveColor"] = tint
        return Node("PBRAppearance", look, name)


def _geometry(mesh: Mesh, *, textured: bool) -> Node | None:
    shape = welded(mesh, _STEP)
    if not len(shape.materials):
        return None
    fields = _indexed("coord", "Coordinate", "point", shape.points)
    turned = (shape.normals.values[shape.normals.corners] * shape.across[:, None, :]).sum(axis=2)
    if (turned < _FLAT).any():
        fields |= _indexed("normal", "Normal", "vector", shape.normals)
    if textured:
        fields |= _indexed("texCoord", "TextureCoordinate", "point", shape.uvs)
    return Node("IndexedFaceSet", fields)


def _indexed(name: str, kind: str, inner: str, told: Indexed) -> dict[str, Value]:
    """Return a field of vectors, and that of their indices."""
    vectors = Node(kind, {inner: floats(told.values)})
    return {name: vectors, f"{name}Index": indices(told.corners)}


def face_set(points: Floats, triangles: NDArray[np.integer]) -> Node:
    """Return triangles without looks, for what is solid."""
    coordinates = Node("Coordinate", {"point": floats(points)})
    return Node("IndexedFaceSet", {"coord": coordinates, "coordIndex": indices(triangles)})
