"""A flight as one animated glTF file: the map, the tracker, its camera, and all that moves."""

import struct
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.decoding import decoded_json
from eyas.engine.exports.boxes import quaternion_of
from eyas.engine.exports.frame import CameraPose, Frame, Subject
from eyas.engine.exports.writer import Episode, Files, Gather, Run, Summary, Writer
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.world.maps import MAPS
from eyas.lanes import exact
from eyas.maps.exports.gltf.boxes import box_mesh
from eyas.maps.exports.gltf.file import GltfFile
from eyas.maps.exports.gltf.movers import mover_mesh, pose_of
from eyas.maps.exports.gltf.world import add_world

__all__ = ["SceneWriter"]

NAME = "scene.glb"
_FRAMES = "eyas_frames"
_DETAIL = 9  # The coarsest trees
_BODY = (0.8, 0.8, 0.35)  # Length, width and height of the box that stands for the tracker [m]
_NEAR = 0.05  # [m]
_LONGEST = 1 << 28  # Of the part of a file that tells what is in it [bytes]

Floats = NDArray[np.float64]


class _Pose(NamedTuple):
    place: tuple[float, ...]
    turn: tuple[float, ...]  # Quaternion x, y, z, w


class _Mover(NamedTuple):
    """A moving object in a frame."""

    subject: Subject
    colour: tuple[float, ...]  # Of its body, sRGB
    pose: _Pose


class _Moment(NamedTuple):
    """What a frame tells."""

    time: float  # Since the reset [s]
    camera: CameraPose
    tracker: _Pose
    target: int
    movers: dict[int, _Mover]


class SceneWriter(Writer):
    """`scene.glb`: the map with the flight as an animation.

    Args:
        run: The recording.
    """

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
    """Return the pose of a camera as glTF has it, right, up and back, and its vertical field of
    view [rad].
    """
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
