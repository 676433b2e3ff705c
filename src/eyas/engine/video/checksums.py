"""The checksums of a recording's episodes, by which one that is damaged is known and drawn again.

`checksums.sha256` has the files of all episodes:

    0f3a...  DRONE0/episode0/000000.jpeg

Those of an episode are appended to `.checksums` when it ends, and the file is made of these when
all have ended.
"""

import hashlib
import threading
from collections.abc import Sequence
from pathlib import Path

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.exports.checksums import CHECKSUMS, GROWING, checksum_lines, read_checksums
from eyas.engine.exports.writer import Writer, joined
from eyas.engine.video.episode import RecordedPaths, paths_below

__all__ = ["Checksums"]


class Checksums:
    """The checksums of the episodes that have ended. Its methods may be called in any thread.

    Args:
        run: The recording's folder.
        writers: Whose files are meant.
    """

    def __init__(self, run: Path, writers: Sequence[Writer]) -> None:
        self._run, self._growing = run, run / GROWING
        self._contents = RecordedPaths(joined(writer.files for writer in writers))
        self._lock = threading.Lock()
        self._known = _read(run / CHECKSUMS) | _read(self._growing)

    def add(self, episode: Path) -> None:
        """Add those of an episode that has ended.

        Raises:
            OutputError: They cannot be written, or a file not be read.
        """
        sums = self._of(episode)
        with self._lock, refusals(self._growing):
            self._forget(episode)
            self._known |= sums
            with self._growing.open("ab") as file:
                # A line that a kill has cut off must not spoil the next one.
                file.write(b"\n" * bool(file.tell()) + checksum_lines(sums))

    def match(self, episode: Path) -> bool:
        """Return whether the files of an episode are those that were written when it ended."""
        inside = self._inside(episode)
        known = {name: digest for name, digest in self._known.items() if name.startswith(inside)}
        return bool(known) and known == self._of(episode)

    def finish(self) -> None:
        """Write all of them in order, so that a recording that was continued is the same.

        Raises:
            OutputError: They cannot be written.
        """
        write_atomic(self._run / CHECKSUMS, checksum_lines(self._known))
        with refusals(self._growing):
            self._growing.unlink(missing_ok=True)

    def _forget(self, episode: Path) -> None:
        inside = self._inside(episode)
        self._known = {
            name: own for name, own in self._known.items() if not name.startswith(inside)
        }

    def _inside(self, episode: Path) -> str:
        return f"{episode.relative_to(self._run).as_posix()}/"

    def _of(self, episode: Path) -> dict[str, str]:
        inside, sums = self._inside(episode), {}
        with refusals(episode):
            for name, path in paths_below(episode):
                if self._contents.in_episode(name) and not path.is_dir():
                    sums[inside + name] = hashlib.sha256(path.read_bytes()).hexdigest()
        return sums


def _read(path: Path) -> dict[str, str]:
    """Return what an earlier run has written; nothing if there was none."""
    try:
        return read_checksums(path)
    except DataFileError:
        return {}
