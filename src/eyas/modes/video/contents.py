"""Decides which paths in a recording's folder belong to the recording."""

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from eyas.core.files import PART_SUFFIX
from eyas.exports.files import Files, pattern_of

__all__ = ["Contents", "paths_below"]

_TRACKER = r"(DRONE|CAR)\d+"
_EPISODE = rf"{_TRACKER}/episode\d+"


class Contents:
    """Knows the files of writers, their folders, and the names of unfinished files.

    Args:
        files: The files of all writers.
        others: Names of other files in the recording's folder.
    """

    def __init__(self, files: Files, others: Iterable[str] = ()) -> None:
        in_episode = _patterns([*files.frame, *files.episode])
        in_run = _patterns([*files.run, *others])
        below = [f"{_EPISODE}/{pattern}" for pattern in in_episode]
        self._in_episode = re.compile("|".join(in_episode))
        self._in_run = re.compile("|".join([*in_run, _TRACKER, _EPISODE, *below]))

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
