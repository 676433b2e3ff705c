"""What a box tracker is scored on: pictures, and the true boxes of one target in them."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eyas.engine.exports.label import Label
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.lanes import exact

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Picture = NDArray[np.uint8]

_NEAR = 4.0
"""Look-alikes count within this many diagonals of the target's box: where trackers search."""


class Clip(ABC):
    """One sequence of T frames, whoever recorded it."""

    name: str
    split: str  # `train`, `val` or `test`; empty: not known

    @abstractmethod
    def __len__(self) -> int:
        """Return T."""

    @property
    @abstractmethod
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures [pixels]."""

    @property
    @abstractmethod
    def boxes(self) -> Floats:
        """Left, top, width, height [pixels]; NaN where they are not known, shape (T, 4)."""

    @property
    @abstractmethod
    def visible(self) -> Mask:
        """Whether a part of the target is visible and its box known, shape (T,)."""

    @abstractmethod
    def pictures(self) -> Iterator[Picture]:
        """Yield the pictures, each uint8, shape (H, W, 3)."""

    @abstractmethod
    def strata(self) -> Mapping[str, Mapping[str, Mask]]:
        """Return for each criterion its values, and which frames have each, shape (T,)."""


class RecordedClip(Clip):
    """An episode that Eyas has recorded."""

    def __init__(self, episode: RecordedEpisode) -> None:
        self.name, self.split = episode.name, episode.split
        self._folder, self._config = episode.folder, episode.config

    def __len__(self) -> int:
        return len(self.episode)

    @cached_property
    def episode(self) -> RecordedEpisode:
        """The episode; its labels are held as long as this clip."""
        return RecordedEpisode(self.name, self._folder, self.split, self._config)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures [pixels]."""
        return self._config.camera.width, self._config.camera.height

    @cached_property
    def boxes(self) -> Floats:
        """Left, top, width, height [pixels], hidden parts included, shape (T, 4)."""
        boxes = self.episode.array("target_box").astype(np.float64).reshape(-1, 4)
        boxes[:, 2:] -= boxes[:, :2]
        return boxes

    @cached_property
    def visible(self) -> Mask:
        """Whether a pixel of the target is visible, shape (T,)."""
        seen: Mask = self.episode.array("visible_fraction") > 0.0
        return seen

    def pictures(self) -> Iterator[Picture]:
        """Yield the pictures, each uint8, shape (H, W, 3)."""
        return (frame.picture() for frame in self.episode)

    def strata(self) -> Mapping[str, Mapping[str, Mask]]:
        """Return the kinds of frames by the truth that only a simulator knows, shape (T,)."""
        labels = self.episode.labels
        visible = self.episode.array("visible_fraction")
        world, every = self.episode.config.world, np.ones(len(labels), np.bool_)
        alike = np.array([near_look_alikes(label) for label in labels])
        return {
            "visible": {
                "whole": visible >= 0.999,
                "half or more": (visible >= 0.5) & (visible < 0.999),
                "less than half": (visible > 0.0) & (visible < 0.5),
            },
            "look-alikes": {"none": alike == 0, "one": alike == 1, "several": alike > 1},
            **by_sizes(self.boxes, self.episode.fps),
            "border": {
                "inside": self.episode.array("target_truncated") <= 0.0,
                "cut": self.episode.array("target_truncated") > 0.0,
            },
            "weather": {str(world.weather): every},
            "map": {str(world.map): every},
            "class": {str(labels[0]["target_type"]): every},
        }


def by_sizes(
    boxes: Floats,  # Left, top, width, height [pixels], shape (T, 4)
    fps: float | None,  # Pictures a second [Hz]; None: not known
) -> Mapping[str, Mapping[str, Mask]]:
    """Return the frames by the size of the box and by how fast it moves, in its own sizes."""
    size = np.sqrt(np.maximum(boxes[:, 2:], 0.0).prod(axis=1))
    found = {
        "size": {
            "below 16 px": size < 16.0,
            "16 to 32 px": (size >= 16.0) & (size < 32.0),
            "32 to 64 px": (size >= 32.0) & (size < 64.0),
            "64 px and more": size >= 64.0,
        }
    }
    if fps is None:
        return found
    centres = boxes[:, :2] + 0.5 * boxes[:, 2:]
    steps = np.diff(centres, axis=0, prepend=centres[:1])
    rate = np.sqrt((steps * steps).sum(axis=1)) * fps / np.maximum(size, 1.0)
    speeds = {
        "below 0.5 sizes/s": rate < 0.5,
        "0.5 to 2 sizes/s": (rate >= 0.5) & (rate < 2.0),
        "2 sizes/s and more": rate >= 2.0,
    }
    return {**found, "speed": speeds}


def near_look_alikes(label: Label) -> int:
    """Return how many moving others of the target's class are near it in the picture."""
    left, top, right, bottom = label["target_box"]
    reach = _NEAR * float(exact.hypot(right - left, bottom - top))
    x, y = 0.5 * (left + right), 0.5 * (top + bottom)
    found = 0
    for other in label["others"]:
        if other["class_id"] == label["target_class_id"] and "parked" not in other:
            u, v, w, z = other["box"]
            distance = float(exact.hypot(0.5 * (u + w) - x, 0.5 * (v + z) - y))
            found += distance <= reach
    return found
