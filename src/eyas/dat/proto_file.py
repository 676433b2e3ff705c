"""Shapes in Webots' `.proto` files: plain geometry, at the places where its nodes put it."""

import math
import os
import re
from collections import Counter
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.dat.proto_parser import ProtoNode, parsed
from eyas.dat.proto_script import Limits
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom import solids
from eyas.engine.custom.lookup import found_file
from eyas.lanes import exact

GEOMETRY = ("Box", "Cylinder", "Sphere", "Cone", "Capsule", "IndexedFaceSet", "Mesh")
"""Geometry nodes that are read."""

_LARGEST_FILE = 64 << 20  # [bytes]
_MOST_PARTS, _MOST_TRIANGLES = 5000, 1_000_000
_MOST_READ = 64 << 20
"""Largest content of all PROTOs together, where one is read again for each node [bytes]."""
_LARGEST = 1e9  # Largest number of a shape [m]
_PLAIN = (0.62, 0.62, 0.62)  # sRGB of what has no colour
_INSIDE = (
    "children", "endPoint", "device", "value", "slowHelix", "fastHelix", "animatedGeometries",
)  # fmt: skip
"""Fields in which there may be shapes; not `boundingObject`, which is not drawn."""
_PLAIN_NODES = ("Appearance", "PBRAppearance", *GEOMETRY)  # Of shapes; others may be PROTOs
_COLOURS = ("diffuseColor", "baseColor", "colorOverride")  # Fields of appearances and materials
_Z_UP = 2022  # Year of the Webots from which on z is up, and the axis of what is round
_NODES = frozenset(
    "Accelerometer Altimeter BallJoint Billboard Brake Camera Charger Compass Connector "
    "DifferentialWheels Display DistanceSensor Emitter GPS Group Gyro Hinge2Joint "
    "Hinge2JointWithBacklash HingeJoint HingeJointWithBacklash InertialUnit LED Lidar "
    "LightSensor LinearMotor Microphone Muscle Pen PointLight Pose PositionSensor Propeller "
    "Radar RangeFinder Receiver Robot RotationalMotor Servo SliderJoint Slot Solid "
    "SolidReference Speaker SpotLight Supervisor TouchSensor Track TrackWheel Transform "
    "VacuumGripper".split()
)
"""Webots' own nodes that show nothing but what is inside them."""

Floats = NDArray[np.float64]
Faces = NDArray[np.int64]
Part = tuple[Floats, Faces, Floats]
"""Points [m], shape (V, 3), triangles, shape (T, 3), and sRGB of each, shape (T, 3)."""
Solid = solids.Solid


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
    left_out = _counted(walk.left_out)
    if not walk.parts:
        told = f" ({left_out})" if left_out else ""
        raise DataFileError(
            f"{path}: no geometry that can be read{told}; allowed: {', '.join(GEOMETRY)} in Shape "
            "nodes, and CadShape"
        )
    old = "made before Webots R2022a: if y is up in it, custom.up=y stands it upright"
    return walk.parts, "; ".join(filter(None, (left_out, old if walk.old else "")))


class _Place:
    """Where a node stands: the file it is in, and the frame of its parent.

    Args:
        externs: Addresses of the PROTOs that it names.
        turn: Axes of the frame as columns, perhaps scaled.
        origin: Origin of the frame [m].
        year: Of the Webots for which the file is made.
    """

    def __init__(
        self, path: Path, externs: dict[str, str], turn: Floats, origin: Floats, year: int = 0
    ) -> None:
        self.path, self._externs, self.year = path, externs, year
        self.turn, self.origin = turn, origin

    def inside(self, node: ProtoNode) -> "_Place":
        """Return the same in the frame of a node."""
        moved = exact.product(self.turn, _vector(node, "translation", (0.0, 0.0, 0.0)))
        turn = exact.product(self.turn, _rotation(node.fields.get("rotation")))
        turn = turn * _vector(node, "scale", (1.0, 1.0, 1.0))
        return _Place(self.path, self._externs, turn, self.origin + moved, self.year)

    def proto_of(self, kind: str) -> Path | None:
        """Return the file of another PROTO; None if it is not on this machine."""
        if not re.fullmatch(r"[\w.-]+", kind):
            return None
        named = found_file(self.path, self._externs.get(kind, f"{kind}.proto"))
        return named or _protos_in(self.path.parent).get(kind) or _library().get(kind)


def _library() -> dict[str, Path]:
    """Return the PROTOs that Webots brings, in the folder `WEBOTS_HOME`."""
    home = os.environ.get("WEBOTS_HOME")
    return _protos_in(Path(home, "projects"), 20_000) if home else {}


@lru_cache(maxsize=64)
def _protos_in(folder: Path, most: int = 200) -> dict[str, Path]:
    """Return the PROTOs in a folder and those inside it, as Webots before R2022b finds them."""
    found: dict[str, Path] = {}
    for where, folders, names in islice(os.walk(folder), most):
        folders.sort()
        for name in names:
            if name.endswith(".proto"):
                found.setdefault(name.removesuffix(".proto"), Path(where, name))
    return found


class _Walk:
    """Gathers the parts of a tree of nodes."""

    def __init__(self, mesh: Callable[[Path], Part]) -> None:
        self.parts: list[Part] = []
        self.left_out: Counter[str] = Counter()
        self._mesh = mesh
        self._triangles = self._visited = self._parsed = 0
        self._texts: dict[Path, str] = {}
        self._missing, self.old = 0, False
        self._limits = Limits()

    def read(self, path: Path) -> None:
        """Add what a file shows."""
        body, at = self._opened(path, {}, _Place(path, {}, np.eye(3), np.zeros(3)), 0)
        self.old = at.year < _Z_UP
        self._visit(body, at, 1)
        if self._missing > len(self.parts):
            raise ValueError("more than half of its meshes are missing: " + _counted(self.left_out))

    def _opened(
        self, path: Path, given: dict[str, object], at: _Place, depth: int
    ) -> tuple[ProtoNode, _Place]:
        """Return the node that a PROTO stands for, at a place: its `translation` is passed on."""
        if path not in self._texts:
            self._texts[path] = read_limited(path, _LARGEST_FILE).decode("utf-8", "replace")
        self._parsed += len(self._texts[path])
        if depth and self._parsed > _MOST_READ:
            raise ValueError("its PROTOs are too large together, or name each other without end")
        try:
            proto = parsed(self._texts[path], given, self._limits)
        except ValueError as error:
            raise ValueError(f"{path.name}: {error}" if depth else str(error)) from None
        return proto.body, _Place(path, proto.externs, at.turn, at.origin, proto.year)

    def _resolved(self, node: ProtoNode, at: _Place, depth: int) -> tuple[ProtoNode, _Place]:
        """Return a geometry or an appearance that may be a PROTO as what that stands for."""
        while depth <= 64 and node.kind not in _PLAIN_NODES:
            other = at.proto_of(node.kind)
            if other is None:
                break
            node, at = self._opened(other, node.fields, at, depth + 1)
            depth += 1
        return node, at

    def _visit(self, node: ProtoNode, at: _Place, depth: int) -> None:
        """Add what a node shows."""
        self._visited += 1
        if depth > 64 or self._visited > 20 * _MOST_PARTS:
            raise ValueError("nested too deep, or too many nodes")
        if node.kind == "Shape":
            self._add(node, at.inside(node), depth)
        elif node.kind == "CadShape":
            here = at.inside(node)
            if (part := self._file(node, here)) is not None:
                self._put(here, *part)
        elif node.kind not in _NODES and (other := at.proto_of(node.kind)) is not None:
            self._visit(*self._opened(other, node.fields, at, depth), depth + 1)
        else:
            if node.kind not in _NODES:  # what it holds may be shown all the same
                self.left_out[node.kind] += 1
            here = at.inside(node)
            for name in _INSIDE:
                inside = node.fields.get(name)
                for child in inside if isinstance(inside, list) else [inside]:
                    if isinstance(child, ProtoNode):
                        self._visit(child, here, depth + 1)

    def _add(self, shape: ProtoNode, at: _Place, depth: int) -> None:
        geometry = shape.fields.get("geometry")
        if not isinstance(geometry, ProtoNode):
            return
        geometry, here = self._resolved(geometry, at, depth)
        if geometry.kind == "Mesh":
            part = self._file(geometry, here)
            if part is None:
                return
            points, faces, _ = part
        elif geometry.kind in _SOLIDS:
            points, faces = _SOLIDS[geometry.kind](geometry)
            if here.year < _Z_UP and geometry.kind in ("Cylinder", "Cone", "Capsule"):
                points = points[:, [1, 2, 0]]  # their axis was y
        else:
            self.left_out[geometry.kind] += 1
            return
        appearance, colour = shape.fields.get("appearance"), _PLAIN
        if isinstance(appearance, ProtoNode):
            found = _colour(self._resolved(appearance, at, depth)[0])
            if found is None and appearance.kind not in _PLAIN_NODES:
                self.left_out[f"{appearance.kind} (a colour)"] += 1
            colour = found or _PLAIN
        self._put(at, points, faces, np.tile(colour, (len(faces), 1)))

    def _put(self, at: _Place, points: Floats, faces: Faces, colours: Floats) -> None:
        if exact.dot(at.turn[0], np.cross(at.turn[1], at.turn[2])) < 0.0:
            faces = faces[:, ::-1]  # mirrored
        self._triangles += len(faces)
        if len(self.parts) >= _MOST_PARTS or self._triangles > _MOST_TRIANGLES:
            raise ValueError(f"more than {_MOST_PARTS} shapes or {_MOST_TRIANGLES} triangles")
        self.parts.append((exact.product(points, at.turn.T) + at.origin, faces, colours))

    def _file(self, node: ProtoNode, at: _Place) -> Part | None:
        """Return the mesh that a node names; None, and it is counted, if it is not here."""
        url = node.fields.get("url")
        url = url[0] if isinstance(url, list) and url else url
        found = found_file(at.path, url) if isinstance(url, str) else None
        if found is not None:
            return self._mesh(found)
        self._missing += 1
        name = str(url).rpartition("/")[2]
        webots = "cyberbotics/webots/" in str(url) or str(url).startswith("webots://")
        why = ", see WEBOTS_HOME" if webots else ", on the web" if "http" in str(url)[:4] else ""
        self.left_out[f"{name:.60} (no such file{why})"] += 1
        return None


def _counted(left_out: Counter[str]) -> str:
    """Return what is left out in words."""
    counted = ", ".join(f"{count} {kind}" for kind, count in sorted(left_out.items()))
    return f"left out, as not read: {counted:.400}" if counted else ""


def _vector(node: ProtoNode, name: str, default: Sequence[float]) -> Floats:
    value = node.fields.get(name)
    numbers = np.array(default if value is None else value, np.float64)
    if numbers.shape != (len(default),) or not (np.abs(numbers) <= _LARGEST).all():
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


def _colour(appearance: ProtoNode) -> tuple[float, float, float] | None:
    """Return the sRGB of an appearance; None if it has none that is read."""
    material = appearance.fields.get("material")
    fields = appearance.fields | (material.fields if isinstance(material, ProtoNode) else {})
    given = next((fields[name] for name in _COLOURS if fields.get(name) is not None), None)
    if given is None:
        return None
    red, green, blue = np.clip(np.array(given, np.float64), 0.0, 1.0).tolist()
    return red, green, blue


def _face_set(node: ProtoNode) -> Solid:
    """Return the triangles of polygons, cut like fans from their first corners."""
    coord = node.fields.get("coord")
    point = coord.fields.get("point") if isinstance(coord, ProtoNode) else None
    points = np.array([] if point is None else point, np.float64).reshape(-1, 3)
    index = node.fields.get("coordIndex")
    corners = np.clip(np.array([] if index is None else index, np.float64), -1.0, 2.0**40)
    corners = corners.astype(np.int64)
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
    "Box": lambda node: solids.box(_vector(node, "size", (0.1, 0.1, 0.1))),
    "Cylinder": lambda node: solids.cylinder(*_round(node, "radius")),
    "Cone": lambda node: solids.cone(*_round(node, "bottomRadius")),
    "Sphere": lambda node: solids.sphere(_number(node, "radius", 1.0)),
    "Capsule": lambda node: solids.capsule(*_round(node, "radius")),
    "IndexedFaceSet": _face_set,
}


def _round(node: ProtoNode, radius: str) -> tuple[float, float]:
    return _number(node, radius, 1.0), _number(node, "height", 2.0)
