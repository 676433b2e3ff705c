"""Makes a data set: records the parts of a plan, exports them, and describes all.

The same plan gives the same bytes: on one core or many, in shards or at once, killed and continued
or not.
"""

import csv
import hashlib
import io
import json
import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eyas.datasets.card import card
from eyas.datasets.croissant import croissant
from eyas.datasets.layout import MAKING_FILE, RECIPE_FILE, Plan, read_plan, write_plan
from eyas.datasets.making.parts import (
    PART_FILE,
    check_part,
    export_part,
    read_facts,
    record_part,
    worlds_of,
)
from eyas.datasets.making.workers import work
from eyas.datasets.overview import chosen_frames, contact_sheet, page, stacked
from eyas.datasets.plan import DatasetPart
from eyas.datasets.statistics import COLUMNS, PartFacts, added
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import EyasError, OutputError
from eyas.engine.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.engine.core.folder_lock import LOCK, folder_lock
from eyas.engine.exports.checksums import SEALED, damaged_files, seal_folder
from eyas.engine.recordings.export import EXPORTS, damaged_export, exports_folder, finish_export
from eyas.engine.recordings.recording import DATASET_FILE, Recording, load_part
from eyas.engine.terminal.ending import print_ending
from eyas.engine.terminal.progress import frames_bar
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE
from eyas.lanes import thread_count

# Writes the files that describe a data set, from what is known of its parts.


def describe(plan: Plan, parts: Sequence[tuple[DatasetPart, PartFacts]], root: Path) -> None:
    """Write recipe, table of frames, statistics, overview, datasheet and metadata.

    Raises:
        OutputError: A file cannot be written.
        DataFileError: A picture cannot be read.
    """
    rows = _table(parts)
    statistics = _statistics(parts)
    notices = _notices(parts)
    _write(root / RECIPE_FILE, plan.recipe.model_dump(mode="json"))
    write_atomic(root / "frames.csv", rows)
    _write(root / "statistics.json", statistics)
    _overview(plan, parts, statistics, root)
    write_atomic(root / "README.md", card(plan, statistics, notices).encode())
    _write(root / "croissant.json", croissant(plan, hashlib.sha256(rows).hexdigest(), notices))
    if notices:
        told = "\n".join(f"{name}: {notice.strip()}\n" for name, notice in notices.items())
        write_atomic(root / ATTRIBUTION_FILE, told.encode())


def _write(path: Path, content: Any) -> None:  # noqa: ANN401  # JSON
    write_atomic(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def _table(parts: Sequence[tuple[DatasetPart, PartFacts]]) -> bytes:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for _, facts in parts:
        table.writerows(facts.rows)
    return text.getvalue().encode()


def _statistics(parts: Sequence[tuple[DatasetPart, PartFacts]]) -> dict[str, Any]:
    """Return the counts of all splits, and of all together."""
    of_split: dict[str, list[dict[str, Any]]] = {}
    for part, facts in parts:
        of_split.setdefault(part.split, []).append(facts.counts)
    splits = {name: _in_order(added(counts)) for name, counts in of_split.items()}
    return {"total": _in_order(added(splits.values())), "splits": splits}


def _in_order(counts: dict[str, Any]) -> dict[str, Any]:
    """Return counts whose names are not in the order in which parts happen to have them."""
    names = ("classes", "types", "targets", "episodes_by")
    return {**counts, **{name: dict(sorted(counts[name].items())) for name in names}}


def _notices(parts: Sequence[tuple[DatasetPart, PartFacts]]) -> dict[str, str]:
    names = dict.fromkeys(part.config.world.map for part, _ in parts)
    told = {name: MAPS.get(name).attribution() for name in names}
    return {name: notice for name, notice in told.items() if notice}


def _overview(
    plan: Plan,
    parts: Sequence[tuple[DatasetPart, PartFacts]],
    statistics: dict[str, Any],
    root: Path,
) -> None:
    sheets = {}
    for split in statistics["splits"]:
        own = [part for part, _ in parts if part.split == split]
        episodes = [each for part in own for each in load_part(root, split, part.name)]
        pictured = [each for each in episodes if each.has("jpeg") or each.has("png")]
        sheets[split] = contact_sheet(chosen_frames(pictured))
    write_atomic(root / "overview.jpeg", stacked(list(sheets.values())))
    write_atomic(root / "overview.html", page(plan, statistics, sheets).encode())


_LOG = logging.getLogger("eyas")

EXPORTED = ".exported"
"""Names of the parts whose exports are complete, a line each, while a data set is being made."""

Recorded = Callable[[Sequence[DatasetPart], Path], Iterator[tuple[DatasetPart, PartFacts]]]
"""Records parts into the folder of the data set; yields each that is complete."""


@dataclass(frozen=True, slots=True)
class Making:
    """How a data set is made; its bytes do not depend on it."""

    workers: int | None = None  # Number of processes; None: one for each core
    resume: bool = False  # Whether one in the folder is continued
    quiet: bool = True

    @property
    def processes(self) -> int:
        """Number of processes."""
        return self.workers or thread_count()

    def threads(self, parts: int) -> int:
        """Return how many threads each process has for so many parts."""
        return max(1, thread_count() // max(1, min(self.processes, parts)))


def make(
    plan: Plan,
    root: Path,
    making: Making,
    recorded: Recorded | None = None,  # What records parts; None: the processes of this machine
) -> None:
    """Make a data set, or what is missing of it.

    Raises:
        EyasError: The recipe cannot be met, the folder is taken, or something cannot be written;
            one line.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    parts = plan.parts()
    if root.exists():
        _left(root, plan, resume=making.resume)  # refuses a folder at once that is taken
    _check_worlds(parts, root, making)
    with folder_lock(root, "making a data set in it"), continuable(root):
        if open_folder(root, plan, resume=making.resume):
            _record(parts, root, making, recorded or _on_this_machine(making))
            complete(plan, root, making)


def _check_worlds(parts: Sequence[DatasetPart], root: Path, making: Making) -> None:
    """Build each world once, so that a recipe that cannot be met is told before any is drawn."""
    missing = [part for part in parts if not (root / part.folder / PART_FILE).exists()]
    worlds = worlds_of(missing)
    if worlds:
        for _ in work(worlds, check_part, making.processes, making.threads(len(worlds))):
            pass


def _on_this_machine(making: Making) -> Recorded:
    def recorded(
        parts: Sequence[DatasetPart], root: Path
    ) -> Iterator[tuple[DatasetPart, PartFacts]]:
        return work(parts, record_part, making.processes, making.threads(len(parts)), root)

    return recorded


@contextmanager
def continuable(root: Path) -> Iterator[None]:
    """Tell how to go on after an interrupt, or when nothing can be written."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        interrupt.add_note(f"every file in {root} is whole; continue with --resume")
        raise
    except OutputError as error:
        if "--resume" in str(error):
            raise
        raise OutputError(f"{error}; continue with --resume") from error


def open_folder(root: Path, plan: Plan, *, resume: bool) -> bool:
    """Prepare the folder of a data set; return whether anything is left to do.

    Raises:
        OutputError: It holds something else, or one that may not be continued.
        DataFileError: What is there cannot be read.
    """
    found = _left(root, plan, resume=resume)
    if found == DATASET_FILE:
        damaged = list(_damaged(root, plan))
        if not damaged:
            return False
        _LOG.warning(
            "%s: not as it was made (%d such files), so what is of it is made again",
            damaged[0],
            len(damaged),
        )
    if found != MAKING_FILE:
        write_plan(root, plan)
    with refusals(root):
        (root / DATASET_FILE).unlink(missing_ok=True)
    return True


def _damaged(root: Path, plan: Plan) -> Iterator[Path]:
    """Yield the changed files of a finished data set; their parts are no longer complete."""
    yield from damaged_files(root, read_json(root / DATASET_FILE, 1 << 28).get(SEALED))
    for name in plan.recipe.formats if plan.shard is None else ():
        found = damaged_export(exports_folder(root, name, None))
        yield from [] if found is None else [found]
    for part in plan.parts():
        folder = root / part.folder
        try:
            facts = read_facts(folder)
        except EyasError:
            facts = None
        known = [folder / PART_FILE] if facts is None else []
        damaged = known or list(damaged_files(folder, facts and facts.checksums))
        if damaged:
            with refusals(folder):
                (folder / PART_FILE).unlink(missing_ok=True)
        yield from damaged


def _left(root: Path, plan: Plan, *, resume: bool) -> str | None:
    """Return the file by which a data set is known that is to be continued; None: there is none."""
    with refusals(root):
        names = {inside.name for inside in root.iterdir()} - {LOCK}
    names = {name for name in names if not name.endswith(PART_SUFFIX)}
    if not names:
        return None
    if not resume:
        raise OutputError(
            f"{root}: not empty; continue its data set with --resume, or name another folder"
        )
    found = next((name for name in (DATASET_FILE, MAKING_FILE) if name in names), None)
    if found is None:
        raise OutputError(f"{root}: not a data set: it has no {MAKING_FILE} or {DATASET_FILE}")
    differs = read_plan(root / found).difference(plan)
    if differs:
        raise OutputError(f"{root}: not continued: {differs}; name another folder")
    return found


def _record(parts: Sequence[DatasetPart], root: Path, making: Making, recorded: Recorded) -> None:
    missing, done = [], 0
    for part in parts:
        if read_facts(root / part.folder) is None:
            missing.append(part)
        else:
            done += part.frames
    with frames_bar("recording", sum(part.frames for part in parts), quiet=making.quiet) as told:
        told(done)
        if missing:
            for part, _ in recorded(missing, root):
                done += part.frames
                told(done)


def complete(plan: Plan, root: Path, making: Making) -> None:
    """Export and describe a data set whose parts are all there; a shard is only described.

    Raises:
        EyasError: A file cannot be read or written.
    """
    described = [(part, _known(root, part)) for part in plan.parts()]
    if plan.shard is None:
        _export(plan, [part for part, _ in described], root, making)
        describe(plan, described, root)
    aside = ("parts", EXPORTS, MAKING_FILE, DATASET_FILE, EXPORTED, LOCK)
    write_plan(root, plan, described, seal_folder(root, aside))
    with refusals(root):
        for name in (MAKING_FILE, EXPORTED):
            (root / name).unlink(missing_ok=True)


def _known(root: Path, part: DatasetPart) -> PartFacts:
    facts = read_facts(root / part.folder)
    if facts is None:
        raise OutputError(f"{root / part.folder}: the part is not complete")
    return facts


def _export(plan: Plan, parts: Sequence[DatasetPart], root: Path, making: Making) -> None:
    """Put all parts into the formats of the recipe, in all processes."""
    formats, name = plan.recipe.formats, plan.recipe.name
    if not formats:
        return
    done = _lines(root / EXPORTED)
    missing = [part for part in parts if part.name not in done]
    frames = sum(part.frames for part in parts if part.name in done)
    total = sum(part.frames for part in parts)
    with frames_bar("exporting", total, quiet=making.quiet) as told:
        told(frames)
        call = work(missing, export_part, making.processes, 1, root, name, formats)
        for part, _ in call if missing else ():
            done.append(part.name)
            write_atomic(root / EXPORTED, "".join(f"{each}\n" for each in done).encode())
            frames += part.frames
            told(frames)
    episodes = [each for part in parts for each in load_part(root, part.split, part.name)]
    for form in formats:
        finish_export(exports_folder(root, form, None), name, form, Recording(root, episodes))


def _lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def report(plan: Plan, place: str, *, quiet: bool) -> None:
    """Print what was made at a place."""
    if quiet:
        return
    frames = sum(_known(Path(place), part).frames for part in plan.parts())
    if plan.shard is not None:
        print_ending(
            f"{frames:,} frames in {place}: {plan.recipe.name}, shard {plan.shard[0]} of "
            f"{plan.shard[1]}",
            ("join all shards", ("eyas", "dataset", "merge", "SHARDS", "--out", "FOLDER")),
        )
        return
    exports = ", ".join(plan.recipe.formats)
    print_ending(
        f"{frames:,} frames in {place}: {plan.recipe.name}" + (f" as {exports}" if exports else ""),
        ("see it", ("eyas", "open", place)),
    )
