"""Two policies in the same episodes: the difference of their figures."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from eyas.benchmark.plan.plan import Stamp
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import NO_INTERVALS
from eyas.benchmark.statistics.intervals import (
    POWER,
    Interval,
    difference_interval,
    episodes_to_tell,
    improvement,
)
from eyas.benchmark.statistics.table_rows import Figure, clusters_in, figures_of, groups_of
from eyas.engine.core.errors import DataFileError

COMPARED = ("cr", "tsr", "flawless", "seen", "watched", "losses", "centre_error")
"""The figures that every episode has; those of the protocol are compared, too."""


class Difference(NamedTuple):
    """The second minus the first, in the same episodes."""

    group: str
    name: str
    figure: str
    n: int
    first: float  # Mean of the first policy
    second: float  # Mean of the second policy
    mean: float  # Mean difference
    interval: Interval | None
    """95 %, of the mean difference; None if there are too few independent seeds."""
    improved: float
    """Share of episodes in which the second has the larger figure; equal ones count half."""
    needed: int | None
    """Number of paired episodes that would tell a difference of this size from none in 80 % of
    cases; None if there is none, or no interval."""


def refuse_incomparable(first: Stamp, second: Stamp, *, across_builds: bool) -> None:
    """Refuse to compare what was flown in different protocols, or by different programs.

    Raises:
        DataFileError: They differ.
    """
    if first.protocol != second.protocol:
        raise DataFileError(
            f"not comparable: '{first.plan.policy}' was flown in protocol {first.plan.protocol} "
            f"{first.protocol}, '{second.plan.policy}' in {second.plan.protocol} {second.protocol}"
        )
    if first.rules != second.rules:
        raise DataFileError(
            f"not comparable: the protocol's code differs: {first.rules} and {second.rules}"
        )
    differs = "" if across_builds else first.other_build(second)
    if differs:
        world = "the world differs" if first.build.world != second.build.world else "they differ"
        raise DataFileError(
            f"not comparable: flown by builds {first.build.id} and {second.build.id} of Eyas; "
            f"{world} in {differs}; fly one again, or compare with --across-builds"
        )


def differences(
    first: Sequence[EpisodeRecord], second: Sequence[EpisodeRecord], protocol: Protocol
) -> list[Difference]:
    """Return the differences in the episodes that both have, for each row of a table.

    Raises:
        DataFileError: They have no episode in common.
    """
    others = {record.name: record for record in second}
    common = [record for record in first if record.name in others]
    if not common:
        raise DataFileError("not comparable: the two have no episode in common")
    figures = figures_of(protocol, [*common, *second])
    compared = (*COMPARED, *dict.fromkeys(name for record in common for name in record.figures))
    found = []
    for group, name, records in groups_of(common, protocol.groups):
        for figure in compared:
            pairs = [(each, others[each.name]) for each in records]
            if row := _difference(figures[figure], pairs):
                found.append(row._replace(group=group, name=name, figure=figure))
    return found


def _difference(
    figure: Figure, pairs: Sequence[tuple[EpisodeRecord, EpisodeRecord]]
) -> Difference | None:
    """Return the difference in those pairs that both have the figure; None if there are none."""
    records, first, second = [], [], []
    for one, other in pairs:
        old, new = figure.read(one), figure.read(other)
        if old is not None and new is not None:
            records.append(one)
            first.append(old)
            second.append(new)
    if not records:
        return None
    change, clusters = np.array(second) - np.array(first), clusters_in(records)
    return Difference(
        group="",
        name="",
        figure="",
        n=len(records),
        first=float(np.mean(first)),
        second=float(np.mean(second)),
        mean=float(change.mean()),
        interval=difference_interval(change, clusters, figure.high),
        improved=improvement(first, second),
        needed=episodes_to_tell(change, clusters),
    )


def verdict(
    found: Sequence[Difference],
    names: tuple[str, str],  # Of the first and the second
    rank: str,  # The protocol's first figure; the other is TSR. Of both, larger is better
) -> Iterator[str]:
    """Yield a line for each figure: which of the two is better, or what it takes to tell."""
    whole = {each.figure: each for each in found if each.group == "all"}
    for figure in dict.fromkeys((rank, "tsr")):
        if figure in whole:
            yield f"{figure}: {_verdict(whole[figure], names)}"


def _verdict(whole: Difference, names: tuple[str, str]) -> str:
    first, second = names
    figures = (
        f"{whole.second:.3f} of {second}, {whole.first:.3f} of {first}, in {whole.n:,} episodes"
    )
    if whole.interval is None:
        return f"too few independent seeds to say which is better ({figures})"
    if whole.mean == 0.0:
        return f"no difference between {first} and {second} in {whole.n:,} episodes"
    if not whole.interval.low <= 0.0 <= whole.interval.high:
        return f"{second if whole.mean > 0.0 else first} is better ({figures})"
    return (
        f"it is open which is better ({figures}); about {whole.needed:,} would tell a difference "
        f"of this size in {POWER:.0%} of cases"
    )


def text_of(found: Sequence[Difference]) -> str:
    """Return a table as text."""
    lines = [("", "n", "figure", "A", "B", "B - A", "95 %", "B larger")]
    lines += [
        (
            each.name if each.group == each.name else f"{each.group} {each.name}",
            str(each.n),
            each.figure,
            f"{each.first:.3f}",
            f"{each.second:.3f}",
            f"{each.mean:+.3f}",
            _interval(each.interval),
            f"{each.improved:.0%}",
        )
        for each in found
    ]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    rows = ([cell.ljust(width) for cell, width in zip(line, widths, strict=True)] for line in lines)
    text = ["  ".join(row).rstrip() for row in rows]
    if any(each.interval is None for each in found):
        text.append(NO_INTERVALS)
    return "\n".join(text)


def _interval(interval: Interval | None) -> str:
    return "[-]" if interval is None else f"[{interval.low:+.3f}, {interval.high:+.3f}]"
