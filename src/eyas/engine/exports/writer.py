"""A writer: one output format of a recording. How to add one is in docs/writers.md.

    Writer(run)                            once
      begin(episode) -> EpisodeWriter      for each episode of each tracker
        add(frame) ...                     for each of its frames, in their order
        finish() | abandon()               when it has ended | when the recording is stopped early
      finish(episodes)                     once, when all episodes have ended

A file is written under another name and renamed when it is complete
(`eyas.engine.core.files.write_atomic`), so that an interrupted recording can be continued. Every
method that writes may raise `OutputError`.
"""

import math
import os
import re
from abc import abstractmethod
from collections.abc import Callable, Iterable, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from string import Formatter
from typing import BinaryIO, ClassVar, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.files import part_path, refusals, write_atomic
from eyas.engine.exports.frame import Frame, Output
from eyas.engine.sim.config import SimConfig


@dataclass(frozen=True, slots=True)
class Scores:
    """Sums over frames."""

    rewarded: int = 0  # Frames whose reward is a finite number
    reward: float = 0.0  # Sum of those rewards
    sightings: int = 0  # Frames in which a pixel of the target is visible

    def plus(self, reward: float, *, seen: bool) -> "Scores":
        """Return the sums including one more frame."""
        finite = math.isfinite(reward)
        return Scores(
            self.rewarded + finite, self.reward + (reward if finite else 0.0), self.sightings + seen
        )


@dataclass(frozen=True, slots=True)
class Summary:
    """Summary of some frames."""

    frames: int
    """Number of frames."""
    scores: Scores | None = None
    """None if the files do not contain them."""

    def plus(self, frame: Frame) -> "Summary":
        """Return the summary including one more frame."""
        seen = frame.target.seen_pixels > 0
        scores = self.scores and self.scores.plus(frame.reward, seen=seen)
        return Summary(self.frames + 1, scores)


def total(summaries: Iterable[Summary]) -> Summary:
    """Return the summary of some episodes; its scores are None if those of any episode are."""
    listed = list(summaries)
    scores = [summary.scores for summary in listed if summary.scores is not None]
    whole = Scores(
        sum(each.rewarded for each in scores),
        sum(each.reward for each in scores),
        sum(each.sightings for each in scores),
    )
    frames = sum(summary.frames for summary in listed)
    return Summary(frames, whole if len(scores) == len(listed) else None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """Names of files. `{:06d}` stands for a number; `/` separates folders."""

    frame: tuple[str, ...] = ()
    """Those of each frame, relative to the episode's folder, such as `{:06d}.jpeg`. They are
    written during the episode, so they do not show whether it has ended."""
    episode: tuple[str, ...] = ()
    """Those written at the end of an episode, relative to its folder."""
    run: tuple[str, ...] = ()
    """Those written at the end of the recording, relative to its folder."""

    def __post_init__(self) -> None:
        for name in (*self.frame, *self.episode, *self.run):
            pattern_of(name)


def joined(several: Iterable[Files]) -> Files:
    """Return all names of several writers."""
    listed = list(several)
    return Files(
        frame=tuple(name for files in listed for name in files.frame),
        episode=tuple(name for files in listed for name in files.episode),
        run=tuple(name for files in listed for name in files.run),
    )


def pattern_of(name: str) -> str:
    r"""Return a regular expression for a name in the notation of `Files`: `\d{6,}` for `{:06d}`.

    Raises:
        ValueError: A field of the name is not a number.
    """
    parts = []
    for literal, field, layout, _ in Formatter().parse(name):
        parts.append(re.escape(literal))
        if field is not None:
            digits = re.fullmatch(r"0?(\d{0,2})d", layout or "")
            if not digits:
                raise ValueError(f"{name!r} is not a file's name; a number in it is like {{:06d}}")
            parts.append(rf"\d{{{digits[1] or 1},}}")
    return "".join(parts)


@dataclass(frozen=True, slots=True)
class Run:
    """The description of a recording that its writers get."""

    folder: Path
    """The folder of the recording."""
    trackers: tuple[str, ...]
    """Names of all trackers: `DRONE0`, `DRONE1`, ..."""
    config: SimConfig
    """The settings of the simulation: map, weather, camera, seed, ..."""
    target_direction: bool
    """Whether `mark.json` holds the target's direction instead of reward and action."""
    jpeg_quality: int
    """Quality of pictures in the JPEG format, 1 to 100."""
    depth_unit: float
    """Unit of depth in PNG files [m]."""


@dataclass(frozen=True, slots=True)
class Episode:
    """One episode of one tracker."""

    folder: Path
    """Folder of the episode, `<run>/<tracker>/episode<number>`."""
    tracker: str
    """Name of the tracker."""
    number: int
    """Number among the episodes of its tracker that have frames, from 0."""
    width: int
    """Width of the pictures [pixels]."""
    height: int
    """Height of the pictures [pixels]."""
    intrinsics: NDArray[np.float64]
    """Camera matrix of computer vision (x right, y down, z forward), pixel (0, 0) has its centre at
    (0.5, 0.5) [pixels], shape (3, 3). Of its first frame; that of each is in `Frame.camera`."""
    fps: float
    """Frames per second of simulated time [Hz]."""


class EndedEpisode(NamedTuple):
    """An episode that is completely written, now or by an earlier, interrupted run."""

    episode: Episode
    summary: Summary


class EpisodeWriter(Protocol):
    """Writes one episode. Its methods are called in order, in the thread of its tracker.

    A subclass may omit methods that would do nothing.
    """

    @abstractmethod
    def add(self, frame: Frame) -> None:
        """Write the next frame."""

    def finish(self) -> None:
        """Write the files that describe the whole episode; nothing by default."""
        return

    def abandon(self) -> None:
        """Close open files: the recording was stopped before the end of the episode."""
        return


class Writer(Protocol):
    """Writes one format. `begin` is called in the threads of all trackers, the rest in one
    thread.

    A subclass may omit `__init__` and `finish`.

    Args:
        run: The recording.
    """

    wants: ClassVar[AbstractSet[Output]] = frozenset()
    """Pictures that it needs, `others` if it needs `Frame.others`, and `words` if it needs those of
    the target. What no writer wants is not drawn or measured; box and pixels of the target always
    exist."""
    files: ClassVar[Files]
    """All files that it writes."""

    def __init__(self, run: Run) -> None:
        return

    @abstractmethod
    def begin(self, episode: Episode) -> EpisodeWriter:
        """Return the writer of an episode, whose folder exists, without files of this writer.

        Not called for an episode without frames.
        """

    @abstractmethod
    def read(self, folder: Path) -> Summary | None:
        """Return the summary of this writer's part of an episode; None if it is incomplete.

        When a recording is continued (`--resume`), an episode is kept if all parts are complete and
        hold the same number of frames; any other is drawn again.

        Args:
            folder: The folder of the episode.
        """

    def finish(self, episodes: Sequence[EndedEpisode]) -> None:
        """Write the files that describe the whole recording; nothing by default.

        Args:
            episodes: All episodes, tracker by tracker. For those of an earlier run, `begin` and
                `add` were not called now: their data must be read from their folders.
        """
        return


Record = TypeVar("Record")


class Gather(EpisodeWriter, Generic[Record]):
    """Keeps a record of each frame and writes one file at the end of the episode.

    Args:
        path: The file.
        record: Returns the record of a frame.
        encode: Returns the bytes of the file, from all records.
    """

    def __init__(
        self,
        path: Path,
        record: Callable[[Frame], Record],
        encode: Callable[[Sequence[Record]], bytes],
    ) -> None:
        self._path = path
        self._record = record
        self._encode = encode
        self._records: list[Record] = []

    def add(self, frame: Frame) -> None:
        """Keep the record of the next frame."""
        self._records.append(self._record(frame))

    def finish(self) -> None:
        """Write the file, completely or not at all.

        Raises:
            OutputError: The file cannot be written.
        """
        write_atomic(self._path, self._encode(self._records))


class FilmEpisode(EpisodeWriter):
    """Encodes pictures into one file, one by one; it gets its final name when it is complete.

    Args:
        path: The file.

    Raises:
        OutputError: The file cannot be written; raised by every method.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._part = path, part_path(path)
        with refusals(path):
            self._file: BinaryIO = self._part.open("wb")

    @abstractmethod
    def add_picture(self, rgb: NDArray[np.uint8]) -> None:
        """Append the next picture, shape (H, W, 3)."""

    @abstractmethod
    def _complete(self) -> None:
        """Write what is left of the film."""

    def add(self, frame: Frame) -> None:
        """Append the picture of a frame."""
        assert frame.rgb is not None
        self.add_picture(frame.rgb)

    def finish(self) -> None:
        """Write the remaining pictures, and give the file its final name."""
        with refusals(self._path):
            self._complete()
            self._file.close()
            os.replace(self._part, self._path)

    def abandon(self) -> None:
        """Delete the unfinished file."""
        with refusals(self._path):
            self._part.unlink(missing_ok=True)
        with suppress(OSError):  # writing the last buffer may fail again
            self._file.close()


class PerFrameWriter(Writer):
    """Writes one file for each frame; `files` names it, and nothing else."""

    name: ClassVar[str]
    """Name of the file relative to the episode's folder, with the number of the frame."""

    @abstractmethod
    def encoded(self, frame: Frame) -> bytes:
        """Return the bytes of a frame's file."""

    def begin(self, episode: Episode) -> "FrameFiles":
        """Return the writer of an episode's files."""
        folder = (episode.folder / self.name).parent
        with refusals(folder):
            folder.mkdir(exist_ok=True)
        return FrameFiles(episode.folder, self.name, self.encoded)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of files; None if one is missing."""
        return numbered(folder, self.name)


class FrameFiles(EpisodeWriter):
    """The files of one episode."""

    def __init__(
        self,
        folder: Path,  # The episode's folder
        name: str,  # See `PerFrameWriter.name`
        encoded: Callable[[Frame], bytes],  # Returns the bytes of a frame's file
    ) -> None:
        self._folder, self._name, self._encoded = folder, name, encoded

    def add(self, frame: Frame) -> None:
        """Write the next file."""
        write_atomic(self._folder / self._name.format(frame.number), self._encoded(frame))


def numbered(folder: Path, name: str) -> Summary | None:
    """Return how many files of a name there are, from number 0 on; None if one is missing."""
    place = (folder / name).parent
    ours = re.compile(pattern_of(Path(name).name))
    names = {path.name for path in place.glob("*") if ours.fullmatch(path.name)}
    whole = names == {Path(name).name.format(number) for number in range(len(names))}
    return Summary(len(names)) if whole else None
