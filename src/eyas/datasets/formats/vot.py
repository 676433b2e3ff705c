"""VOT: `<split>/list.txt`, `<split>/<episode>/{sequence, color, groundtruth.txt, *.tag, *.value}`.

Boxes are those of `eyas.datasets.formats.sot`, and `nan` where nothing of the target is visible. A
tag is 1 in a frame to which it applies; the challenge's annotators decided by eye, here it is by
the true motion, see `_tags`. A value is a number for each frame.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.datasets.formats.sot import boxes_or_nan, target_boxes
from eyas.engine.recordings.format import (
    Exported,
    Format,
    by_split,
    lines,
    picture_ending,
    split_of,
)
from eyas.engine.recordings.recording import RecordedEpisode

CAMERA_MOVES = 0.5
"""Speed [m/s], or rate of turning [rad/s], from which the camera counts as moving."""

SIZE_CHANGES = 1.25
"""Ratio of the sides of boxes a second apart from which the size counts as changing; what a target
reaches that comes a fifth nearer in a second."""

MOTION_CHANGES = 1.5
"""Acceleration of the target from which its motion counts as changing [m/s^2], that of a car that
brakes gently or turns at a junction."""


class Vot(Format):
    """VOT, as the vot-toolkit reads it."""

    needs = frozenset({"jpeg", "labels"})
    first_sight = True

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        folder = f"{split_of(episode)}/{episode.name}"
        self.job.place_all(episode, f"{folder}/color", 1, 8)
        self.job.write(f"{folder}/groundtruth.txt", lines(boxes_or_nan(episode, "nan")))
        for name, tag in _tags(episode).items():
            self.job.write(f"{folder}/{name}.tag", lines(tag.astype(int).tolist()))
        for name, key in (("visibility", "visible_fraction"), ("distance", "target_distance")):
            self.job.write(f"{folder}/{name}.value", lines(episode.array(key).tolist()))
        self.job.write(f"{folder}/sequence", lines(_properties(episode)))

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the list of each split's sequences."""
        for split, group in by_split(episodes).items():
            self.job.write(f"{split}/list.txt", lines(episode.name for episode in group))


def _properties(episode: RecordedEpisode) -> list[str]:
    width, height = episode.size
    return [
        f"channels.color=color/%08d.{picture_ending(episode)}",
        f"fps={episode.fps:g}",
        "format=default",
        f"height={height}",
        f"length={len(episode)}",
        f"name={episode.name}",
        f"width={width}",
    ]


def _tags(episode: RecordedEpisode) -> dict[str, NDArray[np.bool_]]:
    """Return for each tag whether it applies, shape (T,)."""
    visible, in_view = episode.array("visible_fraction"), episode.array("in_view")
    velocity, acceleration = (
        np.linalg.norm(episode.array(key), axis=1)
        for key in ("tracker_velocity", "target_acceleration")
    )
    return {
        "occlusion": in_view & (visible < 1.0),
        "out_of_view": ~in_view | (episode.array("target_truncated") > 0.0),
        "camera_motion": (velocity >= CAMERA_MOVES) | (_turning(episode) >= CAMERA_MOVES),
        "motion_change": acceleration >= MOTION_CHANGES,
        "size_change": resizing(episode),
    }


def _turning(episode: RecordedEpisode) -> NDArray[np.float64]:
    """Return the rate at which the camera turns [rad/s], shape (T,)."""
    change = np.diff(episode.array("camera_rotation"), axis=0)
    # Two rotations that differ by a small angle differ by its square root of two.
    angles = np.sqrt(0.5 * np.square(change).sum(axis=(1, 2)))
    return np.concatenate([[0.0], angles]) * episode.fps


def resizing(episode: RecordedEpisode) -> NDArray[np.bool_]:
    """Return whether the target's box has another size than a second ago, shape (T,)."""
    boxes = target_boxes(episode.labels)
    side = np.sqrt(boxes[:, 2].astype(np.float64) * boxes[:, 3])
    earlier = side[np.maximum(np.arange(len(side)) - round(episode.fps), 0)]
    larger, smaller = np.maximum(side, earlier), np.minimum(side, earlier)
    return (smaller > 0.0) & (larger >= SIZE_CHANGES * smaller)
