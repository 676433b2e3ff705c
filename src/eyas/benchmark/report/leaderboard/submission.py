"""What is sent in to a leaderboard: a folder of records and, beside them, a card of the policy."""

import logging
import statistics
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import AfterValidator, Field

from eyas.benchmark.evaluation import TIMING
from eyas.benchmark.plan.entry import EntryClass, ResultEntry
from eyas.benchmark.plan.plan import Stamp
from eyas.benchmark.policies.person import Device, read_log
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.records.consistency import contradictions
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import STAMP, load_run
from eyas.benchmark.report.leaderboard.mark import Mark, fitting_mark
from eyas.benchmark.statistics.table_rows import figures_of
from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError, EyasError
from eyas.engine.core.files import write_atomic
from eyas.engine.policies.policy import env_config

_LOG = logging.getLogger("eyas")
_LARGEST = 1 << 20  # Largest size of the file with the timing [bytes]


_BEYOND = 1e9  # Larger than every figure of a flight


CARD = "card.json"  # The file, beside the records of an evaluation
_LARGEST_CARD = 1 << 20  # Largest size of the file [bytes]


def _is_link(text: str) -> str:
    if not text.startswith(("https://", "http://")) or not text.isprintable() or " " in text:
        raise ValueError("must be an address that begins with https:// or http://")
    return text


Line = Annotated[str, Field(min_length=1, max_length=300)]
Link = Annotated[str, Field(max_length=500), AfterValidator(_is_link)]


class PeopleCard(Config):
    """Who has flown an entry of the class `human`, and with what."""

    people: Annotated[int, Field(ge=1)]
    """How many people have flown."""
    attempts: Annotated[int, Field(ge=1)]
    """Flights that were begun; each episode has one."""
    left: Annotated[int, Field(ge=0)]
    """Flights that were left before their end."""
    devices: tuple[Device, ...]
    picture: Line
    """Size of the pictures, width and height [pixels]."""
    picture_ms: Annotated[float, Field(ge=0)] | None = None
    """Median over the flights of the time from a picture of the simulator until the page has shown
    it."""
    slowest: Annotated[float, Field(ge=0)] | None = None
    """Seconds of a flight in a second, of the slowest: 1 where the machine has kept up."""


class ModelCard(Config):
    """What an entry says of itself; a page shows it as text, and nothing of it is checked."""

    name: Line
    """What the policy is called."""
    authors: tuple[Line, ...] = ()
    link: Link | None = None
    """Where code, weights or a paper are."""
    trained_on: Line | None = None
    """The maps, recordings or films of training."""
    license: Line | None = None
    """Licence of the weights, for example `MIT`."""
    remarks: Annotated[str, Field(max_length=2000)] | None = None
    people: PeopleCard | None = None
    """Of flights of people; `eyas demo --record-for` writes it."""


def read_card(folder: Path) -> ModelCard | None:
    """Return the card of an evaluation; None if it has none.

    Raises:
        DataFileError: The file cannot be read, or is no card: one line with the wrong key.
    """
    path = folder / CARD
    if not path.exists():
        return None
    try:
        values = read_json(path, _LARGEST_CARD, "a card")
        if not isinstance(values, dict):
            raise ValueError("not a JSON object")
        return validated(ModelCard, values)
    except (ValueError, ConfigError) as error:
        raise DataFileError(f"{path}: not a card: {error}") from None


def write_people(folder: Path) -> None:
    """Write into the card of flights of people who has flown them, and with what.

    Raises:
        EyasError: A file cannot be read or written.
    """
    plan = load_run(folder)[0].plan
    log = read_log(folder / Path(plan.policy).name)
    image = env_config(log.env).observation
    shown, pace = (
        [value for one in log.flown.values() if (value := getattr(one, name)) is not None]
        for name in ("picture_ms", "pace")
    )
    pilots = {own.pilot for own in log.attempts.values()}
    people = PeopleCard(
        people=len(pilots),
        attempts=len(log.attempts),
        left=sum(bool(one.left) for one in log.of_episodes.values()),
        devices=tuple(sorted({own.device for own in log.attempts.values()})),
        picture=f"{image.width} x {image.height}",
        picture_ms=round(statistics.median(shown), 1) if shown else None,
        slowest=min(pace, default=None),
    )
    card = read_card(folder) or ModelCard(name=f"People in {plan.protocol}")
    text = card.model_copy(update={"people": people}).model_dump_json(indent=1, exclude_none=True)
    write_atomic(folder / CARD, f"{text}\n".encode())


class ContradictionError(DataFileError):
    """Records have figures that no flight can have, or not together."""


class Submission(NamedTuple):
    """One evaluation."""

    folder: Path
    stamp: Stamp
    records: list[EpisodeRecord]
    card: ModelCard | None
    entry: ResultEntry  # What the policy sees and may do
    hardware: str  # The machine whose answers were timed; `-` where no file tells
    mark: Mark | None  # What was flown again; None: nothing


def folders_in(folder: Path) -> list[Path]:
    """Return the folders of evaluations below a folder, in order.

    Raises:
        DataFileError: There is no such folder.
    """
    if not folder.is_dir():
        raise DataFileError(f"{folder}: cannot read: no such folder")
    return sorted(path.parent for path in folder.rglob(STAMP))


def submissions_in(folder: Path) -> Iterator[Submission]:
    """Yield the finished evaluations below a folder; of the others, a warning says why not."""
    for path in folders_in(folder):
        try:
            stamp, entry, records = complete_run(path)
            card = read_card(path)
        except EyasError as error:
            _LOG.warning("%s: left out: %s", path, error)
            continue
        hardware = _text_in(path / TIMING, "machine")
        yield Submission(path, stamp, records, card, entry, hardware, fitting_mark(path))


def complete_run(folder: Path) -> tuple[Stamp, ResultEntry, list[EpisodeRecord]]:
    """Return stamp, entry and records of an evaluation that has all its episodes, each once.

    Nothing that the plan names is loaded.

    Raises:
        EyasError: It has not, or is of another version's protocol, or a file is damaged.
    """
    stamp, records = load_run(folder)
    if stamp.plan.protocol not in PROTOCOLS.names() or stamp.protocol != stamp.plan.rules.hash:
        raise DataFileError("flown in a protocol of another version")
    if stamp.entry is None:
        raise DataFileError(f"its {STAMP} does not tell what the policy sees and may do")
    missing = stamp.plan.count - len(records)
    if missing:
        raise DataFileError(
            f"{abs(missing)} episodes are {'missing' if missing > 0 else 'too many'}"
        )
    if len({record.name for record in records}) < len(records):
        raise DataFileError("an episode is there twice")
    for problem in _problems(stamp, records):
        raise ContradictionError(problem)
    if stamp.entry.entry_class is EntryClass.HUMAN:
        _refuse_other_attempts(folder / Path(stamp.plan.policy).name, records)
    return stamp, stamp.entry, records


def _refuse_other_attempts(path: Path, records: Sequence[EpisodeRecord]) -> None:
    """Refuse records of people that do not fit to the log of their attempts."""
    known = read_log(path).of_episodes
    if known.keys() != {record.name for record in records}:
        raise ContradictionError(f"{path.name} has attempts at other episodes than were recorded")
    for record in records:
        left = known[record.name].left or None
        if record.error != left:
            raise ContradictionError(
                f"episode {record.name!r:.80}: its error is {record.error!r:.80}, by {path.name} "
                f"{left!r:.80}"
            )


def _problems(stamp: Stamp, records: Sequence[EpisodeRecord]) -> Iterator[str]:
    """Yield figures that no flight can have, of which no mean could be made, or not together."""
    for name, figure in figures_of(stamp.plan.rules, records).items():
        low = -_BEYOND if figure.signed else 0.0
        high = _BEYOND if figure.high is None else figure.high + 1e-6
        for record in records:
            value = figure.read(record)
            if value is not None and not low <= value <= high:
                yield (
                    f"episode {record.name!r:.80}: {name} is {value:g}; allowed: {low:g} to "
                    f"{high:.6g}"
                )
    for record in records:
        for found in contradictions(record, stamp.plan.rules):
            yield f"episode {record.name!r:.80} contradicts itself: {found}"


def _text_in(path: Path, name: str) -> str:
    """Return a text of a JSON file; `-` if there is none."""
    try:
        values = read_json(path, _LARGEST)
    except EyasError:
        return "-"
    text = values.get(name) if isinstance(values, dict) else None
    return text[:200] if isinstance(text, str) else "-"
