"""A writer: one output format of a recording. How to add one is in docs/writers.md.

    Writer(run)                            once
      begin(episode) -> EpisodeWriter      for each episode of each tracker
        add(frame) ...                     for each of its frames, in their order
        finish() | abandon()               it has ended | the recording was stopped in the middle
      finish(episodes)                     once, when all episodes have ended

A file is written under another name and renamed when it is whole (`eyas.core.files.write_atomic`),
so that an interrupted recording can be continued. Whoever writes may raise `OutputError`.
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
    """A recording, as its writers are told about it."""

    folder: Path
    """Where everything lies."""
    trackers: tuple[str, ...]
    """Names of all trackers: `DRONE0`, `DRONE1`, ..."""
    config: SimConfig
    """The settings of the simulation: map, weather, camera, seed, ..."""
    target_direction: bool
    """Whether `mark.json` holds the target's direction instead of reward and action."""


@dataclass(frozen=True, slots=True)
class Episode:
    """One episode of one tracker."""

    folder: Path
    """Its folder, `<run>/<tracker>/episode<number>`."""
    tracker: str
    """Name of the tracker."""
    number: int
    """Of the episode among those of its tracker that have frames, from 0."""
    width: int
    """Of the pictures [pixels]."""
    height: int
    """Of the pictures [pixels]."""
    intrinsics: NDArray[np.float64]
    """Camera matrix of computer vision (x right, y down, z forward), pixel (0, 0) has its centre at
    (0.5, 0.5) [pixels], shape (3, 3)."""
    fps: float
    """Frames in a second of simulated time [Hz]."""


class EndedEpisode(NamedTuple):
    """An episode of which everything is written, now or by an earlier, interrupted run."""

    episode: Episode
    summary: Summary


class EpisodeWriter(Protocol):
    """Writes one episode. Its methods are called one after the other, in a thread of the tracker.

    A class that inherits from this one need not have a method that would do nothing.
    """

    @abstractmethod
    def add(self, frame: Frame) -> None:
        """Write the next frame."""

    def finish(self) -> None:
        """Write what describes the whole episode; nothing by default."""
        return

    def abandon(self) -> None:
        """Close what is open: the recording was stopped in the middle of the episode."""
        return


class Writer(Protocol):
    """Writes one format. `begin` is called in the threads of all trackers, the rest in one.

    A class that inherits from this one need have neither `__init__` nor `finish`.

    Args:
        run: The recording.
    """

    wants: ClassVar[AbstractSet[Output]] = frozenset()
    """Pictures that it needs. What no writer wants is not drawn; boxes and pixels always are."""
    files: ClassVar[Files]
    """All files that it writes."""

    def __init__(self, run: Run) -> None:
        return

    @abstractmethod
    def begin(self, episode: Episode) -> EpisodeWriter:
        """Return what writes an episode; its folder is there, without any of this writer's files.

        Not called for an episode without frames.
        """

    @abstractmethod
    def read(self, folder: Path) -> Summary | None:
        """Return what this writer's part of an episode holds; None if it is not whole.

        An interrupted recording is continued (`--resume`) after an episode of which all parts are
        whole and hold the same number of frames; any other is drawn anew.

        Args:
            folder: Of the episode.
        """

    def finish(self, episodes: Sequence[EndedEpisode]) -> None:
        """Write what describes the whole recording; nothing by default.

        Args:
            episodes: All of them, tracker by tracker. Those that an earlier run has written were
                neither begun nor added to now: what is needed of them must lie in their folders.
        """
        return
