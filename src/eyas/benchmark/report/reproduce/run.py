"""Flies the tables of the documents again."""

import json
import re
from pathlib import Path

from eyas.benchmark.evaluation import run as evaluate
from eyas.benchmark.plan.plan import EvaluationPlan
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import RESULT, UNITS, cell, load_run
from eyas.benchmark.report.reproduce.tables import (
    TABLES,
    Expected,
    ExpectedRow,
    Row,
    Table,
    expected,
    flown_with,
    table_named,
)
from eyas.benchmark.statistics.table_rows import rows_of
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.files import write_atomic
from eyas.engine.core.identity.build import this_build

_WORD = re.compile(r"[\w-]+")
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def run(
    names: tuple[str, ...],
    out: Path,
    *,
    row: str | None = None,
    share: float = 1.0,
    quiet: bool = False,
) -> bool:
    """Fly tables again, or what an interrupted run has left; print them; return whether all cells
    are those of the documents.

    Args:
        row: The only rows to fly: words of their labels, or a part of one; None: all.
        share: Which part of the episodes, more than 0 and at most 1; of a part, it is told whether
            the documents' means lie in its intervals.

    Raises:
        EyasError: There is no such table or row, or the folder is taken.
    """
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"--share: {share:g} is not allowed: more than 0, at most 1")
    tables = [_part_of(table_named(name), row, share) for name in names]
    equal = [_reproduced(table, out / table.name, quiet=quiet, share=share) for table in tables]
    return all(equal)


def _part_of(table: Table, row: str | None, share: float) -> Table:
    """Return a table with one row, or with fewer episodes; these are in folders of their own."""
    rows = table.rows
    if row is not None:
        rows = _rows_of(table, row)
        if not rows:
            labels = [each.label for each in table.rows]
            raise UnknownNameError("--row", row, labels)
    if share < 1.0:
        rows = tuple(each._replace(plan=_fewer(each.plan, share)) for each in rows)
    return table._replace(rows=rows)


def _rows_of(table: Table, asked: str) -> tuple[Row, ...]:
    """Return the rows whose labels have all of some words, or else a text."""
    words = {*_WORD.findall(asked)}
    named = tuple(row for row in table.rows if words and words <= {*_WORD.findall(row.label)})
    return named or tuple(row for row in table.rows if asked in row.label)


def _fewer(plan: EvaluationPlan, share: float) -> EvaluationPlan:
    """Return a plan with a share of the episodes: first those of one set, then fewer."""
    wanted = share * plan.count
    one = plan.model_copy(update={"seeds": plan.seeds[:1]})
    count = max(round((one.episodes or one.rules.episodes) * wanted / one.count), 1)
    return one.model_copy(update={"episodes": min(count, one.episodes or one.rules.episodes)})


def _reproduced(table: Table, out: Path, *, quiet: bool, share: float) -> bool:
    if share < 1.0:
        out = out.with_name(f"{out.name}-{share:g}")
    found, wanted = made(table, out, quiet=quiet), expected(table.name)
    print(f"{table.title} (docs/{table.page})\n\n{markdown(table, found)}\n")
    if wanted is None:
        print(f"{table.name}: the documents have no figures to compare with")
        return False
    labels = {row.label for row in table.rows}
    wanted = wanted.model_copy(
        update={"rows": tuple(row for row in wanted.rows if row.label in labels)}
    )
    if share < 1.0:
        return _near(table.name, found, wanted)
    differences = _differences(found, wanted)
    for line in differences:
        print(f"{table.name}: {line}")
    if not differences:
        print(f"{table.name}: equal to the documents, every printed digit")
    elif found.build_id != wanted.build_id:
        world = "another world" if found.world != wanted.world else "the same world"
        print(
            f"{table.name}: this is build {found.build_id}, with {world}; the documents' figures "
            f"are of build {wanted.build_id}"
        )
    return not differences


def made(table: Table, out: Path, *, quiet: bool = False, keep: bool = False) -> Expected:
    """Return what a table is when it is flown here.

    Args:
        keep: Whether what another build has flown into the folder stays, for developers who know
            that the figures did.
    """
    build = this_build()
    rows = []
    for row in table.rows:
        folder = out / re.sub(r"\W+", "-", row.evaluation).strip("-")
        if not (keep and _is_flown(folder, row)):
            if not quiet:
                print(f"{table.name}: {row.plan.command}", flush=True)
            evaluate(row.plan, folder, resume=True, quiet=True)
        rows.append(_row(row, table, load_run(folder)[1]))
    return Expected(
        build_id=build.id, world=build.world, flown_with=flown_with(table), rows=tuple(rows)
    )


def _near(name: str, found: Expected, wanted: Expected) -> bool:
    """Print and return whether the documents' means lie in the intervals of fewer episodes."""
    outside, known = [], 0
    for few, all_ in zip(found.rows, wanted.rows, strict=True):
        for column, text in few.cells.items():
            numbers = _NUMBER.findall(text)
            mean = _NUMBER.search(all_.cells[column])
            if len(numbers) == 3 and mean is not None:
                known += 1
                low, high = (float(number) for number in numbers[1:])
                if not low <= float(mean[0]) <= high:
                    outside.append(f"{few.label}, {column}: {text} here, {mean[0]} there")
    for line in outside:
        print(f"{name}: {line}")
    print(f"{name}: {known - len(outside)} of {known} means of the documents lie in the intervals")
    return not outside


def _is_flown(folder: Path, row: Row) -> bool:
    return (folder / RESULT).is_file() and load_run(folder)[0].plan == row.plan


def _row(row: Row, table: Table, records: list[EpisodeRecord]) -> ExpectedRow:
    rows = rows_of(records, row.plan.rules)
    figures = next(each for each in rows if each.name == row.part).figures
    return ExpectedRow(
        label=row.label,
        n=row.episodes,
        cells={name: cell(figures.get(name)) for name in table.columns},
    )


def _differences(found: Expected, wanted: Expected) -> list[str]:
    """Return the cells that differ, in words."""
    if [row.label for row in found.rows] != [row.label for row in wanted.rows]:
        return ["its rows are others than the documents'"]
    return [
        f"{new.label}, {name}: {new.cells[name]} here, {old.cells.get(name)} in the documents"
        + (f" (of build {old.build_id})" if old.build_id else "")
        for new, old in zip(found.rows, wanted.rows, strict=True)
        for name in new.cells
        if new.cells[name] != old.cells.get(name)
    ]


def markdown(table: Table, said: Expected) -> str:
    """Return a table as Markdown."""
    heads = [f"{name} [{UNITS[name]}]" if name in UNITS else name for name in table.columns]
    lines = [f"| | n | {' | '.join(heads)} |", "|" + "---|" * (len(heads) + 2)]
    lines += [
        f"| {row.label} | {row.n} | {' | '.join(row.cells[name] for name in table.columns)} |"
        for row in said.rows
    ]
    now = flown_with(table)
    others = [name for name in now if said.flown_with.get(name) != now[name]]
    if others:
        lines += ["", f"Flown before a change of {', '.join(others)}, by build `{said.build_id}`."]
    return "\n".join(lines)


def listing() -> str:
    """Return a line for each table: name, title, document, number of episodes."""
    return "\n".join(
        f"{table.name:<12} {table.title} (docs/{table.page}); "
        f"{sum(row.episodes for row in table.rows):,} episodes"
        for table in TABLES.values()
    )


def write_expected(name: str, found: Expected) -> None:
    """Make figures those of the documents, see `tools/write_tables.py`."""
    path = Path(__file__).parent / "expected" / f"{name}.json"
    path.parent.mkdir(exist_ok=True)
    said = found.model_dump(mode="json", exclude_none=True)
    content = json.dumps(said, indent=1, ensure_ascii=False) + "\n"
    write_atomic(path, content.encode())
