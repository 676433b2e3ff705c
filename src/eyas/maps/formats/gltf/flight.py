"""A flight as one animated glTF file: the map, the tracker, its camera, and all that moves."""

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.decoding import decoded_json
from eyas.engine.exports.boxes import box_of, quaternion_of
from eyas.engine.exports.frame import CameraPose, Frame, Subject
from eyas.engine.exports.resting import painted, resting_mesh
from eyas.engine.exports.writer import Episode, Files, Gather, Run, Summary, Writer
from eyas.engine.mesh.assembly import transformed
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.world.maps import MAPS
from eyas.lanes import exact
from eyas.maps.formats.gltf.file import GltfFile
from eyas.maps.formats.gltf.world import add_world

_TINTS = {
    ObjectClass.CAR: (0.85, 0.25, 0.2),
    ObjectClass.TRUCK: (0.9, 0.6, 0.2),
    ObjectClass.BUS: (0.95, 0.85, 0.25),
    ObjectClass.MOTORCYCLE: (0.7, 0.3, 0.7),
    ObjectClass.PERSON: (0.25, 0.6, 0.9),
    ObjectClass.ROBOT: (0.3, 0.8, 0.5),
    ObjectClass.BICYCLE: (0.5, 0.8, 0.9),
}
"""Colour of each class, sRGB."""

_SIDES = np.array([(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)])


def box_mesh(
    size: tuple[float, float, float],  # Length, width, height [m]
    kind: ObjectClass,
) -> Mesh:
    """Return a box about the origin, length along x, width along y, in the colour of a class."""
    positions, normals = [], []
    for axis, sign in _SIDES.tolist():
        normal = np.zeros(3)
        normal[int(axis)] = sign
        first, second = (np.eye(3)[(int(axis) + step) % 3] for step in (1, 2))
        second = second * sign  # counter-clockwise from outside
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            positions.append(0.5 * (normal + a * first + b * second) * size)
            normals.append(normal)
    faces = np.arange(24).reshape(6, 4)
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    return Mesh(
        positions=np.array(positions, np.float32),
        normals=np.array(normals, np.float32),
        uvs=np.zeros((24, 2), np.float32),
        triangles=triangles.astype(np.int32),
        materials=np.zeros(12, np.int32),
        palette=(Material(tint=_TINTS.get(kind, (0.6, 0.6, 0.6))),),
    )


_MOVER_DETAIL = 1

Floats = NDArray[np.float64]


def pose_of(subject: Subject) -> tuple[Floats, Floats]:
    """Return where the point on the ground below the reference point is [m], shape (3,), and the
    axes of a moving object, columns forward, left and up, shape (3, 3).
    """
    motion = subject.motion
    slope = 0.0 if motion.upright else motion.slope
    c, s = float(exact.cos(subject.yaw)), float(exact.sin(subject.yaw))
    cp, sp = float(exact.cos(slope)), float(exact.sin(slope))
    axes = np.array([[c * cp, -s, -c * sp], [s * cp, c, -s * sp], [sp, 0.0, cp]])
    return subject.position - motion.rise * np.array([0.0, 0.0, 1.0]), axes


def mover_mesh(
    subject: Subject,
    colour: tuple[float, ...],  # Of its body, sRGB
) -> Mesh:
    """Return the mesh of a moving object in the frame of `pose_of`; its limbs and wheels rest."""
    if any(model.name == subject.type for model in MODELS):
        return painted(resting_mesh(subject.type, _MOVER_DETAIL), colour)
    place, axes = pose_of(subject)
    box = box_of(subject.corners)
    length, width, height = subject.size.tolist()
    middle = exact.product(box.centre - place, axes)
    pose = np.column_stack([np.eye(3), middle])
    return transformed(box_mesh((length, width, height), subject.object_class), pose)


NAME = "scene.glb"
_FRAMES = "eyas_frames"
_DETAIL = 9  # The coarsest trees
_BODY = (0.8, 0.8, 0.35)  # Length, width and height of the box that stands for the tracker [m]
_NEAR = 0.05  # [m]
_LONGEST = 1 << 28  # Largest JSON chunk of a file that is read [bytes]


class _Pose(NamedTuple):
    place: tuple[float, ...]
    turn: tuple[float, ...]  # Quaternion x, y, z, w


class _Mover(NamedTuple):
    """A moving object in a frame."""

    subject: Subject
    colour: tuple[float, ...]  # Colour of the body, sRGB
    pose: _Pose


class _Moment(NamedTuple):
    """What a frame tells."""

    time: float  # Since the reset [s]
    camera: CameraPose
    tracker: _Pose
    target: int
    movers: dict[int, _Mover]


class SceneWriter(Writer):
    """`scene.glb`: the map with the flight as an animation."""

    wants = frozenset({"others", "traffic"})
    files = Files(episode=(NAME,))

    def __init__(self, run: Run) -> None:
        self._world = run.config.world

    def begin(self, episode: Episode) -> Gather[_Moment]:
        """Return the writer of an episode's scene."""
        return Gather(episode.folder / NAME, _moment, self._encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of frames that the file states."""
        try:
            with (folder / NAME).open("rb") as file:
                _, _, whole, length, _ = struct.unpack("<IIIII", file.read(20))
                told = decoded_json(file.read(min(length, _LONGEST)))
                if whole != (folder / NAME).stat().st_size:
                    return None
            return Summary(int(told["asset"]["extras"][_FRAMES]))
        except (OSError, ValueError, OverflowError, struct.error, KeyError, TypeError):
            return None

    def _encoded(self, moments: Sequence[_Moment]) -> bytes:
        world = self._world
        recipe = MAPS.get(world.map)
        scene = load_scene(world.map, world.seed, recipe.season(world.weather))
        file = GltfFile(scene.name, load_textures(), recipe.attribution())
        file.extras = {_FRAMES: len(moments)}
        add_world(file, scene, _DETAIL)
        flight = _Flight(file, moments)
        flight.add_tracker()
        flight.add_movers()
        return file.encoded()


def _moment(frame: Frame) -> _Moment:
    w, x, y, z = frame.tracker.orientation.tolist()
    body = _Pose(tuple(frame.tracker.position.tolist()), (x, y, z, w))
    moving = (each for each in (frame.target, *frame.others) if not each.parked)
    movers = {each.object_id: _mover(each, frame) for each in moving}
    target = frame.target.object_id
    return _Moment(frame.episode_time, frame.camera, body, target, movers)


def _mover(subject: Subject, frame: Frame) -> _Mover:
    assert frame.traffic is not None  # as it is wanted
    colour = frame.traffic.colour[subject.object_id - ACTOR_OBJECT].tolist()
    place, axes = pose_of(subject)
    rounded = tuple(round(part, 4) for part in colour)
    return _Mover(subject, rounded, _Pose(tuple(place.tolist()), _turn(axes)))


def _turn(rotation: Floats) -> tuple[float, ...]:
    w, x, y, z = quaternion_of(rotation)
    return x, y, z, w


def _lens(camera: CameraPose) -> tuple[_Pose, float]:
    """Return a camera's pose as glTF has it, and its vertical field of view [rad]."""
    forward, left, up = camera.rotation.T
    turn = _turn(np.column_stack([-left, up, -forward]))
    slope = 0.5 * camera.height / float(camera.intrinsics[1, 1])
    return _Pose(tuple(camera.position.tolist()), turn), 2.0 * float(exact.atan(slope))


class _Flight:
    """The animation of a file."""

    def __init__(self, file: GltfFile, moments: Sequence[_Moment]) -> None:
        self._file, self._moments = file, moments
        self._times = file.keys(np.array([[each.time] for each in moments]), "SCALAR")

    def add_tracker(self) -> None:
        """Add the tracker's body, and its camera, which has the field of view of the first
        frame.
        """
        first = self._moments[0].camera
        views = [_lens(each.camera) for each in self._moments]
        perspective = {"aspectRatio": first.width / first.height, "yfov": views[0][1]}
        camera = self._file.camera({**perspective, "znear": _NEAR})
        self._move("camera", {"camera": camera}, [pose for pose, _ in views])
        mesh = self._file.mesh(box_mesh(_BODY, ObjectClass.ROBOT), "tracker")
        self._move("tracker", {"mesh": mesh}, [each.tracker for each in self._moments])

    def add_movers(self) -> None:
        """Add all that moves; what is not seen in a frame has no size in it."""
        shapes: dict[tuple[str, tuple[float, ...]], int] = {}
        for number in sorted({number for each in self._moments for number in each.movers}):
            found = [each.movers.get(number) for each in self._moments]
            first = next(each for each in found if each is not None)
            looks = first.subject.type, first.colour
            if looks not in shapes:
                mesh = mover_mesh(first.subject, first.colour)
                shapes[looks] = self._file.mesh(mesh, first.subject.type)
            poses, last = [], first.pose
            for each in found:
                last = last if each is None else each.pose
                poses.append(last)
            is_target = number == self._moments[0].target
            kind = first.subject.object_class.name.lower()
            name = f"target-{number}" if is_target else f"{kind}-{number}"
            extras = {"class": kind, "type": first.subject.type}
            node = self._move(name, {"mesh": shapes[looks], "extras": extras}, poses)
            seen = np.array([[float(each is not None)] * 3 for each in found])
            if not seen.all():
                self._file.animate(
                    node, "scale", self._times, self._file.keys(seen, "VEC3"), "STEP"
                )

    def _move(self, name: str, what: dict[str, object], poses: Sequence[_Pose]) -> int:
        """Add a node that moves; return its index."""
        first = poses[0]
        pose = {"translation": list(first.place), "rotation": list(first.turn)}
        node = self._file.node({"name": name, **what, **pose})
        places = self._file.keys(np.array([pose.place for pose in poses]), "VEC3")
        turns = self._file.keys(_continuous(np.array([pose.turn for pose in poses])), "VEC4")
        self._file.animate(node, "translation", self._times, places)
        self._file.animate(node, "rotation", self._times, turns)
        return node


def _continuous(turns: Floats) -> Floats:
    """Return quaternions, shape (K, 4), each with the sign that is nearer to the last one."""
    agrees = (turns[1:] * turns[:-1]).sum(axis=1) >= 0.0
    signs = np.concatenate([[1.0], np.where(agrees, 1.0, -1.0)])
    result: Floats = turns * np.cumprod(signs)[:, None]
    return result
