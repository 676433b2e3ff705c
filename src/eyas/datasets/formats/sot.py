"""Formats of single-object tracking: one sequence an episode, the box of its target in each frame.

The box is the extent of the whole target inside the picture, hidden parts included: left, top,
width, height [pixels], counted from 0. An episode's split is the first folder of its path.
"""

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import CLASS_NAMES, Exported, Format, by_split, lines, split_of
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.state.scene import ObjectClass


def target_boxes(labels: Sequence[Label]) -> NDArray[np.int64]:
    """Return the target's left, top, width, height [pixels], 0 out of the picture, (T, 4)."""
    boxes = np.array([label["target_box"] for label in labels], np.int64).reshape(-1, 4)
    boxes[:, 2:] -= boxes[:, :2]
    return boxes


class Sequences(Format):
    """What these formats have in common: a folder for each sequence, and `add` in two parts."""

    needs = frozenset({"jpeg", "labels"})
    first_sight = True
    pictures: ClassVar[tuple[str, int, int]]
    """Folder of the pictures in that of the sequence, their first number, and its digits."""
    boxes: ClassVar[str]
    """Name of the file of boxes in the folder of the sequence."""

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        inside, first, digits = self.pictures
        folder = self.folder(episode)
        self.job.place_all(episode, f"{folder}/{inside}".rstrip("/"), first, digits)
        boxes = target_boxes(episode.labels)
        self.job.write(f"{folder}/{self.boxes}", lines(boxes.tolist()))
        self.describe(episode, folder)

    def folder(self, episode: RecordedEpisode) -> str:
        """Return the path of the folder of a sequence in the export."""
        return f"{split_of(episode)}/{episode.name}"

    @abstractmethod
    def describe(self, episode: RecordedEpisode, folder: str) -> None:
        """Write the other files of a sequence."""


class Got10k(Sequences):
    """GOT-10k: `<split>/<episode>/NNNNNNNN.jpg`, `groundtruth.txt`, `cover.label` and others.

    http://got-10k.aitestunion.com: `absence.label` and `cut_by_image.label` are 0 or 1,
    `cover.label` is a level of the visible share, see `cover_levels`.
    """

    pictures = ("", 1, 8)
    boxes = "groundtruth.txt"

    def describe(self, episode: RecordedEpisode, folder: str) -> None:
        """Write labels and facts."""
        visible, truncated = episode.array("visible_fraction"), episode.array("target_truncated")
        absent = visible <= 0
        cut = ~absent & (truncated > 0)
        self.job.write(f"{folder}/absence.label", lines(absent.astype(int).tolist()))
        self.job.write(f"{folder}/cut_by_image.label", lines(cut.astype(int).tolist()))
        self.job.write(f"{folder}/cover.label", lines(cover_levels(visible).tolist()))
        self.job.write(f"{folder}/meta_info.ini", _meta_info(episode, episode.labels[0]))

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the list of each split's sequences."""
        for split, group in by_split(episodes).items():
            self.job.write(f"{split}/list.txt", lines(episode.name for episode in group))


def cover_levels(visible: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return GOT-10k's levels of visible shares: 0 for none, one for each 15 %, 8 for all."""
    return np.digitize(visible, [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9], right=True) + (
        visible >= 1.0
    )


def _meta_info(episode: RecordedEpisode, first: Label) -> str:
    width, height = episode.size
    facts = {
        "url": "unknown",
        "begin": "00:00:00",
        "end": "00:00:00",
        "anno_fps": f"{episode.fps:g}Hz",
        "object_class": target_class(first),
        "motion_class": "moving",
        "major_class": first["target_type"],
        "root_class": "object",
        "motion_adverb": "unknown",
        "resolution": f"({width}, {height})",
    }
    return "[METAINFO]\n" + lines(f"{key}: {value}" for key, value in facts.items())


def target_class(label: Label) -> str:
    """Return the name of the target's class."""
    return CLASS_NAMES[ObjectClass(label["target_class_id"])]


class Lasot(Sequences):
    """LaSOT: `<split>/<class>/<class>-<episode>/img/NNNNNNNN.jpg`, `groundtruth.txt`, `nlp.txt`,
    `full_occlusion.txt` and `out_of_view.txt`, each one line of 0 and 1.
    """

    pictures = ("img", 1, 8)
    boxes = "groundtruth.txt"

    def folder(self, episode: RecordedEpisode) -> str:
        """Return `<split>/<class>/<class>-<episode>`."""
        name = target_class(episode.labels[0])
        return f"{split_of(episode)}/{name}/{name}-{episode.name}"

    def describe(self, episode: RecordedEpisode, folder: str) -> None:
        """Write its absence, and the words for its target in the first frame."""
        labels = episode.labels
        hidden = [int(label["in_view"] and label["visible_fraction"] <= 0.0) for label in labels]
        outside = [int(not label["in_view"]) for label in labels]
        self.job.write(f"{folder}/full_occlusion.txt", lines([hidden]))
        self.job.write(f"{folder}/out_of_view.txt", lines([outside]))
        self.job.write(f"{folder}/nlp.txt", lines([labels[0]["target_words"]]))


class Uav123(Format):
    """UAV123: `<split>/data_seq/UAV123/<episode>/NNNNNN.jpg`, `<split>/anno/UAV123/<episode>.txt`,
    whose boxes are NaN where the target is hidden or out of view.
    """

    needs = frozenset({"jpeg", "labels"})
    first_sight = True

    def add(self, episode: RecordedEpisode) -> None:
        """Write its sequence."""
        split, name = split_of(episode), episode.name
        self.job.place_all(episode, f"{split}/data_seq/UAV123/{name}", 1, 6)
        self.job.write(f"{split}/anno/UAV123/{name}.txt", lines(boxes_or_nan(episode, "NaN")))


def boxes_or_nan(episode: RecordedEpisode, nan: str) -> list[list[Any]]:
    """Return the target's boxes, and four times `nan` where nothing of it is visible."""
    visible = episode.array("visible_fraction") > 0.0
    boxes = target_boxes(episode.labels).tolist()
    return [box if seen else [nan] * 4 for box, seen in zip(boxes, visible, strict=True)]


class Dtb70(Sequences):
    """DTB70: `<split>/<episode>/img/NNNNN.jpg`, `groundtruth_rect.txt`."""

    pictures = ("img", 1, 5)
    boxes = "groundtruth_rect.txt"

    def describe(self, episode: RecordedEpisode, folder: str) -> None:
        """Write nothing: it has no other files."""


class Otb(Sequences):
    """OTB: `<split>/<episode>/img/NNNN.jpg`, `groundtruth_rect.txt`."""

    pictures = ("img", 1, 4)
    boxes = "groundtruth_rect.txt"

    def describe(self, episode: RecordedEpisode, folder: str) -> None:
        """Write nothing: it has no other files."""
