"""Writers of one file for each frame."""

import re
from abc import abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import Episode, EpisodeWriter, Summary, Writer, pattern_of

__all__ = ["FrameFiles", "PerFrameWriter", "numbered"]


class PerFrameWriter(Writer):
    """Writes one file for each frame; `files` names it, and nothing else."""

    name: ClassVar[str]
    """Its name relative to the episode's folder, with the number of the frame."""

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
    """The files of one episode.

    Args:
        folder: The episode's folder.
        name: See `PerFrameWriter.name`.
        encoded: Returns the bytes of a frame's file.
    """

    def __init__(self, folder: Path, name: str, encoded: Callable[[Frame], bytes]) -> None:
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
