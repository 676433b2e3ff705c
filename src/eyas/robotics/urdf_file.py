"""Robots in URDF files, the format of ROS, as shapes: what is visible of them, joints at rest.

Frames, units and defaults: wiki.ros.org/urdf/XML. Meshes stand as they are in their files whatever
axis those call up, as in RViz; COLLADA's unit counts.
"""

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.decoding import decoded_xml
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited
from eyas.engine.custom import solids
from eyas.engine.custom.lookup import found_file
from eyas.lanes import exact

_LARGEST_FILE = 16 << 20  # [bytes]
_MOST_VISUALS, _MOST_TRIANGLES, _DEEPEST = 2000, 1_000_000, 200
_LARGEST = 1e6  # Largest number, of metres or radians
_PLAIN = (0.62, 0.62, 0.62)  # sRGB of what has no colour

Floats = NDArray[np.float64]
Part = tuple[Floats, NDArray[np.int64], Floats]
"""Points [m], shape (V, 3), triangles, shape (T, 3), and sRGB of each, shape (T, 3)."""

Frame = tuple[Floats, Floats]
"""Axes as columns, shape (3, 3), and origin [m], shape (3)."""


def read_urdf(path: Path, mesh: Callable[[Path], Part]) -> tuple[list[Part], str]:
    """Return the parts of a robot, and a line about what of it was left out, or nothing.

    Args:
        mesh: Reads a mesh file.

    Raises:
        DataFileError: It cannot be read, or shows nothing: one line.
    """
    try:
        robot = decoded_xml(read_limited(path, _LARGEST_FILE))
        if robot.tag != "robot":
            raise ValueError(f"its content is <{robot.tag:.40}>, not <robot>")
        if any(
            "/xacro}" in str(each.tag) or "wiki/xacro" in str(each.tag) for each in robot.iter()
        ):
            raise ValueError("it is for xacro: write `xacro FILE > robot.urdf`, and use that")
        return _Robot(path, robot, mesh).parts()
    except (ValueError, OverflowError) as error:
        raise DataFileError(f"{path}: cannot read as a URDF: {error}") from None


class _Robot:
    """Gathers the parts of links."""

    def __init__(self, path: Path, robot: Element, mesh: Callable[[Path], Part]) -> None:
        self._path, self._mesh = path, mesh
        self._links = {one.get("name", ""): one for one in robot.findall("link")}
        self._colours = {
            one.get("name", ""): colour
            for one in robot.iter("material")
            if (colour := _colour_in(one)) is not None
        }
        self._joints: dict[str, list[Element]] = {}  # Those at which a link's children hang
        self._hanging = set[str]()
        for joint in robot.findall("joint"):
            if (child := _link_of(joint, "child")) in self._links:
                self._joints.setdefault(_link_of(joint, "parent"), []).append(joint)
                self._hanging.add(child)
        self._left_out: Counter[str] = Counter()
        self._missing = self._triangles = self._count = 0
        self._parts: list[Part] = []
        self._meshes: dict[Path, Part] = {}

    def parts(self) -> tuple[list[Part], str]:
        """Return all parts, and a line about what is left out."""
        rest = np.eye(3), np.zeros(3)
        for name in self._links:
            if name not in self._hanging:
                self._visit(name, rest, 0)
        counted = ", ".join(f"{n} {what}" for what, n in sorted(self._left_out.items()))
        left_out = f"left out, as not read: {counted:.400}" if counted else ""
        if self._missing > len(self._parts):
            raise ValueError(f"more than half of its meshes are missing: {left_out}")
        if not self._parts:
            raise ValueError(f"nothing of it is visible{f' ({left_out})' if left_out else ''}")
        return self._parts, left_out

    def _visit(self, name: str, at: Frame, depth: int) -> None:
        self._count += 1
        if depth > _DEEPEST or self._count > _MOST_VISUALS:
            raise ValueError("links nested too deep, or too many")
        for visual in self._links[name].findall("visual"):
            self._add(visual, _inside(at, visual))
        for joint in self._joints.get(name, ()):
            self._visit(_link_of(joint, "child"), _inside(at, joint), depth + 1)

    def _add(self, visual: Element, at: Frame) -> None:
        self._count += 1
        colour = self._colour(visual.find("material"))
        for shape in visual.find("geometry") or ():
            part = self._part(shape, colour)
            if part is None:
                continue
            points, faces, colours = part
            self._triangles += len(faces)
            if self._count > _MOST_VISUALS or self._triangles > _MOST_TRIANGLES:
                raise ValueError(f"more than {_MOST_VISUALS} shapes or {_MOST_TRIANGLES} triangles")
            points = exact.product(points, at[0].T) + at[1]
            self._parts.append((points, faces, colours))

    def _part(self, shape: Element, colour: tuple[float, ...] | None) -> Part | None:
        if shape.tag == "mesh":
            return self._file(shape, colour)
        if shape.tag not in _SOLIDS:
            self._left_out[str(shape.tag)[:40]] += 1
            return None
        make, names = _SOLIDS[shape.tag]
        sizes = [_numbers(shape, name, 3 if name == "size" else 1) for name in names]
        if min(size.min() for size in sizes) <= 0.0:
            self._left_out[f"{shape.tag} without a size"] += 1
            return None
        points, faces = make(*(size if len(size) > 1 else float(size[0]) for size in sizes))
        return points, faces, np.tile(colour or _PLAIN, (len(faces), 1))

    def _file(self, shape: Element, colour: tuple[float, ...] | None) -> Part | None:
        name = shape.get("filename", "")
        found = found_file(self._path, name)
        if found is None:
            self._missing += 1
            self._left_out[f"{name.rpartition('/')[2]:.60} (no such file)"] += 1
            return None
        if found not in self._meshes:
            self._meshes[found] = self._mesh(found)
        points, faces, colours = self._meshes[found]
        scale = _numbers(shape, "scale", 3, "1 1 1")
        if scale.prod() < 0.0:
            faces = faces[:, ::-1]  # mirrored
        if colour is not None and (colours == _PLAIN).all():  # its file has none
            colours = np.tile(colour, (len(faces), 1))
        return points * scale, faces, colours

    def _colour(self, material: Element | None) -> tuple[float, ...] | None:
        if material is None:
            return None
        own = _colour_in(material)
        return own if own is not None else self._colours.get(material.get("name", ""))


def _link_of(joint: Element, end: str) -> str:
    found = joint.find(end)
    return "" if found is None else found.get("link", "")


def _colour_in(material: Element) -> tuple[float, ...] | None:
    colour = material.find("color")
    if colour is None:
        return None
    return tuple(np.clip(_numbers(colour, "rgba", 4), 0.0, 1.0)[:3].tolist())


def _inside(at: Frame, element: Element) -> Frame:
    """Return the frame of an element's `origin`: fixed axes, roll, then pitch, then yaw."""
    origin = element.find("origin")
    if origin is None:
        return at
    turn, place = at
    angles = _numbers(origin, "rpy", 3, "0 0 0")
    (cr, cp, cy), (sr, sp, sy) = exact.cos(angles), exact.sin(angles)
    own = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    moved = exact.product(turn, _numbers(origin, "xyz", 3, "0 0 0"))
    return exact.product(turn, own), place + moved


def _numbers(element: Element, name: str, count: int, default: str = "") -> Floats:
    text = element.get(name, default)
    try:  # files with commas, or a number too many, are read by other programs, too
        values = np.array(text.replace(",", " ").split()[:count], np.float64)
    except ValueError:
        values = np.empty(0)
    if "$" in text:
        raise ValueError(
            f"{element.tag}.{name} is {text!r:.60}: write `xacro FILE > robot.urdf` first"
        )
    if len(values) != count or not (np.abs(values) <= _LARGEST).all():
        raise ValueError(f"{element.tag}.{name} is {text!r:.60}; allowed: {count} numbers")
    return values


_SOLIDS: dict[str, tuple[Callable[..., solids.Solid], tuple[str, ...]]] = {
    "box": (solids.box, ("size",)),
    "sphere": (solids.sphere, ("radius",)),
    "cylinder": (solids.cylinder, ("radius", "length")),
    "capsule": (solids.capsule, ("radius", "length")),
}
