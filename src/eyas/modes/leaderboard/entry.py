"""An entry of a leaderboard: a folder of records, whoever has made it."""

import json
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from eyas.core.errors import DataFileError, EyasError
from eyas.core.files import read_limited
from eyas.evaluation.plan import Stamp
from eyas.evaluation.protocols import PROTOCOLS
from eyas.evaluation.record import EpisodeRecord
from eyas.evaluation.result import RESULT, STAMP, load_run
from eyas.modes.evaluate import TIMING
from eyas.modes.leaderboard.card import ModelCard, read_card
from eyas.modes.leaderboard.mark import Mark, fitting_mark

__all__ = ["PRIVILEGED", "Entry", "complete_run", "entries_in", "folders_in"]

_LOG = logging.getLogger("eyas")

PRIVILEGED = "privileged"
"""The class of entries that know more than a drone can see."""

_LARGEST = 1 << 26
"""Largest size of a result or of its timing [bytes]."""


class Entry(NamedTuple):
    """One evaluation."""

    folder: Path
    stamp: Stamp
    records: list[EpisodeRecord]
    card: ModelCard | None
    kind: str
    """Its class: what the policy sees and may do; `-` where the result does not tell."""
    hardware: str
    """The machine whose answers were timed; `-` where no file tells."""
    mark: Mark | None
    """What was flown again; None: nothing."""


def folders_in(folder: Path) -> list[Path]:
    """Return the folders of evaluations below a folder, in order.

    Raises:
        DataFileError: There is no such folder.
    """
    if not folder.is_dir():
        raise DataFileError(f"{folder}: cannot read: no such folder")
    return sorted(path.parent for path in folder.rglob(STAMP))


def entries_in(folder: Path) -> Iterator[Entry]:
    """Yield the finished evaluations below a folder; of the others, a warning says why not."""
    for path in folders_in(folder):
        try:
            stamp, records = complete_run(path)
            card = read_card(path)
        except EyasError as error:
            _LOG.warning("%s: left out: %s", path, error)
            continue
        kind, hardware = _text_in(path / RESULT, "class"), _text_in(path / TIMING, "machine")
        yield Entry(path, stamp, records, card, kind, hardware, fitting_mark(path))


def complete_run(folder: Path) -> tuple[Stamp, list[EpisodeRecord]]:
    """Return stamp and records of an evaluation that has all its episodes, each once.

    Nothing that the plan names is loaded.

    Raises:
        EyasError: It has not, or is of another version's protocol, or a file is damaged.
    """
    stamp, records = load_run(folder)
    if stamp.plan.protocol not in PROTOCOLS or stamp.protocol != stamp.plan.rules.hash:
        raise DataFileError("flown in a protocol of another version")
    missing = stamp.plan.count - len(records)
    if missing:
        raise DataFileError(
            f"{abs(missing)} episodes are {'missing' if missing > 0 else 'too many'}"
        )
    if len({record.name for record in records}) < len(records):
        raise DataFileError("an episode is there twice")
    return stamp, records


def _text_in(path: Path, name: str) -> str:
    """Return a text of a JSON file; `-` if there is none."""
    try:
        values = json.loads(read_limited(path, _LARGEST))
    except (EyasError, ValueError, RecursionError):
        return "-"
    text = values.get(name) if isinstance(values, dict) else None
    return text[:200] if isinstance(text, str) else "-"
