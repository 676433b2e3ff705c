"""Shapes of Webots: triangles with their materials."""

import numpy as np
from numpy.typing import NDArray

from eyas.exports.gltf.file import PLAIN
from eyas.modes.maps.webots.vrml import Is, Node, Use, Value, floats, indices, label
from eyas.state.mesh import Material, Mesh, Surface

__all__ = ["Shapes", "face_set"]

_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}
_FLAT = 0.9999
"""Cosine of the largest angle between the normals of a face's corners and its own."""

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
            geometry = _geometry(mesh, mesh.materials == index, textured=material.texture != PLAIN)
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


def _geometry(mesh: Mesh, chosen: NDArray[np.bool_], *, textured: bool) -> Node | None:
    corners = mesh.triangles[chosen]
    points, where = _distinct(np.rint(mesh.positions.astype(np.float64) * 1e4) / 1e4)
    faces = where[corners]
    across = _across(points[faces])
    area = np.sqrt(np.square(across).sum(axis=1))
    kept = area > 1e-8
    corners, faces, across, area = corners[kept], faces[kept], across[kept], area[kept]
    if not len(corners):
        return None
    fields = _indexed("coord", "Coordinate", "point", points[faces])
    normals = mesh.normals[corners]
    turned = (normals * (across / area[:, None])[:, None, :]).sum(axis=2)
    if (turned < _FLAT).any():
        fields |= _indexed("normal", "Normal", "vector", normals)
    if textured:
        uvs = mesh.uvs[corners]
        fields |= _indexed("texCoord", "TextureCoordinate", "point", uvs)
    return Node("IndexedFaceSet", fields)


def _indexed(name: str, kind: str, inner: str, corners: NDArray[np.floating]) -> dict[str, Value]:
    """Return a field of vectors, and that of their indices, of the corners of each face, shape
    (T, 3, parts).
    """
    flat = np.rint(np.asarray(corners, np.float64).reshape(-1, corners.shape[-1]) * 1e4) / 1e4
    values, where = _distinct(flat + 0.0)
    faces = where.reshape(-1, 3)
    return {name: Node(kind, {inner: floats(values)}), f"{name}Index": indices(faces)}


def _distinct(rows: Floats) -> tuple[Floats, NDArray[np.int64]]:
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


def _across(corners: Floats) -> Floats:
    """Return the cross product of two edges of each face."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def face_set(points: Floats, triangles: NDArray[np.integer]) -> Node:
    """Return triangles without looks, for what is solid."""
    coordinates = Node("Coordinate", {"point": floats(points)})
    return Node("IndexedFaceSet", {"coord": coordinates, "coordIndex": indices(triangles)})
