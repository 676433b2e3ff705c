"""Shapes in Webots' `.proto` files: plain geometry, at the places where its nodes put it."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.core.errors import DataFileError
from eyas.core.files import read_limited
from eyas.custom.proto_parser import Node, parsed

__all__ = ["GEOMETRY", "Part", "read_proto"]

GEOMETRY = ("Box", "Cylinder", "Sphere", "Cone", "Capsule", "IndexedFaceSet", "Mesh")
"""Geometry nodes that are read."""

_LARGEST_FILE = 64 << 20
"""[bytes]"""
_MOST_PARTS, _MOST_TRIANGLES = 5000, 1_000_000
_ROUND = 24
"""Number of sides of what is round."""
_PLAIN = (0.62, 0.62, 0.62)
"""sRGB of what has no colour."""
_INSIDE = ("children", "endPoint", "device", "value")
"""Fields in which there may be shapes; not `boundingObject`, which nobody sees."""

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
Part = tuple[Floats, Faces, tuple[float, float, float]]
"""Points [m], shape (V, 3), triangles, shape (T, 3), and sRGB."""
Solid = tuple[Floats, Faces]


def read_proto(path: Path, mesh: Callable[[Path], Solid]) -> list[Part]:
    """Return the parts of a shape.

    Args:
        path: The file.
        mesh: Reads a mesh file, of a `Mesh` node.

    Raises:
        DataFileError: It cannot be read, or holds nothing that can be shown: one line.
    """
    text = read_limited(path, _LARGEST_FILE).decode("utf-8", "replace")
    walk = _Walk(path, mesh)
    try:
        walk.visit(parsed(text), np.eye(3), np.zeros(3), 0)
    except (ValueError, TypeError, IndexError, OverflowError) as error:
        raise DataFileError(f"{path}: cannot read as a PROTO: {error}") from None
    if not walk.parts:
        raise DataFileError(
            f"{path}: no geometry that can be read; allowed: {', '.join(GEOMETRY)} in Shape nodes"
        )
    return walk.parts


class _Walk:
    """Gathers the parts of a tree of nodes."""

    def __init__(self, path: Path, mesh: Callable[[Path], Solid]) -> None:
        self.parts: list[Part] = []
        self._path, self._mesh = path, mesh
        self._triangles = self._visited = 0

    def visit(self, node: Node, turn: Floats, place: Floats, depth: int) -> None:
        """Add what a node shows, in the frame of its parent (a matrix and an origin)."""
        self._visited += 1
        if depth > 64 or self._visited > 20 * _MOST_PARTS:
            raise ValueError("nested too deep, or too many nodes")
        place = place + exact.product(turn, _vector(node, "translation", (0.0, 0.0, 0.0)))
        turn = exact.product(turn, _rotation(node.fields.get("rotation")))
        turn = turn * _vector(node, "scale", (1.0, 1.0, 1.0))
        if node.kind == "Shape":
            self._add(node, turn, place)
            return
        for name in _INSIDE:
            inside = node.fields.get(name)
            for child in inside if isinstance(inside, list) else [inside]:
                if isinstance(child, Node):
                    self.visit(child, turn, place, depth + 1)

    def _add(self, shape: Node, turn: Floats, place: Floats) -> None:
        geometry = shape.fields.get("geometry")
        if not isinstance(geometry, Node):
            return
        points, faces = self._solid(geometry)
        if exact.dot(turn[0], np.cross(turn[1], turn[2])) < 0.0:
            faces = faces[:, ::-1]  # mirrored
        self._triangles += len(faces)
        if len(self.parts) >= _MOST_PARTS or self._triangles > _MOST_TRIANGLES:
            raise ValueError(f"more than {_MOST_PARTS} shapes or {_MOST_TRIANGLES} triangles")
        self.parts.append((exact.product(points, turn.T) + place, faces, _colour(shape)))

    def _solid(self, node: Node) -> Solid:
        if node.kind == "Mesh":
            return self._file(node)
        made = _SOLIDS.get(node.kind)
        if made is None:
            raise ValueError(f"geometry {node.kind}; allowed: {', '.join(GEOMETRY)}")
        return made(node)

    def _file(self, node: Node) -> Solid:
        url = node.fields.get("url")
        url = url[0] if isinstance(url, list) and url else url
        if not isinstance(url, str) or "://" in url:
            raise ValueError(f"Mesh: url {url!r}; allowed: a file beside the PROTO")
        return self._mesh(self._path.parent / url)


def _vector(node: Node, name: str, default: Sequence[float]) -> Floats:
    value = node.fields.get(name)
    numbers = np.array(default if value is None else value, np.float64)
    if numbers.shape != (len(default),) or not np.isfinite(numbers).all():
        raise ValueError(f"{node.kind}.{name}: {len(default)} numbers expected")
    return numbers


def _number(node: Node, name: str, default: float) -> float:
    value = float(_vector(node, name, (default,))[0])
    if value <= 0.0:
        raise ValueError(f"{node.kind}.{name}: a number above 0 expected")
    return value


def _rotation(value: object) -> Floats:
    """Return the matrix of an axis and an angle [rad] (Rodrigues' formula)."""
    if value is None:
        return np.eye(3)
    x, y, z, angle = np.array(value, np.float64)
    length = math.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return np.eye(3)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / length
    twice = exact.product(cross, cross)
    turned = np.eye(3) + exact.sin(angle) * cross + (1.0 - exact.cos(angle)) * twice
    return np.asarray(turned, np.float64)


def _colour(shape: Node) -> tuple[float, float, float]:
    appearance = shape.fields.get("appearance")
    if not isinstance(appearance, Node):
        return _PLAIN
    material = appearance.fields.get("material")
    given = appearance.fields.get("baseColor")
    if isinstance(material, Node):
        given = material.fields.get("diffuseColor", given)
    if given is None:
        return _PLAIN
    red, green, blue = np.clip(np.array(given, np.float64), 0.0, 1.0).tolist()
    return red, green, blue


def _box(node: Node) -> Solid:
    half = 0.5 * _vector(node, "size", (0.1, 0.1, 0.1))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
    quads = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    )
    return signs * half, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def _turned(profile: Sequence[tuple[float, float]]) -> Solid:
    """Return a solid of revolution about z from radii and heights, the lowest first."""
    angle = 2.0 * math.pi * np.arange(_ROUND) / _ROUND
    ring = np.stack([exact.cos(angle), exact.sin(angle)], axis=-1)
    points = [np.column_stack([r * ring, np.full(_ROUND, z)]) for r, z in profile]
    here = np.arange(_ROUND)
    after = (here + 1) % _ROUND
    faces = []
    for level in range(len(profile) - 1):
        low, high = level * _ROUND, (level + 1) * _ROUND
        if profile[level][0] > 0.0:
            faces.append(np.column_stack([low + here, low + after, high + after]))
        if profile[level + 1][0] > 0.0:
            faces.append(np.column_stack([low + here, high + after, high + here]))
    return np.concatenate(points), np.concatenate(faces)


def _cylinder(node: Node) -> Solid:
    radius, half = _number(node, "radius", 1.0), 0.5 * _number(node, "height", 2.0)
    return _turned([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])


def _cone(node: Node) -> Solid:
    radius, half = _number(node, "bottomRadius", 1.0), 0.5 * _number(node, "height", 2.0)
    return _turned([(0.0, -half), (radius, -half), (0.0, half)])


def _arc(radius: float, middle: float, first: float, last: float) -> list[tuple[float, float]]:
    """Return points of a circle between two heights above its middle, as angles [rad]."""
    angles = np.linspace(first, last, _ROUND // 2 + 1)
    return [(radius * max(exact.cos(a), 0.0), middle + radius * exact.sin(a)) for a in angles]


def _ended(profile: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(0.0, profile[0][1]), *profile[1:-1], (0.0, profile[-1][1])]


def _sphere(node: Node) -> Solid:
    quarter = 0.5 * math.pi
    return _turned(_ended(_arc(_number(node, "radius", 1.0), 0.0, -quarter, quarter)))


def _capsule(node: Node) -> Solid:
    radius, half = _number(node, "radius", 1.0), 0.5 * _number(node, "height", 2.0)
    quarter = 0.5 * math.pi
    low, high = _arc(radius, -half, -quarter, 0.0), _arc(radius, half, 0.0, quarter)
    return _turned(_ended([*low, *high]))


def _face_set(node: Node) -> Solid:
    """Return the triangles of polygons, cut like fans from their first corners."""
    coord = node.fields.get("coord")
    point = coord.fields.get("point") if isinstance(coord, Node) else None
    points = np.array([] if point is None else point, np.float64).reshape(-1, 3)
    index = node.fields.get("coordIndex")
    corners = np.array([] if index is None else index, np.float64).astype(np.int64)
    if corners.size and corners.max() >= len(points):
        raise ValueError(f"IndexedFaceSet.coordIndex: up to {len(points) - 1} expected")
    faces, polygon = [], list[int]()
    for corner in [*corners.tolist(), -1]:
        if corner >= 0:
            polygon.append(corner)
            continue
        faces += [(polygon[0], b, c) for b, c in pairwise(polygon[1:])]
        polygon = []
    if not faces:
        raise ValueError("IndexedFaceSet: it has no faces")
    order = -1 if node.fields.get("ccw") is False else 1
    return points, np.array(faces, np.int64)[:, ::order]


_SOLIDS: dict[str, Callable[[Node], Solid]] = {
    "Box": _box,
    "Cylinder": _cylinder,
    "Cone": _cone,
    "Sphere": _sphere,
    "Capsule": _capsule,
    "IndexedFaceSet": _face_set,
}
