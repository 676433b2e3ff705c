"""A writer: one output format of a recording. How to add one is in docs/writers.md.

    Writer(run)                            once
      begin(episode) -> EpisodeWriter      for each episode of each tracker
        add(frame) ...                     for each of its frames, in their order
        finish() | abandon()               when it has ended | when the recording is stopped early
      finish(episodes)                     once, when all episodes have ended

A file is written under another name and renamed when it is complete
(`eyas.core.files.write_atomic`), so that an interrupted recording can be continued. Every method
that writes may raise `OutputError`.
"""

from abc import abstractmethod
from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.exports.files import Files
from eyas.exports.frame import Frame, Output
from eyas.exports.summary import Summary
from eyas.sim.config import SimConfig

__all__ = ["EndedEpisode", "Episode", "EpisodeWriter", "Run", "Writer"]


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
    """Of pictures in the JPEG format, 1 to 100."""


@dataclass(frozen=True, slots=True)
class Episode:
    """One episode of one tracker."""

    folder: Path
    """Its folder, `<run>/<tracker>/episode<number>`."""
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
    (0.5, 0.5) [pixels], shape (3, 3)."""
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
    """Pictures that it needs, and `others` if it needs `Frame.others`. What no writer wants is not
    drawn or measured; box and pixels of the target always exist."""
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
