"""KITTI tracking: `<training|validation|testing>/{image_02, label_02, calib, poses, intrinsics}`.

A line of `label_02/<episode>.txt`: frame from 0, track, type, truncation (0 nothing, 1 up to half,
2 more), occlusion (the same), alpha, box (left, top, right, bottom, hidden parts included, inside
the picture), height, width, length, location (the bottom's middle in the camera's frame: right,
down, forward), rotation_y.

KITTI's car drives upright: `rotation_y` and `alpha` are angles about the camera's own vertical. A
drone looks down, so here they are about the world's vertical, as seen by a camera that looks in the
same direction without pitch and roll. What that takes away is in `poses/<episode>.txt`: twelve
numbers a frame, camera (right, down, forward) to world, as in KITTI's odometry. A camera that zooms
has a matrix for each frame in `intrinsics/<episode>.txt`; P2 is that of the first. A lens that
bends has its model and OpenCV's coefficients for each frame in `distortion/<episode>.txt`; boxes
are those of the bent picture.

Pixels are as in the labels of Eyas: the middle of the first one is at (0.5, 0.5).
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import wrap_angle
from eyas.engine.exports.boxes import box_of, camera_pose
from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import Exported, Format, SeenObject, by_split, lines, objects_of
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.state.scene import ObjectClass
from eyas.lanes import exact, interpreted

FOLDERS = {"train": "training", "val": "validation", "test": "testing"}

TYPES = {
    ObjectClass.CAR: "Car",
    ObjectClass.TRUCK: "Truck",
    ObjectClass.BUS: "Misc",
    ObjectClass.MOTORCYCLE: "Misc",
    ObjectClass.PERSON: "Pedestrian",
    ObjectClass.ROBOT: "Misc",
    ObjectClass.BICYCLE: "Cyclist",
    ObjectClass.BOAT: "Misc",
    ObjectClass.TRAIN: "Tram",
}
"""KITTI's types; it has none for buses, motorcycles, robots and boats, nor for bicycles without a
rider."""

Floats = NDArray[np.float64]

_wrapped = interpreted(wrap_angle)


class Kitti(Format):
    """KITTI tracking, as TrackEval reads it."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        folder, name = FOLDERS[episode.split or "train"], episode.name
        self.job.place_all(episode, f"{folder}/image_02/{name}", 0, 6)
        rows = [row for frame in episode for row in self._rows(frame.number, frame.label)]
        labels = episode.labels
        matrices = [_flat(label["intrinsics"]) for label in labels]
        self.job.write(f"{folder}/label_02/{name}.txt", lines(rows))
        self.job.write(f"{folder}/calib/{name}.txt", lines(_calibration(labels[0])))
        self.job.write(f"{folder}/poses/{name}.txt", lines(map(_pose, labels)))
        self.job.write(f"{folder}/intrinsics/{name}.txt", lines(matrices))
        if "distortion_model" in labels[0]:
            bends = (f"{row['distortion_model']} {_text(row['distortion'])}" for row in labels)
            self.job.write(f"{folder}/distortion/{name}.txt", lines(bends))

    def _rows(self, number: int, label: Label) -> Iterable[str]:
        position, camera = camera_pose(label)
        for seen in objects_of(label):
            if self.job.ignores(seen):
                box = _text(seen.label["box"])
                yield f"{number} -1 DontCare -1 -1 -10 {box} -1 -1 -1 -1000 -1000 -1000 -10"
            else:
                yield f"{number} {_row(seen, camera, position)}"

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the list of each split's sequences."""
        for split, group in by_split(episodes).items():
            folder = FOLDERS[split]
            rows = [f"{episode.name} empty 000000 {episode.frames:06d}" for episode in group]
            self.job.write(f"{folder}/evaluate_tracking.seqmap.{folder}", lines(rows))


def _row(seen: SeenObject, camera: Floats, position: Floats) -> str:
    label = seen.label
    box = box_of(label["corners"])
    foot = np.array(label["corners"][:4]).mean(axis=0)
    away = foot - position
    location = exact.product(away[None], camera)[0]
    heading = _heading(camera)
    turn = _wrapped(heading - _heading_of(box.rotation[:, 0]) - 0.5 * math.pi)
    bearing = heading - _heading_of(away)  # clockwise from straight ahead
    length, width, height = box.size
    return " ".join([
        f"{label['id']} {_type(label)}",
        f"{_truncation(label['truncated'])} {occlusion_level(label['visible_fraction'])}",
        _text([_wrapped(turn - bearing)]),
        _text(label["box"]),
        _text([height, width, length, *location, turn]),
    ])  # fmt: skip


def _type(label: Label) -> str:
    kind = ObjectClass(label["class_id"])
    # A cyclist rides.
    return "Misc" if kind is ObjectClass.BICYCLE and "parked" in label else TYPES[kind]


def _heading(camera: Floats) -> float:
    """Return in what direction a camera looks over the ground, counter-clockwise from east [rad].

    Its right axis is close to level however far down it looks.
    """
    return _heading_of(np.array([-camera[1, 0], camera[0, 0]]))


def _heading_of(direction: Floats) -> float:
    return float(exact.atan2(direction[1], direction[0]))


def _truncation(share: float) -> int:
    """Return KITTI's level of the share outside the picture."""
    return 0 if share <= 0.0 else 1 if share <= 0.5 else 2


def occlusion_level(visible: float) -> int:
    """Return how much of an object is hidden: 0 nothing, 1 up to half, 2 more."""
    return 0 if visible >= 1.0 else 1 if visible >= 0.5 else 2


def _calibration(label: Label) -> list[str]:
    """Return the matrices: all cameras are the one, lidar and inertial sensor are in it."""
    projection = [[*row, 0.0] for row in label["intrinsics"]]
    level = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]
    turned = [row[:3] for row in level]
    return [
        *(f"P{camera}: {_flat(projection)}" for camera in range(4)),
        f"R_rect {_flat(turned)}",
        f"Tr_velo_cam {_flat(level)}",
        f"Tr_imu_velo {_flat(level)}",
    ]


def _pose(label: Label) -> str:
    position, camera = camera_pose(label)
    return _flat(np.column_stack([camera, position]))


def _flat(matrix: Any) -> str:  # noqa: ANN401  # rows of numbers
    return _text(np.asarray(matrix, np.float64).ravel())


def _text(numbers: Iterable[float]) -> str:
    return " ".join(str(round(float(number), 6) + 0.0) for number in numbers)
