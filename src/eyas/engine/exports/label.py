"""The label of a frame: what `labels.jsonl` says of it.

`FIELDS` is the one table of all fields. The records of target and others, the JSON schema and the
table of docs/labels.md (`python tools/write_docs.py`) are made of it: a new field is one row.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic_core import SchemaValidator

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.frames import rotate_back
from eyas.engine.exports.frame import Frame, Subject
from eyas.engine.exports.label_reading import labels_in, reader_of
from eyas.engine.exports.writer import Episode, Files, Gather, Scores, Summary, Writer
from eyas.engine.state.motion import Lamp
from eyas.engine.state.scene import LABELLED
from eyas.engine.task.done import DoneReason
from eyas.lanes import interpreted

DECIMALS = 6  # Decimals of every number (micrometres, microradians); few enough for identical bytes


def rounded(value: float) -> float | None:
    """Return a number with fixed decimals, without a negative zero; None if it is not finite."""
    return round(float(value), DECIMALS) + 0.0 if math.isfinite(value) else None


def rounded_list(values: ArrayLike) -> list[float | None]:
    """Return `rounded` of each value, shape (K,)."""
    return [rounded(value) for value in np.asarray(values, np.float64).tolist()]


Label = dict[str, Any]  # The label of a frame, as JSON has it; numbers that are not finite are None

_PER_SECOND = np.array([1.0, 1.0, 1.0 / PHYSICS_STEP, 1.0])
"""Commands climb by metres in each physics step; labels tell metres per second."""

_rotate_back = interpreted(rotate_back)


class Type(NamedTuple):
    """The type of a field."""

    name: str
    schema: Mapping[str, Any]  # JSON schema


def _array(name: str, of: Mapping[str, Any], count: int) -> Type:
    return Type(name, {"type": "array", "items": of, "minItems": count, "maxItems": count})


_LARGEST = 1e12  # More than any honest number; its square is still finite in float32
WHOLE = Type("whole number", {"type": "integer", "minimum": -1, "maximum": 2**31 - 1})
NUMBER = Type("number", {"type": "number", "minimum": -_LARGEST, "maximum": _LARGEST})
REWARD = Type("number, or null", {**NUMBER.schema, "type": ["number", "null"]})
SHARE = Type("number", {"type": "number", "minimum": 0.0, "maximum": 1.0})
TRUTH = Type("true or false", {"type": "boolean"})
TEXT = Type("text", {"type": "string", "pattern": r"^[^\x00-\x1f\x7f]*$"})
ID = Type("whole number", {"type": "integer", "minimum": 1, "maximum": 2**31 - 1})
CLASS = Type("whole number", {"type": "integer", "enum": sorted(map(int, LABELLED))})
SIDE = Type("whole number", {"type": "integer", "minimum": 1, "maximum": 2**16})
BOX = _array("4 whole numbers", {"type": "integer", "minimum": 0, "maximum": 2**16}, 4)
EXTENT = _array("4 numbers", NUMBER.schema, 4)
VECTOR = _array("3 numbers", NUMBER.schema, 3)
MATRIX = _array("3 rows of 3 numbers", VECTOR.schema, 3)
COEFFICIENTS = Type(
    "4 or 5 numbers", {"type": "array", "items": NUMBER.schema, "minItems": 4, "maxItems": 5}
)
SIGNALS = Type(
    "lists of numbers by name",
    {"type": "object", "additionalProperties": {"type": "array", "items": NUMBER.schema}},
)
PAIR = _array("2 numbers", NUMBER.schema, 2)
COMMAND = Type("4 numbers, or null", {**EXTENT.schema, "type": ["array", "null"]})
CORNERS = _array("8 points", VECTOR.schema, 8)
SECTIONS = Type(
    "list of `name`, `size`, `yaw`, `corners`",
    {
        "type": "array",
        "items": {
            "type": "object",
            "properties": {
                "name": TEXT.schema,
                "size": VECTOR.schema,
                "yaw": NUMBER.schema,
                "corners": CORNERS.schema,
            },
            "required": ["name", "size", "yaw", "corners"],
            "additionalProperties": False,
        },
    },
)


class LabelField(NamedTuple):
    """A field of the labels: of the frame, or of moving objects, of which the target is one.

    One that is of moving objects stands in the label of the frame for the target, and in each entry
    of `others` for the others.
    """

    key: str | None  # Name in the label of a frame; None: the target has none
    type: Type
    meaning: str
    of_frame: Callable[[Frame, Episode], Any] | None = None
    """Returns its value, if it is of the frame."""
    of_object: Callable[[Frame, Subject], Any] | None = None
    """Returns its value, if it is of moving objects."""
    others: str | None = None  # Name in an entry of `others`; None: these have none
    unit: str = ""
    frame: str = ""  # The frame of reference
    left_out: bool = False  # Whether a label has it only where it is not empty
    later: bool = False  # Whether recordings of earlier versions lack it


def _points(corners: Any) -> list[list[float | None]]:  # noqa: ANN401  # an array, or None
    return [] if corners is None else [rounded_list(corner) for corner in corners]


def _sections(subject: Subject) -> list[dict[str, Any]]:
    return [
        {
            "name": box.name,
            "size": [rounded(side) for side in box.size],
            "yaw": rounded(box.yaw),
            "corners": _points(box.corners),
        }
        for box in subject.section_boxes
    ]


def _relative(frame: Frame, subject: Subject) -> list[float | None]:
    tracker = frame.tracker
    return rounded_list(_rotate_back(tracker.orientation, *(subject.centre - tracker.position)))


def _distance(frame: Frame, subject: Subject) -> float | None:
    x, y, z = (subject.centre - frame.camera.position).tolist()
    return rounded(math.sqrt(x * x + y * y + z * z))


def _indicator(frame: Frame, subject: Subject) -> str:
    if subject.lamps & Lamp.LEFT:
        return "left"
    return "right" if subject.lamps & Lamp.RIGHT else ""


def _command(frame: Frame, episode: Episode) -> list[float | None] | None:
    command = frame.action.command
    return None if command is None else rounded_list(command * _PER_SECOND)


def _turn(frame: Frame, episode: Episode) -> list[float | None] | None:
    rates = frame.action.gimbal_rates
    return None if rates is None else rounded_list(rates)


FIELDS = (
    LabelField("frame", WHOLE, "Number of the frame in its episode, from 0; its picture is "
               "`NNNNNN.jpeg`.", lambda f, e: f.number),
    LabelField("time", NUMBER, "Simulated time since the start of the run.",
               lambda f, e: round(f.time, 6), unit="s"),
    LabelField("step", WHOLE, "Steps of 2 ms since the reset.", lambda f, e: f.step),
    LabelField("episode_time", NUMBER, "Simulated time since the reset.",
               lambda f, e: round(f.episode_time, 6), unit="s"),
    LabelField("target_box", BOX, "Extent in the picture, hidden parts included, clipped to the "
               "picture: left, top, right, bottom, the last two exclusive; all 0 outside the "
               "picture.", None, lambda f, s: s.box.tolist(), "box", unit="pixels"),
    LabelField("visible_fraction", SHARE, "Visible pixels over those that it would cover if "
               "nothing hid it, 0 to 1.", None, lambda f, s: round(s.visible_fraction, 6),
               "visible_fraction"),
    LabelField("occluded", TRUTH, "Whether a part inside the picture is hidden.", None,
               lambda f, s: s.seen_pixels < s.covered_pixels),
    LabelField("in_view", TRUTH, "Whether a part, visible or hidden, is inside the picture.", None,
               lambda f, s: s.covered_pixels > 0),
    LabelField("tracker_position", VECTOR, "Centre of the tracker's body.",
               lambda f, e: rounded_list(f.tracker.position), unit="m", frame="world"),
    LabelField("tracker_velocity", VECTOR, "Velocity of the tracker.",
               lambda f, e: rounded_list(f.tracker.velocity), unit="m/s", frame="world"),
    LabelField("tracker_orientation", EXTENT, "Body to world, quaternion w, x, y, z.",
               lambda f, e: rounded_list(f.tracker.orientation), frame="body to world"),
    LabelField("camera_position", VECTOR, "Optical centre of the camera.",
               lambda f, e: rounded_list(f.camera.position), unit="m", frame="world"),
    LabelField("camera_rotation", MATRIX, "Camera to world; columns are the camera's forward, left "
               "and up axes.", lambda f, e: _points(f.camera.rotation), frame="camera to world"),
    LabelField("field_of_view", NUMBER, "Horizontal field of view of the camera; with "
               "a lens that bends, that of a pinhole with the same focal length.",
               lambda f, e: rounded(f.camera.field_of_view), unit="rad"),
    LabelField("target_id", ID, "Its number in the id pictures; the same in all frames of an "
               "episode.", None, lambda f, s: s.object_id, "id"),
    LabelField("target_type", TEXT, "Name of its model.", None, lambda f, s: s.type, "type"),
    LabelField("target_size", VECTOR, "Length, width, height.", None,
               lambda f, s: rounded_list(s.size), "size", unit="m"),
    LabelField("target_position", VECTOR, "Its reference point on the road.", None,
               lambda f, s: rounded_list(s.position), unit="m", frame="world"),
    LabelField("target_centre", VECTOR, "Middle of its visible body, the point that is rewarded.",
               None, lambda f, s: rounded_list(s.centre), "centre", unit="m", frame="world"),
    LabelField("target_velocity", VECTOR, "Its velocity.", None,
               lambda f, s: rounded_list(s.velocity), "velocity", unit="m/s", frame="world"),
    LabelField("target_yaw", NUMBER, "Its heading, counter-clockwise from east.", None,
               lambda f, s: rounded(s.yaw), "yaw", unit="rad", frame="world"),
    LabelField("relative_position", VECTOR, "Its centre, seen from the tracker: forward, left, up.",
               None, _relative, unit="m", frame="tracker's body"),
    LabelField("reward", REWARD, "Reward at this time.", lambda f, e: rounded(f.reward)),
    LabelField("action", WHOLE, "Number of the action if it is one of several, 0 to 5 for a "
               "random one; else -1.", lambda f, e: f.action.number),
    LabelField("direction", WHOLE, "Its turn: 0 stop, 1 straight, 2 left, 3 right.", None,
               lambda f, s: int(s.motion.direction), "direction"),
    LabelField("done", TRUTH, "Whether the episode ends with this frame.",
               lambda f, e: f.reason is not DoneReason.NONE),
    LabelField("others", Type("list", {}), "All other moving objects, and parked ones, of which a "
               "pixel is visible, in the order of their ids.",
               lambda f, e: [_other(f, each) for each in f.others]),
    LabelField("target_acceleration", VECTOR, "Change of its velocity.", None,
               lambda f, s: rounded_list(s.motion.acceleration), "acceleration",
               unit="m/s²", frame="world"),
    LabelField("target_yaw_rate", NUMBER, "Counter-clockwise.", None,
               lambda f, s: rounded(s.motion.yaw_rate), "yaw_rate", unit="rad/s"),
    LabelField("target_travelled", NUMBER, "Way since it entered the world.", None,
               lambda f, s: rounded(s.motion.travelled), "travelled", unit="m"),
    LabelField("target_corners", CORNERS, "Corners of its 3D box: four on the ground, "
               "counter-clockwise from the right of its tail, and those above them. It contains "
               "the whole of a truck whose trailer swings, so it is then wider than its size.",
               None, lambda f, s: _points(s.corners), "corners", unit="m", frame="world"),
    LabelField("target_words", TEXT, 'It in words. The target\'s are shared by nothing else in '
               'view ("a red SUV, turning left"); others may look the same.', None,
               lambda f, s: s.words, "words"),
    LabelField("target_sections", SECTIONS, "A truck and its trailer, each with a 3D box of its "
               "own; only of articulated vehicles.", None, lambda f, s: _sections(s), "sections",
               unit="m, rad", frame="world", left_out=True),
    LabelField("target_posed_corners", CORNERS, "Corners of the box around its limbs at this "
               "moment, which swing out of the box of its size; only of people and robots.", None,
               lambda f, s: _points(s.posed_corners), "posed_corners", unit="m", frame="world",
               left_out=True),
    LabelField("target_class_id", CLASS, "Its class, as in the class pictures.", None,
               lambda f, s: int(s.object_class), "class_id"),
    LabelField("target_brake", TRUTH, "Its brake lamps are lit; only of vehicles whose are.", None,
               lambda f, s: bool(s.lamps & Lamp.BRAKE), "brake", left_out=True),
    LabelField("target_indicator", TEXT, "Side on which its indicators blink, `left` or `right`; "
               "only of vehicles whose do.", None, _indicator, "indicator", left_out=True),
    LabelField(None, TRUTH, "It is part of the map and never moves: a parked car, a boat, a train, "
               "a rack of bicycles; only of those.", None, lambda f, s: s.parked, "parked",
               left_out=True),
    LabelField("width", SIDE, "Width of the picture.", lambda f, e: e.width, unit="pixels"),
    LabelField("height", SIDE, "Height of the picture.", lambda f, e: e.height, unit="pixels"),
    LabelField("intrinsics", MATRIX, "Camera matrix: x right, y down, z forward, the centre of "
               "pixel (0, 0) at (0.5, 0.5).", lambda f, e: _points(f.camera.intrinsics),
               unit="pixels"),
    LabelField("target_visible_box", BOX, "Extent of its visible pixels, as `target_box`; all 0 if "
               "none is visible.", None, lambda f, s: s.visible_box.tolist(), "visible_box",
               unit="pixels"),
    LabelField("target_whole_box", EXTENT, "Extent of the vertices of all its parts in their poses "
               "at this moment, hidden or not, not clipped to the picture: what it would cover if "
               "the picture were larger. Vertices less than 8 cm in front of the camera, or behind "
               "it, are left out; all 0 if all are.", None, lambda f, s: rounded_list(s.whole_box),
               "whole_box", unit="pixels"),
    LabelField("target_truncated", SHARE, "Share of its whole box that is outside the picture, 0 "
               "to 1; 1 if it is out of view.", None, lambda f, s: rounded(s.truncated(f.camera)),
               "truncated"),
    LabelField("target_distance", NUMBER, "From the camera to its centre.", None, _distance,
               "distance", unit="m"),
    LabelField("distortion", COEFFICIENTS, "OpenCV's coefficients of the lens: k1, k2, p1, p2, k3, "
               "or a fisheye's k1 to k4; all 0 for a pinhole.", lambda f, e: f.camera.distortion),
    LabelField("command", COMMAND, "What the tracker is told to do: forward, left, up and yaw "
               "rate; null when it is carried with its target (`exact`).", _command,
               unit="m/s, rad/s", frame="tracker's body"),
    LabelField("gimbal_command", PAIR, "How fast its camera is told to turn: pitch, positive down, "
               "and yaw, to the left; only where a policy turns it.", _turn, unit="rad/s",
               frame="tracker's body", left_out=True),
    LabelField("distortion_model", TEXT, "Model of the lens: `brown` or `fisheye`; only of those "
               "that bend the picture.", lambda f, e: f.camera.distortion_model, left_out=True),
    LabelField("exposure_time", NUMBER, "How long the picture was exposed; only with "
               "`camera.imager`.", lambda f, e: f.exposure and round(float(f.exposure[0]), 9),
               unit="s", left_out=True),
    LabelField("iso", NUMBER, "Speed of the picture (ISO 12232); only with `camera.imager`.",
               lambda f, e: f.exposure and rounded(f.exposure[1]), left_out=True),
    LabelField("signals", SIGNALS, "What further sensors tell (`sensors.further`), with their "
               "errors, by name; only of trackers that have some.",
               lambda f, e: {name: rounded_list(each) for name, each in f.signals.items()},
               left_out=True),
)  # fmt: skip
"""All fields, in the order of the file."""

_OTHERS = {field.others: field for field in FIELDS if field.others is not None}
_FRAME = {field.key: field for field in FIELDS if field.key is not None}


def label_of(frame: Frame, episode: Episode) -> Label:
    """Return the label of a frame of an episode."""
    return dict(_values(_FRAME, frame, frame.target, episode))


def _other(frame: Frame, subject: Subject) -> Label:
    return dict(_values(_OTHERS, frame, subject, None))


def _values(
    fields: Mapping[str, LabelField], frame: Frame, subject: Subject, episode: Episode | None
) -> Iterator[tuple[str, Any]]:
    for key, field in fields.items():
        if field.of_object is not None:
            value = field.of_object(frame, subject)
        else:
            assert field.of_frame is not None
            assert episode is not None
            value = field.of_frame(frame, episode)
        if value or not field.left_out:
            yield key, value


def label_schema() -> dict[str, Any]:
    """Return the JSON schema of one line of `labels.jsonl`."""
    schema = _schema_of(_FRAME)
    schema["properties"]["others"] |= {"type": "array", "items": _schema_of(_OTHERS)}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _schema_of(fields: Mapping[str, LabelField]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {
            key: {**field.type.schema, "description": described(field)}
            for key, field in fields.items()
        },
        "required": [key for key, field in fields.items() if not (field.left_out or field.later)],
        "additionalProperties": False,
    }


def described(field: LabelField) -> str:
    """Return the meaning of a field with its unit."""
    return f"{field.meaning} [{field.unit}]" if field.unit else field.meaning


LABELS = "labels.jsonl"


class LabelWriter(Writer):
    """`labels.jsonl`."""

    wants = frozenset({"others", "words"})
    files = Files(episode=(LABELS,))

    def begin(self, episode: Episode) -> Gather[Label]:
        """Return the writer of an episode's labels."""
        return Gather(episode.folder / LABELS, lambda frame: label_of(frame, episode), _encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the summary of the labels; None if they are missing or cut off."""
        scores = Scores()
        try:
            labels = read_labels(folder / LABELS)
            for label in labels:
                reward = math.nan if label["reward"] is None else label["reward"]
                scores = scores.plus(reward, seen=label["visible_fraction"] > 0.0)
        except DataFileError:
            return None
        return Summary(len(labels), scores)


def _encoded(labels: Sequence[Label]) -> bytes:
    return "".join(json.dumps(label, allow_nan=False) + "\n" for label in labels).encode()


@cache
def _reader() -> SchemaValidator:
    return reader_of(label_schema())


def read_labels(path: Path) -> list[Label]:
    """Return the labels of an episode, one for each frame, see docs/labels.md.

    Raises:
        DataFileError: The file is missing, cut off, or does not hold labels.
    """
    return labels_in(path, _reader())
