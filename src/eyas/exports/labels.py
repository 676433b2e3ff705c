"""`labels.jsonl`: everything that is known about each frame, one JSON object a line."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from eyas.core.errors import DataFileError
from eyas.core.files import write_atomic

__all__ = ["FrameLabel", "read_labels", "rounded", "rounded_list", "write_labels"]

DECIMALS = 6
"""Decimals of every number: micrometres, microradians; few enough that bytes repeat."""


@dataclass(frozen=True, slots=True)
class FrameLabel:
    """What one frame shows. World frame east-north-up; numbers that are not finite are None."""

    frame: int
    """Number of the frame in its episode, from 0; its picture is `NNNNNN.jpeg`."""
    time: float
    """Simulated time since the start of the run [s]."""
    step: int
    """2 ms steps since the reset."""
    episode_time: float
    """Simulated time since the reset [s]."""
    target_box: list[int]
    """Extent of the target in the picture, hidden parts included, clipped to the picture: left,
    top, right, bottom [pixels], the last two exclusive; all 0 outside the picture."""
    visible_fraction: float
    """Seen pixels of the target over the pixels it would cover if nothing hid it, 0 to 1."""
    occluded: bool
    """Whether something hides a part of the target that lies in the picture."""
    in_view: bool
    """Whether a part of the target lies in the picture, seen or hidden."""
    tracker_position: list[float | None]
    """[m]"""
    tracker_velocity: list[float | None]
    """[m/s]"""
    tracker_orientation: list[float | None]
    """Body to world, quaternion w, x, y, z."""
    camera_position: list[float | None]
    """Optical centre [m]."""
    camera_rotation: list[list[float | None]]
    """Camera to world, three rows; columns are the camera's forward, left and up axes."""
    target_type: str
    """Name of the target's model."""
    target_size: list[float | None]
    """Length, width, height [m]."""
    target_position: list[float | None]
    """Reference point of the target on the road [m]."""
    target_centre: list[float | None]
    """The point that the reward looks for [m]."""
    target_velocity: list[float | None]
    """[m/s]"""
    target_yaw: float | None
    """Heading, counter-clockwise from east [rad]."""
    relative_position: list[float | None]
    """`target_centre` in the tracker's body frame: forward, left, up [m]."""
    reward: float | None
    """Reward of this instant."""
    action: int
    """Number of the random action, 0 to 5; -1 when the target is followed exactly."""
    direction: int
    """What the target does: 0 stop, 1 straight, 2 left, 3 right."""
    done: bool
    """Whether the episode ends with this instant."""


def rounded(value: float) -> float | None:
    """Return a number with fixed decimals, without a negative zero; None if it is not finite."""
    return round(float(value), DECIMALS) + 0.0 if np.isfinite(value) else None


def rounded_list(values: ArrayLike) -> list[float | None]:
    """Return `rounded` of each value, shape (K,)."""
    return [rounded(value) for value in np.asarray(values, np.float64)]


def write_labels(path: Path, labels: Sequence[FrameLabel]) -> None:
    """Write the labels of an episode, whole or not at all.

    Raises:
        OutputError: The file system refused.
    """
    lines = (json.dumps(asdict(label), allow_nan=False) + "\n" for label in labels)
    write_atomic(path, "".join(lines).encode())


def read_labels(path: Path) -> list[FrameLabel]:
    """Return the labels of an episode.

    Raises:
        DataFileError: The file is missing, cut off, or holds other records.
    """
    known = {field.name for field in fields(FrameLabel)}
    labels = []
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise DataFileError(f"{path}: cannot read: {error}") from error
    for number, line in enumerate(text.splitlines(), 1):
        try:
            record = json.loads(line)
        except ValueError:
            raise DataFileError(f"{path}: line {number} is cut off or not JSON") from None
        if not isinstance(record, dict) or record.keys() != known:
            raise DataFileError(f"{path}: line {number} is not the label of a frame")
        labels.append(FrameLabel(**record))
    return labels
