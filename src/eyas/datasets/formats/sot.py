"""Formats of single-object tracking: one sequence an episode, the box of its target in each frame.

The box is the extent of the whole target inside the picture, hidden parts included; it is absent
when no pixel of it is visible.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.datasets.format import (
    CLASS_NAMES,
    Exported,
    Format,
    Job,
    numbered,
    picture_ending,
    split_of,
)
from eyas.datasets.recording import RecordedEpisode
from eyas.exports.label import Label
from eyas.state.scene import ObjectClass

__all__ = ["Got10k", "target_boxes"]


def target_boxes(labels: Sequence[Label]) -> NDArray[np.int64]:
    """Return the target's boxes: left, top, width, height [pixels], shape (T, 4)."""
    boxes = np.array([label["target_box"] for label in labels], np.int64).reshape(-1, 4)
    boxes[:, 2:] -= boxes[:, :2]
    return boxes


class Got10k(Format):
    """GOT-10k: `<split>/<episode>/NNNNNNNN.jpg`, `groundtruth.txt`, `cover.label` and others.

    http://got-10k.aitestunion.com: `absence.label` and `cut_by_image.label` are 0 or 1,
    `cover.label` is the visible share in eighths, rounded up, so that 0 means hidden.
    """

    needs = frozenset({"jpeg", "labels"})

    def __init__(self, job: Job) -> None:
        self._job = job

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        job, labels = self._job, episode.labels
        folder, ending = f"{split_of(episode)}/{episode.name}", picture_ending(episode)
        for frame in episode:
            inside = f"{folder}/{numbered(frame, 1, 8, ending)}"
            job.place(episode.picture_file(frame.number), inside)
        boxes = target_boxes(labels)
        job.write(
            f"{folder}/groundtruth.txt", _lines(",".join(map(str, b)) for b in boxes.tolist())
        )
        visible = episode.array("visible_fraction")
        truncated = episode.array("target_truncated")
        job.write(f"{folder}/absence.label", _lines((visible <= 0).astype(int)))
        job.write(f"{folder}/cut_by_image.label", _lines((truncated > 0).astype(int)))
        job.write(f"{folder}/cover.label", _lines(np.ceil(8 * visible).astype(int)))
        job.write(f"{folder}/meta_info.ini", _meta_info(episode, labels[0]))

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the list of each split's sequences."""
        for split in dict.fromkeys(episode.split for episode in episodes):
            names = [episode.name for episode in episodes if episode.split == split]
            self._job.write(f"{split}/list.txt", _lines(names))


def _lines(values: Any) -> str:  # noqa: ANN401  # anything that can be written
    return "".join(f"{value}\n" for value in values)


def _meta_info(episode: RecordedEpisode, first: Label) -> str:
    width, height = episode.size
    facts = {
        "url": "unknown",
        "begin": "00:00:00",
        "end": "00:00:00",
        "anno_fps": f"{episode.fps:g}Hz",
        "object_class": CLASS_NAMES[ObjectClass(first["target_class_id"])],
        "motion_class": "moving",
        "major_class": first["target_type"],
        "root_class": "object",
        "motion_adverb": "unknown",
        "resolution": f"({width}, {height})",
    }
    return "[METAINFO]\n" + _lines(f"{key}: {value}" for key, value in facts.items())
