"""Kinds of frames by the truth that only a simulator knows: how much of the target is visible, how
many others look like it, its size and speed in the picture, the weather, the map.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eyas.engine.exports.label import Label
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.lanes import exact

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

_NEAR = 4.0
"""Look-alikes count within this many diagonals of the target's box: where trackers search."""


def strata_of(episode: RecordedEpisode) -> Mapping[str, Mapping[str, Mask]]:
    """Return for each criterion its values, and which frames have each, shape (T,)."""
    labels = episode.labels
    visible = episode.array("visible_fraction")
    boxes = episode.array("target_box").astype(np.float64)
    sides = boxes[:, 2:] - boxes[:, :2]
    size = np.sqrt(sides.prod(axis=1))
    world, count = episode.config.world, len(labels)
    every = np.ones(count, np.bool_)
    alike = np.array([near_look_alikes(label) for label in labels])
    return {
        "visible": {
            "whole": visible >= 0.999,
            "half or more": (visible >= 0.5) & (visible < 0.999),
            "less than half": (visible > 0.0) & (visible < 0.5),
        },
        "look-alikes": {"none": alike == 0, "one": alike == 1, "several": alike > 1},
        "size": {
            "below 16 px": size < 16.0,
            "16 to 32 px": (size >= 16.0) & (size < 32.0),
            "32 to 64 px": (size >= 32.0) & (size < 64.0),
            "64 px and more": size >= 64.0,
        },
        "speed": _speeds(boxes, size, episode.fps),
        "border": {
            "inside": episode.array("target_truncated") <= 0.0,
            "cut": episode.array("target_truncated") > 0.0,
        },
        "weather": {str(world.weather): every},
        "map": {str(world.map): every},
        "class": {str(labels[0]["target_type"]): every},
    }


def _speeds(
    boxes: NDArray[np.float64], size: NDArray[np.float64], fps: float
) -> Mapping[str, Mask]:
    """Return the frames by how many of its own sizes the box moves in a second."""
    centres = 0.5 * (boxes[:, :2] + boxes[:, 2:])
    steps = np.diff(centres, axis=0, prepend=centres[:1])
    rate = np.sqrt((steps * steps).sum(axis=1)) * fps / np.maximum(size, 1.0)
    return {
        "below 0.5 sizes/s": rate < 0.5,
        "0.5 to 2 sizes/s": (rate >= 0.5) & (rate < 2.0),
        "2 sizes/s and more": rate >= 2.0,
    }


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
