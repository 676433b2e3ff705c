"""The result of an evaluation: table, JSON and CSV."""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eyas.benchmark.plan.plan import Stamp
from eyas.benchmark.protocols.table import protocol_named
from eyas.benchmark.records.record import EpisodeRecord, read_records
from eyas.benchmark.statistics.intervals import ENOUGH, FEWEST, Estimate
from eyas.benchmark.statistics.table_rows import TableRow, rows_of
from eyas.engine.core.config import shown, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic

STAMP, EPISODES, RESULT, ROWS = "run.json", "episodes.jsonl", "result.json", "result.csv"
"""Files of an evaluation's folder."""

NO_INTERVALS = (
    f"[-]: fewer than {FEWEST} independent seeds ({FEWEST * 5} for worst_fifth), or a figure "
    "without a limit that is always 0: no interval can be had."
)
FEW_SEEDS = f"Fewer than {ENOUGH} independent seeds: intervals are rough, see docs/evaluation.md."
"""What is said below a table."""

UNITS = {
    "kept": "s",
    "losses_per_hour": "1/h",
    "search_time": "s",
    "to_find": "s",
    "centre_error": "m",
    "path": "m",
    "height": "m",
    "watched": "s",
    "jerk": "m/s^3",
}
"""Units of the figures that have one."""


_LARGEST_STAMP = 1 << 24  # Largest plan of an evaluation [bytes]


def load_run(folder: Path, *, trust: bool = False) -> tuple[Stamp, list[EpisodeRecord]]:
    """Return stamp and records of an evaluation.

    Raises:
        DataFileError: The folder holds none, a file is damaged, or it names code.
    """
    path = folder / STAMP
    if not path.is_file():
        raise DataFileError(f"{folder}: not the folder of an evaluation: it has no {STAMP}")
    values = read_json(path, _LARGEST_STAMP, "the plan of an evaluation")
    if not isinstance(values, dict):
        raise DataFileError(f"{path}: not the plan of an evaluation: not a JSON object")
    plan = values.get("plan")
    protocol = str(plan.get("protocol")) if isinstance(plan, dict) else ""
    if ":" in protocol and not trust:
        raise DataFileError(f"{path}: its protocol {shown(protocol)} is code: --trust runs it")
    return validated(Stamp, values, str(path)), read_records(folder / EPISODES)


def table(rows: Sequence[TableRow], protocol: str) -> str:
    """Return a table as text: means and 95 % intervals.

    Where seeds repeat, the first column tells how many there are, too.
    """
    columns = protocol_named(protocol).columns
    heads = [f"{name} [{UNITS[name]}]" if name in UNITS else name for name in columns]
    lines = [["", "n", *heads]]
    for row in rows:
        n, seeds = len(row.records), row.figures["tsr"].seeds
        count = str(n) if n == seeds else f"{n} ({seeds} seeds)"
        lines.append([row.label, count, *(cell(row.figures.get(name)) for name in columns)])
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    text = [
        "  ".join(
            cell.ljust(width) if place == 0 else cell.rjust(width)
            for place, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    if any("[-]" in line for line in text):
        text.append(NO_INTERVALS)
    if FEWEST <= rows[0].figures["tsr"].seeds < ENOUGH:
        text.append(FEW_SEEDS)
    return "\n".join(text)


def write_result(
    folder: Path, made: Stamp, records: Sequence[EpisodeRecord], *, as_published: bool
) -> list[TableRow]:
    """Write `result.json` and `result.csv`; return the rows.

    Raises:
        OutputError: They cannot be written.
    """
    rows = rows_of(records, made.plan.rules, as_published=as_published)
    content: dict[str, Any] = {
        **made.model_dump(mode="json", exclude={"plan"}),
        "build_id": made.build.id,
        "protocol_name": made.plan.protocol,
        "class": None if made.entry is None else made.entry.entry_class,
        "as_published": as_published,
        "plan": made.plan.model_dump(mode="json"),
        "command": made.plan.command + (" --as-published" if as_published else ""),
        "seeds": sorted({record.seed for record in records}),
        "failed": sum(record.error is not None for record in records),
        "rows": [
            {
                "group": row.group,
                "name": row.name,
                "n": len(row.records),
                "figures": {name: each._asdict() for name, each in row.figures.items()},
            }
            for row in rows
        ],
    }
    write_atomic(folder / RESULT, (json.dumps(content, indent=1) + "\n").encode())
    write_atomic(folder / ROWS, _csv(made, rows).encode())
    return rows


def cell(figure: Estimate | None) -> str:
    """Return a figure as text: mean and interval."""
    if figure is None:
        return "-"
    digits = 1 if abs(figure.mean) >= 20.0 else 3
    text = f"{figure.mean:.{digits}f}"
    if figure.interval is None:
        return f"{text} [-]"
    low, high = figure.interval
    return f"{text} [{low:.{digits}f}, {high:.{digits}f}]"


def _csv(made: Stamp, rows: Sequence[TableRow]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    heads = "version protocol protocol_hash policy latency group name figure n seeds mean low high"
    writer.writerow(heads.split())
    plan = made.plan
    start = [made.version, plan.protocol, made.protocol, plan.policy, plan.latency]
    for row in rows:
        for name, (n, seeds, mean, interval) in row.figures.items():
            limits = interval or ("", "")
            writer.writerow([*start, row.group, row.name, name, n, seeds, mean, *limits])
    return text.getvalue()
