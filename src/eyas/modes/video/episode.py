"""The files of one recorded episode."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import DataFileError
from eyas.core.files import refusals
from eyas.exports.frames import frame_name, write_frame
from eyas.exports.labels import FrameLabel, read_labels, write_labels
from eyas.exports.mark import write_mark
from eyas.exports.movie import MovieWriter

__all__ = ["LABELS", "MARK", "MOVIE", "EpisodeWriter", "read_complete"]

LABELS, MARK, MOVIE = "labels.jsonl", "mark.json", "episode.mp4"
"""Files beside the pictures. They appear when the episode has ended: all three mean it is whole."""


class EpisodeWriter:
    """Writes an episode as its frames come. Every method may raise `OutputError`.

    Args:
        folder: The episode's folder; made if it is not there, and emptied of pictures.
        fps: Pictures in a second of simulated time [Hz].
        target_direction: Whether the marks are the target's direction.
    """

    finished: bool
    """Whether every file of the episode is there."""

    def __init__(self, folder: Path, fps: float, *, target_direction: bool) -> None:
        self._folder = folder
        self._fps = fps
        self._target_direction = target_direction
        self._labels: list[FrameLabel] = []
        self._movie: MovieWriter | None = None
        self.finished = False

    def add(self, label: FrameLabel, rgb: NDArray[np.uint8]) -> None:
        """Write the next frame; `rgb` has shape (H, W, 3) and is no longer changed by anyone."""
        if self._movie is None:
            self._begin(rgb.shape[0], rgb.shape[1])
        assert self._movie is not None
        write_frame(self._folder / f"{frame_name(label.frame)}.jpeg", rgb)
        self._movie.add(rgb)
        self._labels.append(label)

    def _begin(self, height: int, width: int) -> None:
        with refusals(self._folder):
            self._folder.mkdir(parents=True, exist_ok=True)
            for left in [*self._folder.glob("*.jpeg"), *self._beside_pictures()]:
                left.unlink(missing_ok=True)
        self._movie = MovieWriter(self._folder / MOVIE, height, width, self._fps)

    def _beside_pictures(self) -> list[Path]:
        return [self._folder / name for name in (LABELS, MARK, MOVIE)]

    def finish(self) -> None:
        """Write what describes the whole episode."""
        assert self._movie is not None, "an episode without frames has no writer"
        self._movie.finish()
        self._movie = None
        write_labels(self._folder / LABELS, self._labels)
        mark = self._folder / MARK
        write_mark(mark, self._labels, target_direction=self._target_direction)
        self.finished = True

    def abandon(self) -> None:
        """Stop in the middle: pictures stay, the begun movie goes."""
        if self._movie is not None:
            self._movie.abandon()
            self._movie = None


def read_complete(folder: Path) -> list[FrameLabel] | None:
    """Return the labels of an episode of which every file is there, else None."""
    if not ((folder / MOVIE).is_file() and (folder / MARK).is_file()):
        return None
    try:
        labels = read_labels(folder / LABELS)
    except DataFileError:
        return None
    pictures = {path.stem for path in folder.glob("*.jpeg")}
    return labels if pictures == {frame_name(label.frame) for label in labels} else None
