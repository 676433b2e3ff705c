"""One-pass evaluation of box trackers over clips, and its figures.

AO and SR as in Huang et al., "GOT-10k" (TPAMI 2021): over all frames after the first in which the
target is visible, boxes cut to the picture. Success and precision with the thresholds of Wu et al.,
"Object tracking benchmark" (TPAMI 2015), over the same frames; success as the mean over episodes.
Restarts as in the VOT challenges up to 2019.
"""

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from eyas.benchmark.policies.box_trackers import Box, BoxTracker
from eyas.benchmark.statistics.intervals import Interval, clusters_of, interval_of
from eyas.datasets.tracking.clip import Clip, Floats, Mask

PRECISION_PIXELS = 20  # Largest distance of the centres that counts as precise [pixels]
_SUCCESS = np.linspace(0.0, 1.0, 21)  # Thresholds of OTB's success curve
_NORMALIZED = np.linspace(0.0, 0.5, 51)  # Thresholds of LaSOT's normalized precision
_RESTART_AFTER = 5  # Frames after a failure until the tracker gets the true box again


class Track(NamedTuple):
    """What a tracker has said of an episode of T frames."""

    boxes: Floats  # Left, top, width, height [pixels]; all 0 where it found nothing, shape (T, 4)
    told: Mask  # Frames whose box it was told: the first, and those of restarts, shape (T,)
    failures: int  # How often it was restarted
    seconds: Floats  # How long it took [s], NaN where it was not asked, shape (T,)


def track_clip(make: Callable[[], BoxTracker], clip: Clip, *, restarts: bool = False) -> Track:
    """Let a tracker find the target in all frames of a clip.

    Args:
        make: Makes the tracker.
        clip: The clip. The tracker begins with the first frame in which the target is visible.
        restarts: Whether it gets the true box again after a failure: a box that does not overlap
            that of a visible target.
    """
    truth, visible = clip.boxes, clip.visible
    count = len(clip)
    boxes, told = np.zeros((count, 4)), np.zeros(count, np.bool_)
    seconds, failures = np.full(count, np.nan), 0
    tracker: BoxTracker | None = None
    next_start = 0
    for number, picture in enumerate(clip.pictures()):
        if tracker is None:
            if number < next_start or not visible[number]:
                continue
            tracker = make()
            left, top, width, height = truth[number].tolist()
            tracker.begin(picture, (left, top, width, height))
            boxes[number], told[number] = truth[number], True
            continue
        begun = time.perf_counter()
        box = tracker.update(picture)
        seconds[number] = time.perf_counter() - begun
        boxes[number] = _plain(box)
        if restarts and visible[number] and overlaps(boxes[[number]], truth[[number]])[0] == 0.0:
            failures += 1
            tracker, next_start = None, number + _RESTART_AFTER
    return Track(boxes, told, failures, seconds)


def _plain(box: Box | None) -> Floats:
    """Return a box as four finite numbers; zeros if there is none."""
    if box is None:
        return np.zeros(4)
    found = np.array(box, np.float64).reshape(4)
    return found if np.isfinite(found).all() else np.zeros(4)


def overlaps(boxes: Floats, truth: Floats, size: tuple[int, int] | None = None) -> Floats:
    """Return the intersection over the union of pairs of boxes, shape (T,).

    Args:
        boxes: Left, top, width, height [pixels], shape (T, 4).
        size: Width and height of the picture that both are cut to; None: they are not.
    """
    ours, theirs = (_corners(each, size) for each in (boxes, truth))
    sides = np.minimum(ours[:, 2:], theirs[:, 2:]) - np.maximum(ours[:, :2], theirs[:, :2])
    shared = np.maximum(sides, 0.0).prod(axis=1)
    areas = [(each[:, 2:] - each[:, :2]).prod(axis=1) for each in (ours, theirs)]
    union = areas[0] + areas[1] - shared
    quotient: Floats = np.divide(shared, union, out=np.zeros_like(union), where=union > 0.0)
    return quotient


def _corners(boxes: Floats, size: tuple[int, int] | None) -> Floats:
    low, high = boxes[:, :2], boxes[:, :2] + np.maximum(boxes[:, 2:], 0.0)
    if size is not None:
        low, high = np.clip(low, 0.0, size), np.clip(high, 0.0, size)
    return np.concatenate([low, high], axis=1)


def centre_errors(boxes: Floats, truth: Floats) -> Floats:
    """Return the distances of the centres [pixels], shape (T,)."""
    offsets = boxes[:, :2] + 0.5 * boxes[:, 2:] - truth[:, :2] - 0.5 * truth[:, 2:]
    distances: Floats = np.sqrt((offsets * offsets).sum(axis=1))
    return distances


class Figures(NamedTuple):
    """The figures of some frames of some episodes."""

    frames: int
    episodes: int
    ao: float  # Average overlap
    ao_interval: Interval | None  # 95 %, of independent episodes; None: too few of them
    sr50: float  # Share of frames with an overlap above 0.5.
    sr75: float
    precision: float  # Share of frames whose centre is within `PRECISION_PIXELS`
    success: float  # Area below OTB's success curve, the mean over episodes


class Published(NamedTuple):
    """The figures as OTB, LaSOT, UAV123 and TrackingNet publish them.

    The first frame counts, whose box the tracker was given; boxes are not cut to the picture; each
    is a mean over clips.
    """

    success: float  # Area below the curve of 21 overlaps
    precision: float  # Share of frames whose centre is within `PRECISION_PIXELS`
    normalized_precision: float  # Area below the curve of 51 distances, to half of the box's size


def figures_of(
    # Overlaps and centre errors [pixels] of the chosen frames of each episode, both of shape (K,)
    samples: Sequence[tuple[Floats, Floats]],
) -> Figures | None:
    """Return the figures of episodes; None if they have no frames."""
    chosen = [(overlap, error) for overlap, error in samples if len(overlap)]
    if not chosen:
        return None
    overlap = np.concatenate([each for each, _ in chosen])
    error = np.concatenate([each for _, each in chosen])
    sums = np.array([(each.sum(), len(each)) for each, _ in chosen])
    curves = [(each[:, None] > _SUCCESS).mean(axis=0).mean() for each, _ in chosen]
    return Figures(
        frames=len(overlap),
        episodes=len(chosen),
        ao=float(overlap.mean()),
        ao_interval=_interval(sums),
        sr50=float((overlap > 0.5).mean()),
        sr75=float((overlap > 0.75).mean()),
        precision=float((error <= PRECISION_PIXELS).mean()),
        success=float(np.mean(curves)),
    )


def published_figures(clips: Sequence[tuple[Floats, Floats]]) -> Published | None:
    """Return the figures of clips as they are published.

    Args:
        clips: Boxes and true boxes of the frames that count of each clip: left, top, width, height
            [pixels], both of shape (K, 4).
    """
    rows = []
    for boxes, truth in clips:
        if len(truth):
            offsets = boxes[:, :2] + 0.5 * boxes[:, 2:] - truth[:, :2] - 0.5 * truth[:, 2:]
            normalized = offsets / truth[:, 2:]
            distances = np.sqrt((normalized * normalized).sum(axis=1))
            rows.append(
                (
                    (overlaps(boxes, truth)[:, None] > _SUCCESS).mean(),
                    (centre_errors(boxes, truth) <= PRECISION_PIXELS).mean(),
                    (distances[:, None] <= _NORMALIZED).mean(),
                )
            )
    return Published(*np.mean(rows, axis=0).tolist()) if rows else None


def _interval(
    sums: Floats,  # Sum and number of each episode's values, shape (E, 2)
) -> Interval | None:
    """Return the interval of a mean over all frames: those of one episode are one observation."""
    mean = float(sums[:, 0].sum() / sums[:, 1].sum())
    clusters = clusters_of(range(len(sums)), [0] * len(sums))
    variance = 0.0
    if clusters.degrees > 0:
        influence = (sums[:, 0] - mean * sums[:, 1]) / sums[:, 1].mean()
        variance = clusters.variance(influence)
    return interval_of(mean, variance, clusters.count, clusters.degrees, 1.0)
