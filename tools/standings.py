"""The leaderboard of what ships with Eyas, of the tables that `eyas reproduce` has to meet."""

from collections.abc import Iterator

from eyas.benchmark.plan.entry import EntryClass, entry_class
from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.report.reproduce.tables import TABLES, Expected, ExpectedRow, Table, expected

__all__ = ["standings"]

SHOWN = ("standard", "unseen", "recover", "evade", "referring")
"""Tables in which policies of several classes fly the same episodes."""


def standings() -> str:
    """Return a section for each table, with the policies of each place, the best first."""
    return "\n\n".join(line for name in SHOWN for line in _sections(TABLES[name], expected(name)))


def _sections(table: Table, said: Expected | None) -> Iterator[str]:
    assert said is not None, table.name
    yield f"## {table.title}\n\n[About it]({table.page}); again: `eyas reproduce {table.name}`"
    places: dict[str, list[tuple[str, str, ExpectedRow]]] = {}
    for row, one in zip(table.rows, said.rows, strict=True):
        policy, _, place = row.label.partition(", ")
        seen = entry_class(open_policy(row.plan.policy, {}))
        places.setdefault(place, []).append((policy, seen, one))
    rank = table.rows[0].plan.rules.rank
    for place, rows in places.items():
        ordered = sorted(rows, key=lambda row: -_mean(row[2], rank))
        ranked = [row for row in ordered if row[1] != EntryClass.PRIVILEGED]
        oracles = [row for row in ordered if row[1] == EntryClass.PRIVILEGED]
        lines = ["| | policy | class | n | " + " | ".join(table.columns) + " | build |"]
        lines.append("|---" * (5 + len(table.columns)) + "|")
        for number, (policy, seen, one) in enumerate((*ranked, *oracles), 1):
            cells = [one.cells.get(name, "-") for name in table.columns]
            head = [str(number) if number <= len(ranked) else "oracle", policy, seen, str(one.n)]
            build = f"`{one.build_id or said.build_id}`"
            lines.append(f"| {' | '.join([*head, *cells, build])} |")
        yield (f"{place[:1].upper()}{place[1:]}:\n\n" if place else "") + "\n".join(lines)


def _mean(row: ExpectedRow, rank: str) -> float:
    return float(row.cells[rank].split(" ")[0])
