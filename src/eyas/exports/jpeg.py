"""Pictures as JPEG files."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core.files import write_atomic
from eyas.core.jpeg import jpeg_bytes
from eyas.exports.frame import Frame
from eyas.exports.writer import Episode, EpisodeWriter, Files, Run, Summary, Writer, pattern_of

__all__ = ["JpegWriter", "write_picture"]

PICTURE = "{:06d}.jpeg"
"""Name of a frame's file."""


class JpegWriter(Writer):
    """`NNNNNN.jpeg` for each frame."""

    wants = frozenset({"rgb"})
    files = Files(frame=(PICTURE,))

    def __init__(self, run: Run) -> None:
        self._quality = run.jpeg_quality

    def begin(self, episode: Episode) -> "JpegEpisode":
        """Return the writer of an episode's pictures."""
        return JpegEpisode(episode.folder, self._quality)

    def read(self, folder: Path) -> Summary | None:
        """Return the number of pictures; None if one is missing."""
        ours = re.compile(pattern_of(PICTURE))
        names = {path.name for path in folder.glob("*") if ours.fullmatch(path.name)}
        whole = names == {PICTURE.format(number) for number in range(len(names))}
        return Summary(len(names)) if whole else None


class JpegEpisode(EpisodeWriter):
    """The pictures of one episode.

    Args:
        folder: The episode's folder.
        quality: Of its pictures, 1 to 100.
    """

    def __init__(self, folder: Path, quality: int) -> None:
        self._folder, self._quality = folder, quality

    def add(self, frame: Frame) -> None:
        """Write the next picture."""
        assert frame.rgb is not None
        write_picture(self._folder / PICTURE.format(frame.number), frame.rgb, self._quality)


def write_picture(path: Path, rgb: NDArray[np.uint8], quality: int) -> None:
    """Write one picture, completely or not at all; the same picture gives the same bytes.

    Args:
        path: The file.
        rgb: The picture, shape (H, W, 3).
        quality: 1 to 100.

    Raises:
        OutputError: The file cannot be written.
    """
    write_atomic(path, jpeg_bytes(rgb, quality))
