"""Episode records: what is known of each flown episode, one line of JSON each."""

import os
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Self

from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import decoded_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited, refusals, write_atomic

_LARGEST = 1 << 31  # Largest size of a file of records [bytes]: half a million episodes of 90 s


class PublishedFigures(Config):
    """The figures that the original's code would have printed for the same flight."""

    actions: int
    """Number of actions that it would have made."""
    cr: float
    tsr: float


class Trace(Config):
    """The flight in steps of 20 control steps, 0.16 s (`long-10`: 0.64 s)."""

    reward: tuple[float, ...]
    """Mean reward of each step."""
    drone: tuple[tuple[float, float], ...]
    """Place at the end of each step, east and north [m]."""
    target: tuple[tuple[float, float], ...]
    """Place of the target at the end of each step, east and north [m]."""


class EpisodeRecord(Config):
    """One flown episode. Times are in seconds from its start, lengths in metres."""

    name: str
    """See `eyas.benchmark.episodes.episode.EpisodeSpec`."""
    map: str
    weather: str
    target: str
    direction: float
    """[rad]"""
    seed: int
    traffic: int | None = None
    """Seed of the recorded traffic; None: the one of the protocol."""
    variant: str = ""
    """See `eyas.benchmark.episodes.episode.EpisodeSpec`."""
    solvable: bool | None = None
    """Whether the built-in policy `sighted` keeps the target in the picture; None: not known."""
    error: str | None = None
    """What the policy failed with; its figures count what it had reached until then."""
    traceback: str | None = None
    """Traceback in the policy's code."""
    reason: str
    """`DoneReason` in small letters, or `policy_failed`."""
    duration: float
    """[s]"""
    cr: float
    """Sum of the continuous reward over the control steps."""
    tsr: float
    """Share of all control steps of a full episode with the target in the picture."""
    seen: float
    """Share of all looks (one every 32 ms of a full episode) at which a pixel of the target is
    visible."""
    visible: float
    """Mean share of the target that nothing hides, 0 where it is out of the picture."""
    clear: float
    """Mean visible share under exact following: a property of the place, not of the policy."""
    found_after: float | None
    """When the target is first in the picture; None: never."""
    lost_after: float | None
    """When it is first lost, which is out of the picture for at least 0.5 s; None: never."""
    watched: float
    """Time until it is lost, or until the episode ends without a loss."""
    losses: int
    found_again: int
    """Losses after which the target was in the picture again."""
    search_time: float | None
    """Mean time of those losses until then."""
    crashed: bool
    """Whether the episode has ended by a limit of the body: height, distance, speed, tilt."""
    centre_error: float
    """Mean distance of the target from the point in the middle of the picture."""
    path: float
    """Length of the drone's path."""
    height: float
    """Mean height above the target's middle."""
    jerk: float
    """Root mean square [m/s^3]: how rough the flight is."""
    figures: dict[str, float | None]
    """Figures that only the protocol has, see docs/evaluation.md; None: not defined here."""
    published: PublishedFigures
    trace: Trace


class RecordFile:
    """A file of records to which more are added; each is on the disk when `add` returns.

    A last line that was torn by a kill or a full disk is cut off when the file is opened.

    Raises:
        OutputError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with refusals(path):
            self._file = path.open("ab+")
            self._file.seek(0)
            content = self._file.read()
            self._file.truncate(content.rfind(b"\n") + 1)

    def add(self, records: Iterable[EpisodeRecord]) -> None:
        """Append records."""
        with refusals(self._path):
            for record in records:
                self._file.write(record.model_dump_json().encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with refusals(self._path):  # closing writes what a full disk has not taken
            self._file.close()


def read_records(path: Path) -> list[EpisodeRecord]:
    """Return the records of a file, without a torn last line; none if there is no file.

    Raises:
        DataFileError: The file cannot be read, or a line is not a record.
    """
    if not path.exists():
        return []
    content = read_limited(path, _LARGEST)
    records = []
    for number, line in enumerate(content.split(b"\n")[:-1], 1):
        try:
            values = decoded_json(line)
            if not isinstance(values, dict):
                raise ValueError("not a JSON object")
            records.append(validated(EpisodeRecord, values))
        except (ValueError, ConfigError) as error:
            raise DataFileError(f"{path}: line {number}: not a record: {error}") from error
    return records


def order_records(path: Path, keys: list[int]) -> None:
    """Sort a file that `read_records` can read; lines with the same key keep their order.

    Raises:
        OutputError: The file cannot be written.
    """
    places = sorted(range(len(keys)), key=keys.__getitem__)
    if places != list(range(len(keys))):
        lines = path.read_bytes().splitlines(keepends=True)
        write_atomic(path, b"".join(lines[place] for place in places))
