"""Tables as nuScenes has them: `v1.0-<split>/*.json`, `samples/CAM_FRONT`, `maps`.

https://www.nuscenes.org/nuscenes#data-format. One scene an episode, every frame is a sample with
one picture. The ego is the drone; its camera hangs in a gimbal and so has a calibration of its own
in each frame. Quaternions are w, x, y, z, sizes width, length, height, a camera looks along z. An
instance is an object in one episode. There is no map: the file in `maps` is one blank pixel.
"""

import hashlib
import io
import json
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from PIL import Image

from eyas.engine.core.files import atomic_path
from eyas.engine.core.frames import rotate_back
from eyas.engine.exports.boxes import box_of, camera_pose, quaternion_of
from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import (
    Exported,
    Format,
    SeenObject,
    by_split,
    numbered,
    objects_of,
    picture_ending,
)
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame
from eyas.engine.state.scene import ObjectClass
from eyas.lanes import exact, interpreted

CATEGORIES = {
    ObjectClass.CAR: "vehicle.car",
    ObjectClass.TRUCK: "vehicle.truck",
    ObjectClass.BUS: "vehicle.bus.rigid",
    ObjectClass.MOTORCYCLE: "vehicle.motorcycle",
    ObjectClass.PERSON: "human.pedestrian.adult",
    ObjectClass.ROBOT: "robot",
    ObjectClass.BICYCLE: "vehicle.bicycle",
    ObjectClass.BOAT: "boat",
    ObjectClass.TRAIN: "train",
}
VISIBILITIES = {"1": "0-40", "2": "40-60", "3": "60-80", "4": "80-100"}
ATTRIBUTES = tuple(
    "vehicle.moving vehicle.stopped vehicle.parked pedestrian.moving pedestrian.standing".split()
)

MOVES = 0.2  # Speed from which something moves [m/s]
CHANNEL, MAP = "CAM_FRONT", "maps/blank.png"

PER_EPISODE = tuple(
    "log scene sample sample_data ego_pose calibrated_sensor instance sample_annotation".split()
)
"""Tables with rows of each episode."""

Row = dict[str, Any]
Tables = dict[str, list[Row]]

_rotate_back = interpreted(rotate_back)


class NuScenes(Format):
    """Tables as nuScenes has them, one version for each split."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Place its pictures, and keep its rows."""
        ending = picture_ending(episode)
        tables: Tables = {name: [] for name in PER_EPISODE}
        name, own = episode.name, _Tokens(episode.name)
        count = len(episode)
        for frame in episode:
            inside = f"samples/{CHANNEL}/{name}__{numbered(frame, 0, 6, ending)}"
            self.job.place(episode.picture_file(frame.number), inside)
            _add_frame(tables, own, frame, inside, count)
            for seen in objects_of(frame.label):
                if not self.job.ignores(seen):
                    tables["sample_annotation"].append(_annotation(own, frame, seen))
        tables["instance"] = _instances(own, tables["sample_annotation"])
        _add_scene(tables, own, episode)
        self.job.keep(episode, tables)

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the tables of each split."""
        self.job.write(MAP, _blank())
        for split, group in by_split(episodes).items():
            folder = f"v1.0-{split}"
            for table, rows in _constant_tables(group).items():
                self.job.write(f"{folder}/{table}.json", json.dumps(rows, indent=0) + "\n")
            for table in PER_EPISODE:
                self._write(f"{folder}/{table}.json", self._rows(group, table))

    def _rows(self, group: Sequence[Exported], table: str) -> Iterator[Row]:
        for episode in group:
            yield from self.job.kept(episode.name)[table]

    def _write(self, inside: str, rows: Iterator[Row]) -> None:
        """Write a table, with the rows of one episode in memory at a time."""
        with atomic_path(self.job.folder / inside) as part, part.open("w") as file:
            between = "[\n"
            for row in rows:
                file.write(between + json.dumps(row))
                between = ",\n"
            file.write("\n]\n" if between == ",\n" else "[]\n")


class _Tokens:
    """Makes the tokens of an episode's rows: 32 hexadecimal digits of what they stand for."""

    def __init__(self, episode: str) -> None:
        self._episode = episode

    def __call__(self, *what: object) -> str:
        return _token(self._episode, *what)

    def of_frame(self, table: str, number: int, count: int) -> str:
        """Return the token of the row of a frame; empty if there is no such frame."""
        return self(table, number) if 0 <= number < count else ""


def _token(*what: object) -> str:
    return hashlib.sha256("/".join(map(str, what)).encode()).hexdigest()[:32]


def _add_frame(tables: Tables, own: _Tokens, frame: RecordedFrame, inside: str, count: int) -> None:
    """Add the rows of a frame: sample, picture, pose and calibration."""
    number, label = frame.number, frame.label
    timestamp = round(1e6 * label["time"])
    body, (position, camera) = label["tracker_orientation"], camera_pose(label)
    offset = position - np.array(label["tracker_position"])
    from_body = np.stack([_rotate_back(body, *axis) for axis in camera.T], axis=1)
    neighbours: dict[str, Row] = {"sample": {}, "sample_data": {}}
    for table, row in neighbours.items():
        row["prev"] = own.of_frame(table, number - 1, count)
        row["next"] = own.of_frame(table, number + 1, count)
    tables["sample"].append({
        "token": own("sample", number), "timestamp": timestamp, **neighbours["sample"],
        "scene_token": own("scene"),
    })  # fmt: skip
    tables["sample_data"].append({
        "token": own("sample_data", number), "sample_token": own("sample", number),
        "ego_pose_token": own("ego_pose", number),
        "calibrated_sensor_token": own("calibrated_sensor", number),
        "timestamp": timestamp, "fileformat": inside.rpartition(".")[2], "is_key_frame": True,
        "height": label["height"], "width": label["width"], "filename": inside,
        **neighbours["sample_data"],
    })  # fmt: skip
    tables["ego_pose"].append({
        "token": own("ego_pose", number), "timestamp": timestamp, "rotation": body,
        "translation": label["tracker_position"],
    })  # fmt: skip
    tables["calibrated_sensor"].append({
        "token": own("calibrated_sensor", number), "sensor_token": _token("sensor"),
        "translation": _rounded(_rotate_back(body, *offset)),
        "rotation": _rounded(quaternion_of(from_body)), "camera_intrinsic": label["intrinsics"],
        # As nuImages has it, whose calibrations know distortion.
        **({"camera_distortion": label["distortion"]} if "distortion_model" in label else {}),
    })  # fmt: skip


def _annotation(own: _Tokens, frame: RecordedFrame, seen: SeenObject) -> Row:
    label = seen.label
    box = box_of(label["corners"])
    length, width, height = box.size
    return {
        "token": own("annotation", frame.number, label["id"]),
        "sample_token": own("sample", frame.number),
        "instance_token": own("instance", label["id"]),
        "visibility_token": str(1 + sum(label["visible_fraction"] > at for at in (0.4, 0.6, 0.8))),
        "attribute_tokens": [_token(name) for name in _attributes(label)],
        "translation": _rounded(box.centre),
        "size": _rounded([width, length, height]),
        "rotation": _rounded(quaternion_of(box.rotation)),
        "prev": "",
        "next": "",
        "num_lidar_pts": 0,
        "num_radar_pts": 0,
        # Read once more by `_instances`, which takes it out.
        "class": label["class_id"],
    }


def _attributes(label: Label) -> list[str]:
    moves = exact.length(label["velocity"]) >= MOVES
    kind = CATEGORIES[ObjectClass(label["class_id"])].partition(".")[0]
    if kind == "vehicle":
        if "parked" in label:
            return ["vehicle.parked"]
        return ["vehicle.moving" if moves else "vehicle.stopped"]
    if kind == "human":
        return ["pedestrian.moving" if moves else "pedestrian.standing"]
    return []


def _instances(own: _Tokens, annotations: list[Row]) -> list[Row]:
    """Chain the annotations of each object, and return the instances."""
    chains: dict[str, list[Row]] = {}
    for row in annotations:
        chains.setdefault(row["instance_token"], []).append(row)
    instances = []
    for token, chain in chains.items():
        for before, after in pairwise(chain):
            before["next"], after["prev"] = after["token"], before["token"]
        classes = {row.pop("class") for row in chain}
        instances.append({
            "token": token, "category_token": _token(CATEGORIES[ObjectClass(classes.pop())]),
            "nbr_annotations": len(chain), "first_annotation_token": chain[0]["token"],
            "last_annotation_token": chain[-1]["token"],
        })  # fmt: skip
    return instances


def _add_scene(tables: Tables, own: _Tokens, episode: RecordedEpisode) -> None:
    samples = tables["sample"]
    world = episode.config.world
    tables["log"].append({
        "token": own("log"), "logfile": episode.name, "vehicle": episode.tracker,
        "date_captured": "1970-01-01", "location": world.map,
    })  # fmt: skip
    tables["scene"].append({
        "token": own("scene"), "log_token": own("log"), "nbr_samples": len(samples),
        "first_sample_token": samples[0]["token"], "last_sample_token": samples[-1]["token"],
        "name": episode.name, "description": f"{world.map}, {world.weather}: "
        f"{episode.labels[0]['target_words']}",
    })  # fmt: skip


def _constant_tables(group: Sequence[Exported]) -> Tables:
    logs = [_Tokens(episode.name)("log") for episode in group]
    return {
        "category": [
            {"token": _token(name), "name": name, "description": ""}
            for name in CATEGORIES.values()
        ],
        "attribute": [
            {"token": _token(name), "name": name, "description": ""} for name in ATTRIBUTES
        ],
        "visibility": [
            {"token": token, "level": f"v{share}", "description": f"{share} % are visible"}
            for token, share in VISIBILITIES.items()
        ],
        "sensor": [{"token": _token("sensor"), "channel": CHANNEL, "modality": "camera"}],
        "map": [
            {"token": _token("map"), "log_tokens": logs, "category": "semantic_prior",
             "filename": MAP}
        ],
    }  # fmt: skip


def _blank() -> bytes:
    file = io.BytesIO()
    Image.new("L", (1, 1)).save(file, "png")
    return file.getvalue()


def _rounded(numbers: Any) -> list[float]:  # noqa: ANN401  # an array, or a sequence
    return [round(float(number), 6) + 0.0 for number in numbers]
