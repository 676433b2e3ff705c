"""A writer that keeps a record of each frame and writes one file at the end of an episode."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Generic, TypeVar

from eyas.core.files import write_atomic
from eyas.exports.frame import Frame
from eyas.exports.writer import EpisodeWriter

__all__ = ["Gather"]

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
