"""The files of one recorded episode, of all writers, and the names that a recording may hold."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

from eyas.engine.core.files import PART_SUFFIX, refusals
from eyas.engine.exports.frame import Frame
from eyas.engine.exports.writer import (
    Episode,
    EpisodeWriter,
    Files,
    Summary,
    Writer,
    joined,
    pattern_of,
)
from eyas.engine.recordings.export import EXPORTS

_TRACKER = r"(DRONE|CAR)\d+"
_EPISODE = rf"{_TRACKER}/episode\d+"
_EXPORTED = rf"{EXPORTS}(/(.|\n)*)?"


class RecordedPaths:
    """Knows the files of writers, their folders, and the names of unfinished files."""

    def __init__(
        self,
        files: Files,  # The files of all writers
        others: Iterable[str] = (),  # Names of other files in the recording's folder
    ) -> None:
        in_episode = _patterns([*files.frame, *files.episode])
        in_run = _patterns([*files.run, *others])
        below = [f"{_EPISODE}/{pattern}" for pattern in in_episode]
        self._in_episode = re.compile("|".join(in_episode))
        self._in_run = re.compile("|".join([*in_run, _TRACKER, _EPISODE, *below, _EXPORTED]))

    def in_run(self, inside: str) -> bool:
        """Return whether a recording can hold a path, relative to its folder, with `/`."""
        return self._in_run.fullmatch(inside) is not None

    def in_episode(self, inside: str) -> bool:
        """Return whether an episode can hold a path, relative to its folder, with `/`."""
        return self._in_episode.fullmatch(inside) is not None


def _patterns(names: Iterable[str]) -> list[str]:
    """Return regular expressions for files, their unfinished forms, and the folders above them."""
    patterns = []
    for name in names:
        folder, _, file = name.rpartition("/")
        above = f"{pattern_of(folder)}/" if folder else ""
        unfinished = rf"\.{pattern_of(file)}{re.escape(PART_SUFFIX)}"
        patterns += [pattern_of(name), above + unfinished]
        while folder:
            patterns.append(pattern_of(folder))
            folder = folder.rpartition("/")[0]
    return patterns


def paths_below(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield all files and folders below a folder, each with its path relative to it, with `/`."""
    for parent, folders, names in os.walk(folder):
        for name in sorted(folders + names):
            path = Path(parent, name)
            yield path.relative_to(folder).as_posix(), path


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
        contents = RecordedPaths(joined(writer.files for writer in self._writers))
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
