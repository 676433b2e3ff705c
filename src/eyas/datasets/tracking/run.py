"""Score a box tracker on recordings or sequences: one pass, stratified by the truth."""

import io
import json
import multiprocessing
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from copy import copy
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.box_trackers import box_tracker
from eyas.datasets.tracking.clip import Clip, Mask, RecordedClip
from eyas.datasets.tracking.film import FILMS, draw_film
from eyas.datasets.tracking.one_pass import (
    Figures,
    centre_errors,
    figures_of,
    overlaps,
    published_figures,
    track_clip,
)
from eyas.datasets.tracking.sequences import sequences_in
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import (
    ConfigError,
    DataFileError,
    EyasError,
    OutputError,
    UnknownNameError,
)
from eyas.engine.core.files import read_limited, refusals, write_atomic
from eyas.engine.core.folder_lock import LOCK, folder_lock
from eyas.engine.core.identity.build import this_build
from eyas.engine.recordings.recording import load
from eyas.engine.terminal.interrupts import interrupts_held
from eyas.engine.terminal.progress import frames_bar
from eyas.lanes import thread_count

SCORING, RESULTS, BOXES = "tracking.json", "results.json", "boxes"
"""What was asked, the figures, and the folder with a file of boxes for each episode."""

_BOX = "left,top,width,height [pixels]"
_FURTHEST = 1e6  # Largest number of a box [pixels]
_LARGEST_BOXES = 1 << 28  # Largest file of boxes [bytes]
SPEED = "timing.json"  # How fast the tracker was here; the one file that does not repeat


@dataclass(frozen=True, slots=True)
class Scoring:
    """What is scored.

    Attributes:
        tracker: A name of `BOX_TRACKERS`, or `package.module:Class`.
        folder: Of a recording, a data set, or sequences of others; or a film.
        split: The split that is used; None: all.
        restarts: Whether the tracker gets the true box again after a failure.
        only: Pattern of the names of clips that are used, as of files; None: all.
        truth: The file of the true boxes of a film, or of a folder of pictures.
        box: Left, top, width, height of the target in the first picture, in place of `truth`.

    Raises:
        ConfigError: The box has no area, or lies far from any picture.
    """

    tracker: str
    folder: Path
    split: str | None = None
    restarts: bool = False
    only: str | None = None
    truth: Path | None = None
    box: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        """Refuse a box without an area, or far from any picture."""
        if self.box is not None:
            _require_area(self.box, ",".join(map(str, self.box)))


def _require_area(box: Sequence[float], said: str) -> None:
    sides = np.asarray(box, np.float64)
    if sides.shape != (4,) or not (np.abs(sides) <= _FURTHEST).all() or (sides[2:] <= 0.0).any():
        raise ConfigError(f"--box: {said!r:.80} is not allowed: {_BOX}")


def parsed_box(text: str) -> tuple[float, float, float, float]:
    """Return the box that a text gives as `left,top,width,height`; see `Scoring`.

    Raises:
        ConfigError: It is not four numbers, or has no area.
    """
    try:
        left, top, width, height = (float(cell) for cell in text.split(","))
    except ValueError:
        raise ConfigError(f"--box: {text!r:.80} is not allowed: {_BOX}") from None
    _require_area((left, top, width, height), text)
    return left, top, width, height


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
    episodes = _clips(scoring)
    box_tracker(scoring.tracker)  # raises before anything is written
    with folder_lock(out, "tracking into it"):
        _open(out, scoring, resume=resume, overwrite=overwrite)
        try:
            seconds = _track_all(scoring, episodes, out, workers, quiet=quiet)
        except KeyboardInterrupt as interrupt:
            interrupt.add_note(f"every file in {out} is whole; continue with --resume")
            raise
        if scoring.box is not None:
            for episode in episodes:
                draw_film(out, episode, _read_boxes(out, episode)[:, :4])
        results = _results(scoring, episodes, out)
        write_atomic(out / RESULTS, (json.dumps(results, indent=1) + "\n").encode())
        if seconds.size:
            timing = {"frames": seconds.size, "mean_ms": 1e3 * float(seconds.mean())}
            write_atomic(out / SPEED, (json.dumps(timing) + "\n").encode())
    return results


def _clips(scoring: Scoring) -> Sequence[Clip]:
    """Return what is tracked."""
    folder = scoring.folder
    ours = any((folder / name).is_file() for name in ("config.json", "dataset.json"))
    if ours and (scoring.truth or scoring.box):
        raise ConfigError(f"--truth, --box: {folder} is a recording of Eyas, which has its own")
    clips: list[Clip] = []
    if ours:
        clips += map(RecordedClip, load(folder))
    else:
        clips += sequences_in(folder, scoring.truth, scoring.box)
    splits = sorted({clip.split for clip in clips if clip.split})
    if scoring.split is not None:
        if scoring.split not in splits:
            raise ConfigError(
                f"--split: {scoring.split!r} is not allowed: "
                f"{', '.join(splits) or 'this data has none'}"
            )
        clips = [clip for clip in clips if clip.split == scoring.split]
    if scoring.only is not None:
        names = [clip.name for clip in clips]
        clips = [clip for clip in clips if fnmatchcase(clip.name, scoring.only)]
        if not clips:
            raise UnknownNameError("--only", scoring.only, names)
    if not clips:
        raise DataFileError(f"{folder}: has no episodes")
    return clips


def _open(out: Path, scoring: Scoring, *, resume: bool, overwrite: bool) -> None:
    """Prepare the folder."""
    asked = {
        **asdict(scoring),
        "folder": scoring.folder.resolve().name,
        "truth": scoring.truth and scoring.truth.name,
        "box": scoring.box and list(scoring.box),
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
        drawn = (out / FILMS).glob("*") if (out / FILMS).is_dir() else ()
        for path in (*(out / BOXES).glob("*.txt"), *drawn, out / RESULTS, out / SPEED):
            path.unlink(missing_ok=True)
    write_atomic(out / SCORING, (json.dumps(asked, indent=1) + "\n").encode())


def _track_all(
    scoring: Scoring, episodes: Sequence[Clip], out: Path, workers: int | None, *, quiet: bool
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


def _frames(episodes: Sequence[Clip]) -> int:
    return sum(len(episode) for episode in episodes)


def _boxes_file(out: Path, episode: Clip) -> Path:
    return out / BOXES / f"{episode.name}.txt"


def _tracked(
    scoring: Scoring, episodes: Sequence[Clip], workers: int
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


def _tracked_one(scoring: Scoring, episode: Clip) -> tuple[str, NDArray[np.float64]]:
    make = box_tracker(scoring.tracker)
    try:
        track = track_clip(make, copy(episode), restarts=scoring.restarts)
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


def _results(scoring: Scoring, episodes: Sequence[Clip], out: Path) -> dict[str, Any]:
    """Return the figures of all frames, and of each stratum."""
    everything: list[Sample] = []
    strata: dict[str, dict[str, list[Sample]]] = {}
    single: dict[str, Any] = {}
    published: list[Sample] = []
    for each in episodes:
        episode = copy(each)  # whose labels go with it
        overlap, error, counts, told, (tracked, lost) = _scored(out, episode)
        published.append(told)
        everything.append((overlap[counts], error[counts]))
        failures = _failures(out, episode)
        single[episode.name] = {**_shown(figures_of(everything[-1:])), "failures": failures}
        if not counts.any():
            single[episode.name] |= {"tracked": tracked, "lost": lost}
        for criterion, values in episode.strata().items():
            for value, chosen in values.items():
                samples = strata.setdefault(criterion, {}).setdefault(value, [])
                samples.append((overlap[counts & chosen], error[counts & chosen]))
    told_as = None if scoring.box is not None else published_figures(published)
    return {
        "tracker": scoring.tracker,
        "data": scoring.folder.resolve().name,
        "split": scoring.split,
        "restarts": scoring.restarts,
        "build_id": this_build().id,
        "all": _shown(figures_of(everything)),
        "published": told_as and {key: round(each, 6) for key, each in told_as._asdict().items()},
        "curves": _curves(everything),
        "strata": {
            criterion: {value: _shown(figures_of(samples)) for value, samples in values.items()}
            for criterion, values in strata.items()
        },
        "episodes": single,
    }


def _scored(
    out: Path, episode: Clip
) -> tuple[NDArray[np.float64], NDArray[np.float64], Mask, Sample, tuple[int, int]]:
    """Return overlaps, centre errors, which frames count (visible, and the box not given), shapes
    (T,), the boxes and true boxes of all visible frames from the first on, and the numbers of
    frames in which the tracker searched, and in which it found nothing.
    """
    table = _read_boxes(out, episode)
    boxes, visible = table[:, :4], episode.visible
    truth = np.nan_to_num(episode.boxes)
    started = np.maximum.accumulate(table[:, 4] > 0.0)
    searched = started & (table[:, 4] == 0.0)
    counts = visible & searched
    shown = visible & started
    lost = searched & ~(boxes[:, 2:] > 0.0).all(axis=1)
    errors = centre_errors(boxes, truth)
    numbers = int(searched.sum()), int(lost.sum())
    told = boxes[shown], truth[shown]
    return overlaps(boxes, truth, episode.size), errors, counts, told, numbers


def _read_boxes(out: Path, episode: Clip) -> NDArray[np.float64]:
    """Return left, top, width, height, and whether the box was given, of each frame, (T, 5)."""
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
    return np.asarray(table, np.float64)


def _failures(out: Path, episode: Clip) -> int:
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
