"""Shapes in Webots' `.proto` files: plain geometry, at the places where its nodes put it."""

import math
import re
from collections import Counter
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.dat.proto_parser import ProtoNode, parsed
from eyas.dat.proto_script import Limits
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.lanes import exact

GEOMETRY = ("Box", "Cylinder", "Sphere", "Cone", "Capsule", "IndexedFaceSet", "Mesh")
"""Geometry nodes that are read."""

_LARGEST_FILE = 64 << 20  # [bytes]
_MOST_PARTS, _MOST_TRIANGLES = 5000, 1_000_000
_MOST_READ = 64 << 20
"""Largest content of all PROTOs together, where one is read again for each node [bytes]."""
_ROUND = 24  # Number of sides of what is round
_PLAIN = (0.62, 0.62, 0.62)  # sRGB of what has no colour
_INSIDE = (
    "children", "endPoint", "device", "value", "slowHelix", "fastHelix", "animatedGeometries",
)  # fmt: skip
"""Fields in which there may be shapes; not `boundingObject`, which is not drawn."""
_NOT_DRAWN = ("IndexedLineSet", "PointSet")  # Geometry without a surface
_NODES = frozenset(
    "Accelerometer Altimeter BallJoint Billboard Brake Camera Charger Compass Connector "
    "DifferentialWheels Display DistanceSensor Emitter GPS Group Gyro Hinge2Joint HingeJoint "
    "InertialUnit LED Lidar LightSensor LinearMotor Microphone Muscle Pen PointLight Pose "
    "PositionSensor Propeller Radar RangeFinder Receiver Robot RotationalMotor Servo SliderJoint "
    "Slot Solid SolidReference Speaker SpotLight Supervisor TouchSensor Track TrackWheel Transform "
    "VacuumGripper".split()
)
"""Webots' own nodes that show nothing but what is inside them."""

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
Part = tuple[Floats, Faces, Floats]
"""Points [m], shape (V, 3), triangles, shape (T, 3), and sRGB of each, shape (T, 3)."""
Solid = tuple[Floats, Faces]


def read_proto(path: Path, mesh: Callable[[Path], Part]) -> tuple[list[Part], str]:
    """Return the parts of a shape, and a line about what of it was left out, or nothing.

    Other PROTOs are read where they are files: named by `EXTERNPROTO`, or beside the file.

    Args:
        mesh: Reads a mesh file, of a `Mesh` or `CadShape` node.

    Raises:
        DataFileError: It cannot be read, or holds nothing that can be shown: one line.
    """
    walk = _Walk(mesh)
    try:
        walk.read(path)
    except (ValueError, TypeError, IndexError, OverflowError) as error:
        raise DataFileError(f"{path}: cannot read as a PROTO: {error}") from None
    counted = [f"{count} {kind}" for kind, count in sorted(walk.left_out.items())]
    left_out = f"left out, as not read: {', '.join(counted):.300}" if counted else ""
    if not walk.parts:
        told = f" ({left_out})" if counted else ""
        raise DataFileError(
            f"{path}: no geometry that can be read{told}; allowed: {', '.join(GEOMETRY)} in Shape "
            "nodes, and CadShape"
        )
    return walk.parts, left_out


class _Place:
    """Where a node stands: the file it is in, and the frame of its parent.

    Args:
        externs: Addresses of the PROTOs that it names.
        turn: Axes of the frame as columns, perhaps scaled.
        origin: Origin of the frame [m].
    """

    def __init__(self, path: Path, externs: dict[str, str], turn: Floats, origin: Floats) -> None:
        self.path, self._externs = path, externs
        self.turn, self.origin = turn, origin

    def inside(self, node: ProtoNode) -> "_Place":
        """Return the same in the frame of a node."""
        moved = exact.product(self.turn, _vector(node, "translation", (0.0, 0.0, 0.0)))
        turn = exact.product(self.turn, _rotation(node.fields.get("rotation")))
        turn = turn * _vector(node, "scale", (1.0, 1.0, 1.0))
        return _Place(self.path, self._externs, turn, self.origin + moved)

    def proto_of(self, kind: str) -> Path | None:
        """Return the file of another PROTO; None if it is not on this machine."""
        address = self._externs.get(kind, f"{kind}.proto")
        if "://" in address or not re.fullmatch(r"[\w.-]+", kind):
            return None
        path = self.path.parent / address
        try:
            return path if path.is_file() else None
        except (OSError, ValueError):  # a name that no file can have
            return None


class _Walk:
    """Gathers the parts of a tree of nodes."""

    def __init__(self, mesh: Callable[[Path], Part]) -> None:
        self.parts: list[Part] = []
        self.left_out: Counter[str] = Counter()
        self._mesh = mesh
        self._triangles = self._visited = self._parsed = 0
        self._texts: dict[Path, str] = {}
        self._limits = Limits()

    def read(self, path: Path) -> None:
        """Add what a file shows."""
        self._visit_proto(path, {}, np.eye(3), np.zeros(3), 0)

    def _visit_proto(
        self, path: Path, given: dict[str, object], turn: Floats, origin: Floats, depth: int
    ) -> None:
        """Add what a PROTO shows. Its own node moves it: `translation` is passed on to that."""
        if path not in self._texts:
            self._texts[path] = read_limited(path, _LARGEST_FILE).decode("utf-8", "replace")
        self._parsed += len(self._texts[path])
        if depth and self._parsed > _MOST_READ:
            raise ValueError("its PROTOs are too large together, or name each other without end")
        try:
            proto = parsed(self._texts[path], given, self._limits)
        except ValueError as error:
            raise ValueError(f"{path.name}: {error}" if depth else str(error)) from None
        self._visit(proto.body, _Place(path, proto.externs, turn, origin), depth + 1)

    def _visit(self, node: ProtoNode, at: _Place, depth: int) -> None:
        """Add what a node shows."""
        self._visited += 1
        if depth > 64 or self._visited > 20 * _MOST_PARTS:
            raise ValueError("nested too deep, or too many nodes")
        if node.kind == "Shape":
            self._add(node, at.inside(node))
        elif node.kind == "CadShape":
            here = at.inside(node)
            self._put(here, *self._file(node, here))
        elif node.kind in _NODES:
            here = at.inside(node)
            for name in _INSIDE:
                inside = node.fields.get(name)
                for child in inside if isinstance(inside, list) else [inside]:
                    if isinstance(child, ProtoNode):
                        self._visit(child, here, depth + 1)
        elif (other := at.proto_of(node.kind)) is not None:
            self._visit_proto(other, node.fields, at.turn, at.origin, depth + 1)
        else:
            self.left_out[node.kind] += 1

    def _add(self, shape: ProtoNode, at: _Place) -> None:
        geometry = shape.fields.get("geometry")
        if not isinstance(geometry, ProtoNode):
            return
        if geometry.kind in _NOT_DRAWN:
            self.left_out[geometry.kind] += 1
            return
        if geometry.kind == "Mesh":
            points, faces, _ = self._file(geometry, at)
        elif geometry.kind in _SOLIDS:
            points, faces = _SOLIDS[geometry.kind](geometry)
        else:
            raise ValueError(f"geometry {geometry.kind}; allowed: {', '.join(GEOMETRY)}")
        appearance = shape.fields.get("appearance")
        if isinstance(appearance, ProtoNode) and appearance.kind not in (
            "Appearance",
            "PBRAppearance",
        ):
            self.left_out[f"{appearance.kind} (a colour)"] += 1
        self._put(at, points, faces, np.tile(_colour(shape), (len(faces), 1)))

    def _put(self, at: _Place, points: Floats, faces: Faces, colours: Floats) -> None:
        if exact.dot(at.turn[0], np.cross(at.turn[1], at.turn[2])) < 0.0:
            faces = faces[:, ::-1]  # mirrored
        self._triangles += len(faces)
        if len(self.parts) >= _MOST_PARTS or self._triangles > _MOST_TRIANGLES:
            raise ValueError(f"more than {_MOST_PARTS} shapes or {_MOST_TRIANGLES} triangles")
        self.parts.append((exact.product(points, at.turn.T) + at.origin, faces, colours))

    def _file(self, node: ProtoNode, at: _Place) -> Part:
        url = node.fields.get("url")
        url = url[0] if isinstance(url, list) and url else url
        if not isinstance(url, str) or "://" in url:
            raise ValueError(f"{node.kind}: url {url!r:.200}; allowed: a file beside the PROTO")
        return self._mesh(at.path.parent / url)


def _vector(node: ProtoNode, name: str, default: Sequence[float]) -> Floats:
    value = node.fields.get(name)
    numbers = np.array(default if value is None else value, np.float64)
    if numbers.shape != (len(default),) or not np.isfinite(numbers).all():
        raise ValueError(f"{node.kind}.{name}: {len(default)} numbers expected")
    return numbers


def _number(node: ProtoNode, name: str, default: float) -> float:
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


def _colour(shape: ProtoNode) -> tuple[float, float, float]:
    appearance = shape.fields.get("appearance")
    if not isinstance(appearance, ProtoNode):
        return _PLAIN
    material = appearance.fields.get("material")
    given = appearance.fields.get("baseColor")
    if isinstance(material, ProtoNode):
        given = material.fields.get("diffuseColor", given)
    if given is None:
        return _PLAIN
    red, green, blue = np.clip(np.array(given, np.float64), 0.0, 1.0).tolist()
    return red, green, blue


def _box(node: ProtoNode) -> Solid:
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


def _cylinder(node: ProtoNode) -> Solid:
    radius, half = _number(node, "radius", 1.0), 0.5 * _number(node, "height", 2.0)
    return _turned([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])


def _cone(node: ProtoNode) -> Solid:
    radius, half = _number(node, "bottomRadius", 1.0), 0.5 * _number(node, "height", 2.0)
    return _turned([(0.0, -half), (radius, -half), (0.0, half)])


def _arc(radius: float, middle: float, first: float, last: float) -> list[tuple[float, float]]:
    """Return points of a circle between two heights above its middle, as angles [rad]."""
    angles = np.linspace(first, last, _ROUND // 2 + 1)
    return [(radius * max(exact.cos(a), 0.0), middle + radius * exact.sin(a)) for a in angles]


def _ended(profile: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(0.0, profile[0][1]), *profile[1:-1], (0.0, profile[-1][1])]


def _sphere(node: ProtoNode) -> Solid:
    quarter = 0.5 * math.pi
    return _turned(_ended(_arc(_number(node, "radius", 1.0), 0.0, -quarter, quarter)))


def _capsule(node: ProtoNode) -> Solid:
    radius, half = _number(node, "radius", 1.0), 0.5 * _number(node, "height", 2.0)
    quarter = 0.5 * math.pi
    low, high = _arc(radius, -half, -quarter, 0.0), _arc(radius, half, 0.0, quarter)
    return _turned(_ended([*low, *high]))


def _face_set(node: ProtoNode) -> Solid:
    """Return the triangles of polygons, cut like fans from their first corners."""
    coord = node.fields.get("coord")
    point = coord.fields.get("point") if isinstance(coord, ProtoNode) else None
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


_SOLIDS: dict[str, Callable[[ProtoNode], Solid]] = {
    "Box": _box,
    "Cylinder": _cylinder,
    "Cone": _cone,
    "Sphere": _sphere,
    "Capsule": _capsule,
    "IndexedFaceSet": _face_set,
}
