"""What a data set holds, counted: of each part when it is recorded, then added up for each split.

Everything is a whole number, so sums do not depend on their order. A histogram counts the values
from each of its edges to the next.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from eyas.engine.core.config import Config
from eyas.engine.exports.label import Label
from eyas.engine.recordings.format import CLASS_NAMES, SeenObject, objects_of
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.state.scene import ObjectClass

EDGES: dict[str, tuple[float, ...]] = {
    "size": (0, 8, 16, 32, 64, 96, 128, 256, 512),
    "visible": (0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999),
    "truncated": (0.0, 0.001, 0.1, 0.25, 0.5, 0.75),
    "speed": (0.0, 0.5, 2.0, 5.0, 10.0, 15.0, 20.0),
    "distance": (0, 10, 20, 30, 50, 100, 200),
    "objects": (0, 1, 2, 5, 10, 20, 50),
}
"""Lower edges of the histograms; the last one is open. `size`: square root of the area of the
visible box [pixels]; `visible`: visible share; `truncated`: share outside the picture; `speed`
[m/s]; `distance` from the camera [m]; `objects`: moving objects in a frame."""

UNITS = {"size": "pixels", "speed": "m/s", "distance": "m"}

Counts = dict[str, Any]
"""Whole numbers by name, in groups: `frames`, `classes.car`, `histograms.size.<edge>`, ..."""


class PartFacts(Config):
    """What is known of a recorded part."""

    episodes: int
    frames: int
    checksums: str
    """SHA-256 of its `checksums.sha256`, which covers all of its files."""
    counts: dict[str, Any]
    """Counts for `statistics.json`."""
    rows: tuple[tuple[Any, ...], ...]
    """A row of `frames.csv` for each frame."""


def facts_of(
    episodes: Iterable[RecordedEpisode], checksums: str, place: Mapping[str, str]
) -> PartFacts:
    """Return what is known of a part.

    Args:
        place: What is the same in all of its frames: `split`, `map`, `weather`, `flight`.
    """
    counts = {name: Counter[str]() for name in ("classes", "types", "targets", "episodes_by")}
    histograms = {name: np.zeros(len(edges), np.int64) for name, edges in EDGES.items()}
    target = {name: np.zeros(len(EDGES[name]), np.int64) for name in ("size", "visible", "speed")}
    rows, episode_count = [], 0
    for episode in episodes:
        episode_count += 1
        labels = episode.labels
        of_episode = []
        for label in labels:
            seen = list(objects_of(label))
            own = _measures(seen)
            _count_objects(counts, histograms, seen, own)
            of_target = _target(label)
            of_episode.append(of_target)
            rows.append(_row(episode, label, seen))
        counts["targets"].update(_target_counts(labels))
        for name, values in target.items():
            visible = [each[name] for each in of_episode if each["visible"] > 0.0]
            values += binned(name, visible)
        counts["episodes_by"].update(episode_kinds(of_episode))
    frames = len(rows)
    same = {name: {value: frames} for name, value in place.items() if name != "split"}
    return PartFacts(
        episodes=episode_count,
        frames=frames,
        checksums=checksums,
        counts={
            "parts": 1,
            "episodes": episode_count,
            "frames": frames,
            "objects": sum(counts["classes"].values()),
            **same,
            **{name: dict(sorted(counter.items())) for name, counter in counts.items()},
            "histograms": {name: _told(name, values) for name, values in histograms.items()},
            "target_histograms": {name: _told(name, values) for name, values in target.items()},
        },
        rows=tuple(tuple(row) for row in rows),
    )


def _count_objects(
    counts: Mapping[str, Counter[str]],
    histograms: Mapping[str, Any],
    seen: list[SeenObject],
    measures: Mapping[str, list[float]],
) -> None:
    counts["classes"].update(each.name for each in seen)
    counts["types"].update(each.label["type"] for each in seen)
    for name, values in measures.items():
        histograms[name][:] += binned(name, values)
    histograms["objects"][:] += binned("objects", [len(seen)])


def _measures(seen: list[SeenObject]) -> dict[str, list[float]]:
    """Return the values that are counted, of each moving object in a frame."""
    return {
        "size": [_size(each.label["visible_box"]) for each in seen],
        "visible": [each.label["visible_fraction"] for each in seen],
        "truncated": [each.label["truncated"] for each in seen],
        "speed": [_speed(each.label["velocity"]) for each in seen],
        "distance": [each.label["distance"] for each in seen],
    }


def _target(label: Label) -> dict[str, float]:
    box = label["target_visible_box"]
    alike = any(other["type"] == label["target_type"] for other in label["others"])
    return {
        "size": _size(box),
        "visible": label["visible_fraction"],
        "speed": _speed(label["target_velocity"]),
        "alike": float(alike),
    }


def _target_counts(labels: list[Label]) -> Counter[str]:
    """Return in how many frames the target is how; the first four cover all frames once."""
    counted: Counter[str] = Counter()
    for label in labels:
        share, in_view = label["visible_fraction"], label["in_view"]
        if not in_view:
            counted["out_of_view"] += 1
        elif share == 0.0:
            counted["hidden"] += 1
        else:
            counted["partly_hidden" if share < 0.999 else "wholly_visible"] += 1
        counted["cut_by_border"] += in_view and label["target_truncated"] > 0.001
        counted["look_alike_in_view"] += _target(label)["alike"] > 0.0
    return counted


def episode_kinds(frames: list[dict[str, float]]) -> Counter[str]:
    """Return the strata of an episode, as trackers are judged by them."""
    shown = [each for each in frames if each["visible"] > 0.0]
    hidden = sum(each["visible"] < 0.5 for each in frames) / len(frames)
    size = sum(each["size"] for each in shown) / len(shown) if shown else 0.0
    speed = sum(each["speed"] for each in frames) / len(frames)
    alike = any(each["alike"] for each in frames)
    return Counter(
        [
            "occlusion: " + ("none" if hidden == 0 else "some" if hidden < 0.25 else "much"),
            "size: " + ("small" if size < 32 else "medium" if size < 96 else "large"),
            "speed: " + ("slow" if speed < 2 else "medium" if speed < 10 else "fast"),
            "look-alikes: " + ("yes" if alike else "no"),
        ]
    )


COLUMNS = tuple(
    "picture split part episode frame time map weather left top right bottom visible_fraction "
    "target_class target_words objects".split()
)
"""Columns of `frames.csv`: the box is that of the target's visible pixels."""


def _row(episode: RecordedEpisode, label: Label, seen: list[SeenObject]) -> list[Any]:
    run, world = episode.folder.parent.parent, episode.config.world
    number = label["frame"]
    picture = f"parts/{episode.split}/{run.name}/{episode.tracker}/{episode.folder.name}/"
    if episode.has("jpeg") or episode.has("png"):
        picture += episode.picture_file(number).name
    return [
        picture,
        episode.split,
        run.name,
        episode.name,
        number,
        label["time"],
        world.map,
        world.weather,
        *label["target_visible_box"],
        label["visible_fraction"],
        CLASS_NAMES[ObjectClass(label["target_class_id"])],
        label["target_words"],
        len(seen),
    ]


def _size(box: list[int]) -> float:
    left, top, right, bottom = box
    return math.sqrt((right - left) * (bottom - top))


def _speed(velocity: list[float | None]) -> float:
    east, north, up = (value or 0.0 for value in velocity)
    return math.sqrt(east * east + north * north + up * up)


def binned(name: str, values: list[float]) -> Any:  # noqa: ANN401  # an array of counts
    """Return how many of the values lie from each edge of a histogram to the next."""
    edges = EDGES[name]
    at = np.searchsorted(edges, np.array(values, np.float64), side="right") - 1
    return np.bincount(np.maximum(at, 0), minlength=len(edges))


def _told(name: str, values: Any) -> dict[str, int]:  # noqa: ANN401  # the same
    edges = (f"{edge:g}" for edge in EDGES[name])
    return dict(zip(edges, values.tolist(), strict=True))


def added(several: Iterable[Mapping[str, Any]]) -> Counts:
    """Return the sums of counts."""
    total: Counts = {}
    for counts in several:
        for name, value in counts.items():
            if isinstance(value, Mapping):
                total[name] = added([total.get(name, {}), value])
            else:
                total[name] = total.get(name, 0) + value
    return total
