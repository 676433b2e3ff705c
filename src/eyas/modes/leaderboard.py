"""A page that ranks evaluations."""

import html
import logging
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from eyas.core.errors import DataFileError
from eyas.core.files import write_atomic
from eyas.evaluation.plan import Stamp
from eyas.evaluation.protocols import PROTOCOLS
from eyas.evaluation.record import EpisodeRecord
from eyas.evaluation.result import STAMP, UNITS, cell, load_run
from eyas.evaluation.rows import TableRow, rows_of

__all__ = ["run"]

_LOG = logging.getLogger("eyas")

FIRST_LINE = (
    "Results repeat to the bit: the same command in the same build of Eyas gives the same "
    "episodes and the same figures. What varies is the policy and the seed of its training."
)

_STYLE = """
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .4rem .8rem; text-align: right; border-bottom: 1px solid #8884;
  white-space: nowrap; }
th { vertical-align: bottom; }
th:first-child, td:first-child, th:last-child, td:last-child { text-align: left; }
td:last-child { white-space: normal; min-width: 16rem; overflow-wrap: anywhere; }
.interval { opacity: .65; font-size: .85em; }
code { font-size: .85em; }
"""


class _Entry(NamedTuple):
    """One evaluation."""

    stamp: Stamp
    records: list[EpisodeRecord]
    row: TableRow


def run(folder: Path, out: Path) -> str:
    """Write the page; return a line about it.

    Args:
        folder: Evaluations lie in it, at any depth; unfinished ones are left out.
        out: The page.

    Raises:
        DataFileError: There is no finished evaluation, or a file is damaged.
        OutputError: The page cannot be written.
    """
    if not folder.is_dir():
        raise DataFileError(f"{folder}: cannot read: no such folder")
    entries = list(_entries(folder))
    if not entries:
        raise DataFileError(f"{folder}: holds no finished evaluation of 'eyas evaluate'")
    tables: dict[tuple[str, ...], list[_Entry]] = {}
    for entry in entries:
        names = ",".join(sorted(record.name for record in entry.records))
        key = (entry.stamp.plan.protocol, entry.stamp.protocol, entry.stamp.build.id, names)
        tables.setdefault(key, []).append(entry)
    body = "\n".join(_section(tables[key]) for key in sorted(tables))
    write_atomic(out, _page(body).encode())
    return f"{out}: {len(entries)} evaluations in {len(tables)} tables"


def _entries(folder: Path) -> Iterator[_Entry]:
    for path in sorted(folder.rglob(STAMP)):
        stamp, records = load_run(path.parent)
        if stamp.plan.protocol not in PROTOCOLS or stamp.protocol != stamp.plan.rules.hash:
            _LOG.warning("%s: left out: flown in a protocol of another version", path.parent)
            continue
        missing = stamp.plan.count - len(records)
        if missing > 0:
            _LOG.warning("%s: left out: %d episodes are missing", path.parent, missing)
            continue
        yield _Entry(stamp, records, rows_of(records, stamp.plan.rules)[0])


def _section(entries: Sequence[_Entry]) -> str:
    """Return a table of evaluations with the same episodes, the best first."""
    stamp, records = entries[0].stamp, entries[0].records
    plan = stamp.plan
    columns = plan.rules.columns
    ranked = sorted(entries, key=_rank)
    heads = [f"{name} [{UNITS[name]}]" if name in UNITS else name for name in columns]
    head = _cells("th", ["policy", "latency [ms]", *heads, "failed", "command"])
    rows = "\n".join(f"<tr>{_line(entry, columns)}</tr>" for entry in ranked)
    places = f"{', '.join(plan.maps)}, {', '.join(plan.weathers)}"
    return (
        f"<h2>{html.escape(plan.protocol)}: {html.escape(places)}</h2>\n"
        f"<p>{html.escape(plan.rules.title)}. {html.escape(', '.join(plan.targets))}; "
        f"{len(records)} episodes; protocol "
        f"<code>{html.escape(stamp.protocol)}</code>, Eyas {html.escape(stamp.version)}, build "
        f"<code>{stamp.build.id}</code></p>\n"
        f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}\n'
        "</tbody></table></div>"
    )


def _rank(entry: _Entry) -> tuple[float, str]:
    figures = entry.row.figures
    return -figures[entry.stamp.plan.rules.rank].mean, entry.stamp.plan.policy


def _line(entry: _Entry, columns: Sequence[str]) -> str:
    plan, figures = entry.stamp.plan, entry.row.figures
    drawn = " (drawn)" if plan.sampled else ""
    mark = f"<br><code>{html.escape(entry.stamp.policy)}</code>" if entry.stamp.policy else ""
    failed = sum(record.error is not None for record in entry.records)
    cells = [f"<td>{html.escape(plan.policy)}{drawn}{mark}</td>"]
    cells.append(f"<td>{html.escape(plan.latency)}</td>")
    for name in columns:
        mean, _, interval = cell(figures.get(name)).partition(" ")
        cells.append(f'<td>{mean}<br><span class="interval">{interval}</span></td>')
    cells.append(f"<td>{failed}</td><td><code>{html.escape(plan.command)}</code></td>")
    return "".join(cells)


def _cells(tag: str, texts: Sequence[str]) -> str:
    return "".join(f"<{tag}>{html.escape(text)}</{tag}>" for text in texts)


def _page(body: str) -> str:
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Eyas leaderboard</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>Eyas leaderboard</h1>\n<p>{FIRST_LINE}</p>\n"
        "<p>Each figure is the mean of all episodes, with its 95 % interval (stratified "
        "bootstrap) below; none where the same seeds are flown in several places.</p>\n"
        f"{body}\n</body>\n</html>\n"
    )
