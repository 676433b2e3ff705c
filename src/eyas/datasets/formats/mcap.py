"""MCAP: `<split>/<episode>.mcap`, messages in JSON by Foxglove's schemas, and the labels whole.

https://mcap.dev, https://docs.foxglove.dev/docs/visualization/message-schemas. Times are simulated,
from the start of the episode.
"""

import base64
import json
from collections.abc import Iterable, Iterator
from typing import Any

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.files import atomic_path, read_limited, refusals
from eyas.engine.exports.boxes import box_of, camera_pose, quaternion_of
from eyas.engine.exports.label import label_schema
from eyas.engine.recordings.format import ExportJob, Format, SeenObject, objects_of, split_of
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame

Json = dict[str, Any]

TOPICS = {
    "/camera/image": "foxglove.CompressedImage",
    "/camera/calibration": "foxglove.CameraCalibration",
    "/camera/annotations": "foxglove.ImageAnnotations",
    "/tf": "foxglove.FrameTransforms",
    "/scene": "foxglove.SceneUpdate",
    "/label": "eyas.Label",
}
"""Topics and the names of their schemas."""

_TARGET, _OTHER = (1.0, 0.55, 0.0, 1.0), (0.35, 0.67, 1.0, 1.0)  # Colours of boxes
_LINE_LOOP = 2  # Foxglove's number of a closed line
_TIME = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}

_KEYS: dict[str, Json] = {
    "foxglove.CompressedImage": {
        "frame_id": {"type": "string"},
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": {"type": "string"},
    },
    "foxglove.CameraCalibration": {
        "frame_id": {"type": "string"},
        "width": {"type": "integer"},
        "height": {"type": "integer"},
        "distortion_model": {"type": "string"},
        **{name: {"type": "array", "items": {"type": "number"}} for name in "DKRP"},
    },
    "foxglove.ImageAnnotations": {
        name: {"type": "array", "items": {"type": "object"}}
        for name in ("circles", "points", "texts")
    },
    "foxglove.FrameTransforms": {"transforms": {"type": "array", "items": {"type": "object"}}},
    "foxglove.SceneUpdate": {
        name: {"type": "array", "items": {"type": "object"}} for name in ("deletions", "entities")
    },
}


class Mcap(Format):
    """One file an episode.

    Raises:
        MissingExtraError: The library `mcap` is not installed.
    """

    needs = frozenset({"jpeg", "labels"})

    def __init__(self, job: ExportJob) -> None:
        try:
            from mcap import writer
        except ImportError as error:
            raise MissingExtraError("the format 'mcap'", "exports") from error
        self.job, self._mcap = job, writer

    def add(self, episode: RecordedEpisode) -> None:
        """Write its file."""
        path = self.job.folder / split_of(episode) / f"{episode.name}.mcap"
        with refusals(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_path(path) as part, part.open("wb") as file:
            writer = self._mcap.Writer(file, compression=self._mcap.CompressionType.NONE)
            writer.start("", "eyas")
            channels = {
                topic: writer.register_channel(
                    topic, "json", writer.register_schema(schema, "jsonschema", _schema(schema))
                )
                for topic, schema in TOPICS.items()
            }
            for frame in episode:
                time = round(frame.label["episode_time"] * 1e9)
                for topic, message in _messages(frame, time):
                    content = json.dumps(message).encode()
                    writer.add_message(channels[topic], time, content, time, frame.number)
            writer.finish()


def _schema(name: str) -> bytes:
    if name == "eyas.Label":
        return json.dumps(label_schema()).encode()
    properties = {"timestamp": _TIME, **_KEYS[name]}
    return json.dumps({"title": name, "type": "object", "properties": properties}).encode()


def _messages(frame: RecordedFrame, time: int) -> Iterator[tuple[str, Json]]:
    """Yield the messages of a frame, with their topics."""
    label, seen = frame.label, list(objects_of(frame.label))
    stamp = {"sec": time // 10**9, "nsec": time % 10**9}
    seal = {"timestamp": stamp, "frame_id": "camera"}
    picture = read_limited(frame.episode.picture_file(frame.number), 1 << 28)
    data = base64.b64encode(picture).decode()
    yield "/camera/image", {**seal, "data": data, "format": frame.episode.picture_kind}
    yield "/camera/calibration", {**seal, **_calibration(label)}
    position, rotation = camera_pose(label)
    pose = {"translation": _vector(position), "rotation": _quaternion(quaternion_of(rotation))}
    frames = {"parent_frame_id": "world", "child_frame_id": "camera"}
    yield "/tf", {"transforms": [{"timestamp": stamp, **frames, **pose}]}
    lines = [_outline(each, stamp) for each in seen]
    yield "/camera/annotations", {"circles": [], "points": lines, "texts": []}
    cubes = [_cube(each) for each in seen]
    entity = {"timestamp": stamp, "frame_id": "world", "id": "boxes", "cubes": cubes}
    yield "/scene", {"deletions": [], "entities": [entity]}
    yield "/label", label


def _calibration(label: Json) -> Json:
    fisheye = label.get("distortion_model") == "fisheye"
    matrix = [value for row in label["intrinsics"] for value in row]
    projection = [value for row in label["intrinsics"] for value in (*row, 0.0)]
    return {
        "width": label["width"],
        "height": label["height"],
        "distortion_model": "kannala_brandt" if fisheye else "plumb_bob",
        "D": label["distortion"],
        "K": matrix,
        "R": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        "P": projection,
    }


def _outline(seen: SeenObject, stamp: Json) -> Json:
    left, top, right, bottom = seen.label["visible_box"]
    corners = ((left, top), (right, top), (right, bottom), (left, bottom))
    return {
        "timestamp": stamp,
        "type": _LINE_LOOP,
        "points": [{"x": x, "y": y} for x, y in corners],
        "outline_color": _colour(seen),
        "thickness": 1.0,
    }


def _cube(seen: SeenObject) -> Json:
    box = box_of(seen.label["corners"])
    pose = {
        "position": _vector(box.centre),
        "orientation": _quaternion(quaternion_of(box.rotation)),
    }
    return {"pose": pose, "size": _vector(box.size), "color": _colour(seen)}


def _colour(seen: SeenObject) -> Json:
    return dict(zip("rgba", _TARGET if seen.is_target else _OTHER, strict=True))


def _vector(values: Iterable[float]) -> Json:
    return dict(zip("xyz", map(float, values), strict=True))


def _quaternion(wxyz: tuple[float, float, float, float]) -> Json:
    return dict(zip("wxyz", wxyz, strict=True))
