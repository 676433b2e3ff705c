"""The files of one recorded episode, of all writers."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from eyas.core.files import refusals
from eyas.exports.files import joined
from eyas.exports.frame import Frame
from eyas.exports.summary import Summary
from eyas.exports.writer import Episode, EpisodeWriter, Writer
from eyas.modes.video.contents import Contents, paths_below

__all__ = ["EpisodeFiles", "read_complete"]


class EpisodeFiles:
    """Writes an episode frame by frame. Every method may raise `OutputError`.

    Args:
        writers: The writers of the recording.
        episode: The episode. Its folder is made if needed; old files of writers are deleted.
    """

    finished: bool
    """Whether every file of the episode exists."""

    def __init__(self, writers: Sequence[Writer], episode: Episode) -> None:
        self._writers = writers
        self._episode = episode
        self._parts: list[EpisodeWriter] = []
        self.finished = False

    def add(self, frame: Frame) -> None:
        """Write the next frame."""
        if not self._parts:
            self._begin()
        for part in self._parts:
            part.add(frame)

    def _begin(self) -> None:
        folder = self._episode.folder
        with refusals(folder):
            folder.mkdir(parents=True, exist_ok=True)
            self._clear(folder)
        for writer in self._writers:
            self._parts.append(writer.begin(self._episode))

    def _clear(self, folder: Path) -> None:
        contents = Contents(joined(writer.files for writer in self._writers))
        for inside, path in list(paths_below(folder)):
            if contents.in_episode(inside) and not path.is_dir():
                path.unlink(missing_ok=True)

    def finish(self) -> None:
        """Write the files that describe the whole episode."""
        while self._parts:
            self._parts[0].finish()
            del self._parts[0]
        self.finished = True

    def abandon(self) -> None:
        """Stop before the end of the episode."""
        with ExitStack() as all_of_them:  # also if one of them raises
            for part in self._parts:
                all_of_them.callback(part.abandon)
        self._parts.clear()


def read_complete(writers: Sequence[Writer], folder: Path) -> Summary | None:
    """Return the summary of an episode if it is complete, else None.

    Files that are written during an episode do not show that it has ended: it counts as
    complete only if one of the writers writes a file at its end.
    """
    if not any(writer.files.episode for writer in writers):
        return None
    found: list[Summary] = []
    for writer in writers:
        summary = writer.read(folder)
        if summary is None or (found and summary.frames != found[0].frames):
            return None
        found.append(summary)
    return next((summary for summary in found if summary.scores is not None), found[0])
