"""Score a box tracker on a recording or a data set: one pass, stratified by the truth."""

import io
import json
import multiprocessing
import warnings
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.box_trackers import box_tracker
from eyas.datasets.tracking.one_pass import (
    Figures,
    centre_errors,
    figures_of,
    overlaps,
    track_episode,
    true_boxes,
)
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError, EyasError, OutputError
from eyas.engine.core.files import read_limited, refusals, write_atomic
from eyas.engine.core.folder_lock import LOCK, folder_lock
from eyas.engine.core.identity.build import this_build
from eyas.engine.exports.label import Label
from eyas.engine.recordings.recording import RecordedEpisode, Recording, load
from eyas.engine.terminal.interrupts import interrupts_held
from eyas.engine.terminal.progress import frames_bar
from eyas.lanes import exact, thread_count

# Kinds of frames by the truth that only a simulator knows: how much of the target is visible, how
# many others look like it, its size and speed in the picture, the weather, the map.

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


SCORING, RESULTS, BOXES = "tracking.json", "results.json", "boxes"
"""What was asked, the figures, and the folder with a file of boxes for each episode."""

_LARGEST_BOXES = 1 << 28  # Largest file of boxes [bytes]
SPEED = "timing.json"  # How fast the tracker was here; the one file that does not repeat


@dataclass(frozen=True, slots=True)
class Scoring:
    """What is scored.

    Attributes:
        tracker: A name of `BOX_TRACKERS`, or `package.module:Class`.
        folder: Of a recording or a data set.
        split: The split that is used; None: all.
        restarts: Whether the tracker gets the true box again after a failure.
    """

    tracker: str
    folder: Path
    split: str | None = None
    restarts: bool = False


def run(
    scoring: Scoring,
    out: Path,
    *,
    workers: int | None = None,  # Number of processes; None: one for each core
    resume: bool = False,
    overwrite: bool = False,
    quiet: bool = True,
) -> dict[str, Any]:
    """Score a tracker; write boxes and figures into `out`, and return the figures.

    The same tracker and episodes give the same bytes, with any number of processes.

    Raises:
        EyasError: Something is wrong with the tracker, the recording or the folder; one line.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    recording = load(scoring.folder)
    episodes = _episodes(recording, scoring.split)
    box_tracker(scoring.tracker)  # raises before anything is written
    with folder_lock(out, "tracking into it"):
        _open(out, scoring, resume=resume, overwrite=overwrite)
        try:
            seconds = _track_all(scoring, episodes, out, workers, quiet=quiet)
        except KeyboardInterrupt as interrupt:
            interrupt.add_note(f"every file in {out} is whole; continue with --resume")
            raise
        results = _results(scoring, episodes, out)
        write_atomic(out / RESULTS, (json.dumps(results, indent=1) + "\n").encode())
        if seconds.size:
            timing = {"frames": seconds.size, "mean_ms": 1e3 * float(seconds.mean())}
            write_atomic(out / SPEED, (json.dumps(timing) + "\n").encode())
    return results


def _episodes(recording: Recording, split: str | None) -> Sequence[RecordedEpisode]:
    splits = sorted({episode.split for episode in recording if episode.split})
    if split is not None and split not in splits:
        raise ConfigError(
            f"--split: {split!r} is not allowed: {', '.join(splits) or 'a recording has none'}"
        )
    chosen = recording.episodes if split is None else recording.split(split).episodes
    if not chosen:
        raise DataFileError(f"{recording.folder}: has no episodes")
    return chosen


def _open(out: Path, scoring: Scoring, *, resume: bool, overwrite: bool) -> None:
    """Prepare the folder."""
    asked = {
        **asdict(scoring),
        "folder": scoring.folder.resolve().name,
        "build_id": this_build().id,
    }
    with refusals(out):
        names = {inside.name for inside in out.iterdir()} - {LOCK}
    if names and SCORING not in names:
        raise OutputError(f"{out}: not empty, and not of eyas track; name another folder")
    if names and not (resume or overwrite):
        raise OutputError(
            f"{out}: not empty; continue it with --resume, replace it with --overwrite, or name "
            "another folder"
        )
    if names and resume:
        try:
            found = read_json(out / SCORING, 1 << 20)
        except DataFileError:
            found = None
        if found != asked:
            raise OutputError(f"{out}: not continued: it is of {found}, not of {asked}")
        return
    with refusals(out):
        (out / BOXES).mkdir(exist_ok=True)
        for path in (*(out / BOXES).glob("*.txt"), out / RESULTS, out / SPEED):
            path.unlink(missing_ok=True)
    write_atomic(out / SCORING, (json.dumps(asked, indent=1) + "\n").encode())


def _track_all(
    scoring: Scoring,
    episodes: Sequence[RecordedEpisode],
    out: Path,
    workers: int | None,
    *,
    quiet: bool,
) -> NDArray[np.float64]:
    """Track what is not tracked yet; return how long each call took [s]."""
    left = [episode for episode in episodes if not _boxes_file(out, episode).exists()]
    count = min(workers or thread_count(), max(len(left), 1))
    seconds, frames = [np.zeros(0)], 0
    with frames_bar(f"tracking with {scoring.tracker}", _frames(left), quiet=quiet) as told:
        for episode, (text, taken) in zip(left, _tracked(scoring, left, count), strict=True):
            write_atomic(_boxes_file(out, episode), text.encode())
            seconds.append(taken)
            frames += len(episode)
            told(frames)
    return np.concatenate(seconds)


def _frames(episodes: Sequence[RecordedEpisode]) -> int:
    return sum(len(episode) for episode in episodes)


def _boxes_file(out: Path, episode: RecordedEpisode) -> Path:
    return out / BOXES / f"{episode.name}.txt"


def _tracked(
    scoring: Scoring, episodes: Sequence[RecordedEpisode], workers: int
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the text of boxes of each episode, and how long each call took [s]."""
    if workers == 1:
        yield from (_tracked_one(scoring, episode) for episode in episodes)
        return
    # Not forked: OpenCV's threads do not survive it.
    with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
        with interrupts_held():
            waiting = [pool.submit(_tracked_one, scoring, episode) for episode in episodes]
        try:
            yield from (done.result() for done in waiting)
        except BrokenProcessPool:
            raise EyasError(
                "--workers: a process was killed (too little memory?), or a script calls "
                "eyas.track outside of `if __name__ == '__main__':`"
            ) from None
        except BaseException:  # the processes write nothing: nobody need wait for them
            for process in list((pool._processes or {}).values()):
                process.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


def _tracked_one(scoring: Scoring, episode: RecordedEpisode) -> tuple[str, NDArray[np.float64]]:
    make = box_tracker(scoring.tracker)
    try:
        track = track_episode(make, episode, restarts=scoring.restarts)
    except EyasError:
        raise
    except Exception as error:  # whatever a user's tracker raises
        line = " ".join(f"{type(error).__name__}: {error}".split())[:500]
        raise EyasError(f"--tracker {scoring.tracker}: episode {episode.name}: {line}") from error
    rows = [
        f"{','.join(f'{side:.3f}' for side in box)},{int(told)}"
        for box, told in zip(track.boxes.tolist(), track.told.tolist(), strict=True)
    ]
    text = f"# left,top,width,height [pixels],told; failures {track.failures}\n"
    return text + "".join(f"{row}\n" for row in rows), track.seconds[~np.isnan(track.seconds)]


Sample = tuple[NDArray[np.float64], NDArray[np.float64]]


def _results(scoring: Scoring, episodes: Sequence[RecordedEpisode], out: Path) -> dict[str, Any]:
    """Return the figures of all frames, and of each stratum."""
    everything: list[Sample] = []
    strata: dict[str, dict[str, list[Sample]]] = {}
    single: dict[str, Any] = {}
    for episode in episodes:
        overlap, error, counts = _scored(out, episode)
        everything.append((overlap[counts], error[counts]))
        failures = _failures(out, episode)
        single[episode.name] = {**_shown(figures_of(everything[-1:])), "failures": failures}
        for criterion, values in strata_of(episode).items():
            for value, chosen in values.items():
                samples = strata.setdefault(criterion, {}).setdefault(value, [])
                samples.append((overlap[counts & chosen], error[counts & chosen]))
        episode.__dict__.pop("labels", None)
    return {
        "tracker": scoring.tracker,
        "data": scoring.folder.resolve().name,
        "split": scoring.split,
        "restarts": scoring.restarts,
        "build_id": this_build().id,
        "all": _shown(figures_of(everything)),
        "curves": _curves(everything),
        "strata": {
            criterion: {value: _shown(figures_of(samples)) for value, samples in values.items()}
            for criterion, values in strata.items()
        },
        "episodes": single,
    }


def _scored(
    out: Path, episode: RecordedEpisode
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Return overlaps, centre errors, and which frames count (visible, not told), shapes (T,)."""
    path = _boxes_file(out, episode)
    try:
        content = read_limited(path, _LARGEST_BOXES)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a file without rows, which is refused below
            table = np.loadtxt(io.BytesIO(content), delimiter=",", ndmin=2)
    except ValueError as error:
        raise DataFileError(f"{path}: cannot read: {error}; start again with --overwrite") from None
    if table.shape != (len(episode), 5) or not (np.abs(table) <= 1e9).all():
        wrong = f"{path}: has not five numbers for each frame"
        raise DataFileError(f"{wrong}; start again with --overwrite")
    boxes, truth = table[:, :4], true_boxes(episode)
    visible = episode.array("visible_fraction") > 0.0
    started = np.maximum.accumulate(table[:, 4] > 0.0)
    counts = visible & started & (table[:, 4] == 0.0)
    return overlaps(boxes, truth, episode.size), centre_errors(boxes, truth), counts


def _failures(out: Path, episode: RecordedEpisode) -> int:
    return int(_boxes_file(out, episode).read_text().partition("\n")[0].rpartition(" ")[2])


def _shown(figures: Figures | None) -> dict[str, Any]:
    if figures is None:
        return {"frames": 0}
    rounded = {
        name: round(value, 6) if isinstance(value, float) else value
        for name, value in figures._asdict().items()
    }
    interval = figures.ao_interval
    return {**rounded, "ao_interval": interval and [round(end, 6) for end in interval]}


def _curves(samples: Sequence[Sample]) -> dict[str, list[float]]:
    """Return the shares of frames above overlaps of 0 to 1, and within 0 to 50 pixels."""
    overlap = np.concatenate([each for each, _ in samples])
    error = np.concatenate([each for _, each in samples])
    if not overlap.size:
        return {"success": [], "precision": []}
    above = (overlap[:, None] > np.linspace(0.0, 1.0, 101)).mean(axis=0)
    within = (error[:, None] <= np.arange(51)).mean(axis=0)
    return {"success": above.round(6).tolist(), "precision": within.round(6).tolist()}
