"""Two policies in the same episodes: the difference of their figures."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eyas.core.errors import DataFileError
from eyas.evaluation.plan import Stamp
from eyas.evaluation.record import EpisodeRecord
from eyas.evaluation.result import NO_INTERVALS
from eyas.evaluation.rows import FIGURES, groups_of, strata_of
from eyas.evaluation.statistics import (
    Interval,
    improvement,
    interval_of,
    mean,
    stratified_resamples,
)

__all__ = ["COMPARED", "Difference", "differences", "refuse_incomparable", "text_of"]

COMPARED = ("cr", "tsr", "seen", "watched", "losses", "centre_error")
"""The figures that every episode has."""


class Difference(NamedTuple):
    """The second minus the first, in the same episodes."""

    group: str
    name: str
    figure: str
    n: int
    first: float
    """Mean of the first policy."""
    second: float
    """Mean of the second policy."""
    mean: float
    """Mean difference."""
    interval: Interval | None
    """95 %, paired and stratified bootstrap of the mean difference; None if the same seeds are
    flown in several places, since these episodes are not independent."""
    improved: float
    """Share of episodes in which the second has the larger figure; equal ones count half."""


def refuse_incomparable(first: Stamp, second: Stamp, *, across_builds: bool) -> None:
    """Refuse to compare what was flown in different protocols, or by different programs.

    Args:
        first: Of the first evaluation.
        second: Of the second one.
        across_builds: Whether the programs may differ.

    Raises:
        DataFileError: They differ.
    """
    if first.protocol != second.protocol:
        raise DataFileError(
            f"not comparable: '{first.plan.policy}' was flown in protocol {first.plan.protocol} "
            f"{first.protocol}, '{second.plan.policy}' in {second.plan.protocol} {second.protocol}"
        )
    differs = "" if across_builds else first.other_build(second)
    if differs:
        world = "the world differs" if first.build.world != second.build.world else "they differ"
        raise DataFileError(
            f"not comparable: flown by builds {first.build.id} and {second.build.id} of Eyas; "
            f"{world} in {differs}; fly one again, or compare with --across-builds"
        )


def differences(
    first: Sequence[EpisodeRecord], second: Sequence[EpisodeRecord]
) -> list[Difference]:
    """Return the differences in the episodes that both have, for each row of a table.

    Raises:
        DataFileError: They have no episode in common.
    """
    others = {record.name: record for record in second}
    common = [record for record in first if record.name in others]
    if not common:
        raise DataFileError("not comparable: the two have no episode in common")
    found = []
    for group, name, records in groups_of(common, {}):
        strata = strata_of(records)
        resamples = None if strata is None else stratified_resamples(strata)
        for figure in COMPARED:
            read = FIGURES[figure]
            old = np.array([read(record) for record in records], np.float64)
            new = np.array([read(others[record.name]) for record in records], np.float64)
            found.append(
                Difference(
                    *(group, name, figure, len(records)),
                    first=float(old.mean()),
                    second=float(new.mean()),
                    mean=float((new - old).mean()),
                    interval=None if resamples is None else interval_of(new - old, mean, resamples),
                    improved=improvement(old.tolist(), new.tolist()),
                )
            )
    return found


def text_of(found: Sequence[Difference]) -> str:
    """Return a table as text."""
    lines = [("", "n", "figure", "A", "B", "B - A", "95 %", "B larger")]
    lines += [
        (
            "all" if each.group == "all" else f"{each.group} {each.name}",
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
    return "-" if interval is None else f"[{interval.low:+.3f}, {interval.high:+.3f}]"
