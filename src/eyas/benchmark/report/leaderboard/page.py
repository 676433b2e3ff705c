"""A page that ranks evaluations: those that see what a drone sees, and oracles apart."""

import html
import logging
import math
from collections.abc import Sequence
from pathlib import Path

from eyas.benchmark.plan.entry import EntryClass
from eyas.benchmark.plan.plan import Stamp
from eyas.benchmark.records.result import UNITS, cell
from eyas.benchmark.report.leaderboard.submission import Submission, submissions_in
from eyas.benchmark.statistics.table_rows import TableRow, rows_of
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic

_LOG = logging.getLogger("eyas")

FIRST_LINE = (
    "Results repeat to the bit: the same command in the same build of Eyas gives the same "
    "episodes and the same figures. What varies is the policy and the seed of its training."
)

FIGURES = (
    "Each figure is the mean of all episodes, with its 95 % interval below: how it would vary with "
    "other starts in the same places. An entry is verified if this machine has flown some of its "
    "episodes again, chosen at random, and they were equal to the byte. Seeds of all tables are "
    "public, so that equal records may be learned by heart: fresh episodes have seeds that were "
    "drawn when this machine flew them. What a card says of a policy, and the machine it was timed "
    "on, are its authors' words."
)
APART = {
    EntryClass.HUMAN: ("People", "People at the controls, in the pictures that the card names."),
    EntryClass.PRIVILEGED: (
        "Oracles",
        "They know more than a drone can see, and are not ranked with the others.",
    ),
}
"""Classes with a table of their own: its title, and what is said of it."""
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


def run(folder: Path, out: Path) -> str:
    """Write the page; return a line about it.

    Args:
        folder: Evaluations lie in it, at any depth; a warning names those that are left out.

    Raises:
        DataFileError: There is no finished evaluation.
        OutputError: The page cannot be written.
    """
    tables: dict[tuple[str, ...], list[Submission]] = {}
    count = 0
    for entry in submissions_in(folder):
        try:
            _section([entry]).encode()
        except Exception as error:  # whatever someone has sent in, the others have their page
            _LOG.warning("%s: left out: it cannot be shown: %r", entry.folder, error)
            continue
        stamp = entry.stamp
        names = ",".join(sorted(record.name for record in entry.records))
        key = (stamp.plan.protocol, stamp.protocol + _whose(stamp), stamp.program, names)
        tables.setdefault(key, []).append(entry)
        count += 1
    if not tables:
        raise DataFileError(f"{folder}: holds no finished evaluation of 'eyas evaluate'")
    body = "\n".join(_section(tables[key]) for key in sorted(tables))
    write_atomic(out, _page(body).encode())
    return f"{out}: {count} evaluations of {len(tables)} sets of episodes"


def _section(entries: Sequence[Submission]) -> str:
    """Return the tables of evaluations with the same episodes: policies, and below them oracles."""
    first = entries[0]
    stamp, plan = first.stamp, first.stamp.plan
    places = f"{', '.join(plan.maps)}, {', '.join(plan.weathers)}"
    starts = ", ".join(map(str, plan.seeds))
    head = (
        f"<h2>{html.escape(plan.protocol)}: {html.escape(places)}</h2>\n"
        f"<p>{html.escape(plan.rules.title)}. {html.escape(', '.join(plan.followed))}; "
        f"{len(first.records)} episodes, seeds from {starts}; protocol "
        f"<code>{html.escape(stamp.protocol)}</code>{_whose(stamp)}, "
        f"Eyas {html.escape(stamp.version)}, program <code>{stamp.program}</code></p>\n"
    )
    tables = _table([entry for entry in entries if entry.entry.entry_class not in APART])
    for own, (title, about) in APART.items():
        if apart := [entry for entry in entries if entry.entry.entry_class is own]:
            tables += f"\n<h3>{title}</h3>\n<p>{about}</p>\n{_table(apart)}"
    return head + tables


def _whose(stamp: Stamp) -> str:
    """Return whose the protocol is, unless it is one of Eyas."""
    return "" if stamp.rules is None else f" of {html.escape(str(stamp.rules))}"


def _table(entries: Sequence[Submission]) -> str:
    """Return a table, the best first."""
    if not entries:
        return ""
    rules = entries[0].stamp.plan.rules
    rows = [(entry, rows_of(entry.records, rules)[0]) for entry in entries]

    def order(pair: tuple[Submission, TableRow]) -> tuple[float, str]:
        known = pair[1].figures.get(rules.rank)
        return -known.mean if known else math.inf, pair[0].stamp.plan.policy

    columns = rules.columns
    heads = [f"{name} [{UNITS[name]}]" if name in UNITS else name for name in columns]
    fresh = f"{rules.rank}, fresh episodes"
    names = ["policy", "class", "latency [ms]", fresh, *heads, "failed", "flown again", "timed on"]
    head = "".join(f"<th>{html.escape(name)}</th>" for name in [*names, "command"])
    body = "\n".join(f"<tr>{_line(*pair, columns)}</tr>" for pair in sorted(rows, key=order))
    return (
        f'<div class="scroll"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n'
        "</tbody></table></div>"
    )


def _line(entry: Submission, row: TableRow, columns: Sequence[str]) -> str:
    plan = entry.stamp.plan
    failed = sum(record.error is not None for record in entry.records)
    cells = [_policy(entry), entry.entry.entry_class.value, html.escape(plan.latency)]
    cells.append(_fresh(entry))
    for name in columns:
        mean, _, interval = cell(row.figures.get(name)).partition(" ")
        cells.append(f'{mean}<br><span class="interval">{interval}</span>')
    mark = entry.mark
    again = "-" if mark is None else f"verified: {len(mark.flown)} of {mark.episodes}"
    cells += [str(failed), again, html.escape(entry.hardware)]
    cells.append(f"<code>{html.escape(plan.command)}</code>")
    return "".join(f"<td>{text}</td>" for text in cells)


def _fresh(entry: Submission) -> str:
    """Return the figure in episodes that its authors cannot have known."""
    if entry.entry.entry_class is EntryClass.HUMAN:
        return "none: people fly once"
    found = None if entry.mark is None else entry.mark.fresh
    if found is None:
        return "none: may be learned by heart"
    interval = f"[{found.low:.3f}, {found.high:.3f}], n {found.episodes}"
    claim = "" if found.confirmed else "<br>the claim is outside"
    return f'{found.mean:.3f}<br><span class="interval">{interval}{claim}</span>'


def _policy(entry: Submission) -> str:
    """Return what an entry says of itself."""
    plan, card = entry.stamp.plan, entry.card
    lines = [html.escape(plan.policy) + (" (drawn)" if plan.sampled else "")]
    if card is not None:
        name = html.escape(card.name)
        if card.link is not None:
            name = f'<a href="{html.escape(card.link)}" rel="nofollow noopener">{name}</a>'
        lines.insert(0, name)
        said = {"trained on": card.trained_on, "license": card.license, "": card.remarks}
        lines += [html.escape(", ".join(card.authors))] if card.authors else []
        lines += [html.escape(f"{key} {text}".strip()) for key, text in said.items() if text]
    if card is not None and (own := card.people) is not None:
        wait = "" if own.picture_ms is None else f", shown after {own.picture_ms:g} ms"
        lines.append(
            html.escape(
                f"people: {own.people}; {own.attempts} flights, {own.left} left early; "
                f"{', '.join(own.devices)}; pictures {own.picture}{wait}"
            )
        )
    if entry.stamp.policy:
        lines.append(f"<code>{html.escape(entry.stamp.policy)}</code>")
    return "<br>".join(lines)


def _page(body: str) -> str:
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Eyas leaderboard</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f"<h1>Eyas leaderboard</h1>\n<p>{FIRST_LINE}</p>\n<p>{FIGURES}</p>\n"
        f"{body}\n</body>\n</html>\n"
    )
