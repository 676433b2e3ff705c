"""YOLO, as Ultralytics reads it: `images/<split>`, `labels/<split>`, `data.yaml`.

A line of a label is the class, counted from 0, and numbers in shares of width and height: the box
of the visible pixels (`yolo`), their outline (`yolo-seg`), or the corners of the least rectangle
around them, which may be turned (`yolo-obb`). Objects that are to be ignored are left out.
"""

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.datasets.outlines import least_rectangles, outlines
from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import (
    CLASS_NAMES,
    Exported,
    Format,
    lines,
    numbered,
    objects_of,
    picture_ending,
    split_of,
)
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame

_NUMBERS = {name: number for number, name in enumerate(CLASS_NAMES.values())}

Points = NDArray[Any]


class _Yolo(Format):
    """What the three have in common."""

    def add(self, episode: RecordedEpisode) -> None:
        """Place its pictures, and write their labels."""
        split, ending = split_of(episode), picture_ending(episode)
        for frame in episode:
            picture = episode.picture_file(frame.number)
            name = f"{split}/{episode.name}_{numbered(frame, 0, 6, ending)}"
            self.job.place(picture, f"images/{name}")
            rows = lines(self._rows(frame))
            self.job.write(f"labels/{name.removesuffix(ending)}txt", rows)

    def _rows(self, frame: RecordedFrame) -> Iterable[str]:
        size = np.array([frame.label["width"], frame.label["height"]])
        counted = [seen for seen in objects_of(frame.label) if not self.job.ignores(seen)]
        for seen, points in zip(
            counted, self.points(frame, [seen.label for seen in counted]), strict=True
        ):
            numbers = (points / size).ravel().tolist()
            yield f"{_NUMBERS[seen.name]} " + " ".join(f"{number:.6f}" for number in numbers)

    @abstractmethod
    def points(self, frame: RecordedFrame, objects: Sequence[Label]) -> Iterable[Points]:
        """Return pairs of numbers for each object [pixels], each of shape (K, 2)."""

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write `data.yaml`; Ultralytics wants `train` and `val`."""
        splits = list(dict.fromkeys(episode.split for episode in episodes))
        folders = {"train": splits[0], "val": splits[0]} | {split: split for split in splits}
        # Without "path": Ultralytics takes the folder of the file; "." would be the current one.
        rows = [f"{split}: images/{folder}" for split, folder in folders.items()]
        if len(splits) == 1:
            rows.insert(0, "# One split is all there is, so `val` measures what training has seen.")
        names = [f"  {number}: {name}" for name, number in _NUMBERS.items()]
        self.job.write("data.yaml", lines([*rows, "names:", *names]))


class Yolo(_Yolo):
    """Boxes: the middle, width and height."""

    needs = frozenset({"jpeg", "labels"})

    def points(self, frame: RecordedFrame, objects: Sequence[Label]) -> Iterable[Points]:
        """Return middle and size of each box."""
        for label in objects:
            left, top, right, bottom = label["visible_box"]
            middle = [0.5 * (left + right), 0.5 * (top + bottom)]
            yield np.array([middle, [right - left, bottom - top]])


class _OfMasks(_Yolo):
    """What is computed of the masks."""

    needs = frozenset({"jpeg", "labels", "masks"})

    def points(self, frame: RecordedFrame, objects: Sequence[Label]) -> Iterable[Points]:
        """Return the points of each object."""
        if not objects:
            return
        masks = frame.masks()
        boxes = [label["visible_box"] for label in objects]
        own = [
            masks[top:bottom, left:right] == label["id"]
            for label, (left, top, right, bottom) in zip(objects, boxes, strict=True)
        ]
        for points, box in zip(self.around(own), boxes, strict=True):
            yield points + box[:2]

    @abstractmethod
    def around(self, masks: Sequence[NDArray[np.bool_]]) -> Sequence[Points]:
        """Return the points around each mask, column and row, shape (K, 2)."""


class YoloSegments(_OfMasks):
    """Outlines of masks, see `eyas.datasets.outlines`."""

    def around(self, masks: Sequence[NDArray[np.bool_]]) -> Sequence[Points]:
        """Return the outline of each."""
        return outlines(masks)


class YoloOriented(_OfMasks):
    """Corners of oriented boxes."""

    def around(self, masks: Sequence[NDArray[np.bool_]]) -> Sequence[Points]:
        """Return the corners of the least rectangle of each, which may reach out of the picture."""
        return least_rectangles(masks)
