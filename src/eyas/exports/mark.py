"""`mark.json` and `dir_info.json`, as the original writes them."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from eyas.core.files import write_atomic
from eyas.exports.frames import frame_name
from eyas.exports.labels import FrameLabel

__all__ = ["write_dir_info", "write_mark"]


def write_mark(path: Path, labels: Sequence[FrameLabel], *, target_direction: bool) -> None:
    """Write the marks of an episode: `{"000000": [reward, action], ...}`.

    Args:
        path: Where to.
        labels: The frames in their order.
        target_direction: Whether a mark is the target's direction (0 stop, 1 straight, 2 left,
            3 right) instead of reward and action.

    Raises:
        OutputError: The file system refused.
    """
    marks: dict[str, object] = {}
    for label in labels:
        # The original writes both as C++ doubles, so an action is 3.0 and following is -1.0.
        pair = [label.reward, float(label.action)]
        marks[frame_name(label.frame)] = label.direction if target_direction else pair
    write_atomic(path, json.dumps(marks, indent=4).encode())


def write_dir_info(path: Path, frames: Mapping[str, Mapping[str, int]]) -> None:
    """Write how many frames each episode of each tracker has.

    Args:
        path: Where to.
        frames: Tracker folder to episode folder to number of frames. The original counts the
            files of the episode's folder less `mark.json`, which is the same number.

    Raises:
        OutputError: The file system refused.
    """
    info = {tracker: dict(episodes) for tracker, episodes in frames.items()}
    write_atomic(path, json.dumps(info, indent=4).encode())
