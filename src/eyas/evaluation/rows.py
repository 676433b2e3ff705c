"""The rows of a table: all episodes, and those of each map, condition, target and visibility."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from eyas.evaluation.record import EpisodeRecord
from eyas.evaluation.statistics import (
    Estimate,
    Interval,
    estimate,
    restricted_mean,
    stratified_resamples,
)

__all__ = ["FIGURES", "TableRow", "groups_of", "rows_of", "strata_of", "thirds"]

Figure = Callable[[EpisodeRecord], float | None]

FIGURES: dict[str, Figure] = {
    "cr": lambda record: record.cr,
    "tsr": lambda record: record.tsr,
    "seen": lambda record: record.seen,
    "visible": lambda record: record.visible,
    "watched": lambda record: record.watched,
    "losses": lambda record: float(record.losses),
    "found_again": lambda record: float(record.found_again),
    "search_time": lambda record: record.search_time,
    "crashed": lambda record: float(record.crashed),
    "failed": lambda record: float(record.error is not None),
    "centre_error": lambda record: record.centre_error,
    "path": lambda record: record.path,
    "jerk": lambda record: record.jerk,
}
"""The figures of an episode; those that are None are left out of a row's mean."""


_RESAMPLES = 500
"""Bootstrap samples of a censored time, each of which takes a curve of its own."""


class TableRow(NamedTuple):
    """A row of a table."""

    group: str
    """`all`, `map`, `weather`, `target` or `visibility`."""
    name: str
    records: list[EpisodeRecord]
    figures: dict[str, Estimate]


def strata_of(records: Sequence[EpisodeRecord]) -> list[tuple[str, str, str, float]] | None:
    """Return the stratum of each record; None if the records are not independent.

    Those of one seed have the same traffic and start in every weather, so that a lucky seed raises
    all of them.
    """
    if len({each.seed for each in records}) < len(records):
        return None
    return [(each.map, each.weather, each.target, each.direction) for each in records]


def thirds(records: Sequence[EpisodeRecord]) -> list[str]:
    """Return the third of visibility of each record: how much of its target can be seen at all.

    Equal shares are in the same third, so that thirds may be of unequal size, or empty: most
    targets are never hidden.
    """
    shares = np.array([record.clear for record in records])
    limits = np.quantile(shares, (1 / 3, 2 / 3), method="higher")
    third = np.searchsorted(limits, shares, side="right")
    names = {}
    for number, name in enumerate(("1 hidden", "2 partly", "3 clear")):
        if len(own := shares[third == number]):
            names[number] = f"{name} {own.min():.3f}-{own.max():.3f}"
    return [names[number] for number in third.tolist()]


def rows_of(
    records: Sequence[EpisodeRecord], horizon: float, *, as_published: bool = False
) -> list[TableRow]:
    """Return the rows of a table.

    Args:
        records: Episode records, at least one.
        horizon: Length of a full episode [s].
        as_published: Whether CR and TSR are those that the original's code would have printed, of
            the episodes that it would not have dropped.
    """
    figures = dict(FIGURES)
    own = dict.fromkeys(name for record in records for name in record.figures)
    figures |= {name: partial(_own_figure, name) for name in own}
    if as_published:
        records = [record for record in records if record.published.cr > 0.0]
        figures["cr"] = lambda record: record.published.cr
        figures["tsr"] = lambda record: record.published.tsr
    return [
        TableRow(group, name, chosen, _figures(chosen, figures) | _times(chosen, horizon))
        for group, name, chosen in groups_of(records)
        if chosen
    ]


def _own_figure(name: str, record: EpisodeRecord) -> float | None:
    return record.figures.get(name)


def groups_of(records: Sequence[EpisodeRecord]) -> Iterator[tuple[str, str, list[EpisodeRecord]]]:
    """Yield group, name and records of each row; a group of one row is left out."""
    yield "all", "all", list(records)
    labels_of = {
        "map": [record.map for record in records],
        "weather": [record.weather for record in records],
        "target": [record.target for record in records],
        "visibility": thirds(records),
    }
    for group, labels in labels_of.items():
        for label in sorted(set(labels)) if len(set(labels)) > 1 else ():
            pairs = zip(records, labels, strict=True)
            yield group, label, [record for record, own in pairs if own == label]


def _figures(records: list[EpisodeRecord], figures: dict[str, Figure]) -> dict[str, Estimate]:
    found = {}
    for name, figure in figures.items():
        known = [(record, value) for record in records if (value := figure(record)) is not None]
        if known:
            own = [record for record, _ in known]
            found[name] = estimate([value for _, value in known], strata_of(own))
    return found


def _times(records: list[EpisodeRecord], horizon: float) -> dict[str, Estimate]:
    """Return times of which some are censored: until the target is lost (`kept`), and found.

    Both are restricted means of Kaplan-Meier curves; `iqm` is the same number.
    """
    seen = [record for record in records if record.found_after is not None]
    finds = [record.found_after is not None for record in records]
    waits = [
        record.duration if record.found_after is None else record.found_after for record in records
    ]
    times = {"to_find": _censored(records, waits, finds, horizon)}
    if seen:
        lost = [record.lost_after is not None for record in seen]
        times["kept"] = _censored(seen, [record.watched for record in seen], lost, horizon)
    return times


def _censored(
    records: list[EpisodeRecord], times: list[float], ended: list[bool], horizon: float
) -> Estimate:
    whole = restricted_mean(times, ended, horizon)
    if (strata := strata_of(records)) is None:
        return Estimate(len(records), whole, whole, None, None)
    at, happened = np.array(times), np.array(ended)
    means = [
        restricted_mean(at[row], happened[row], horizon)
        for row in stratified_resamples(strata, _RESAMPLES)
    ]
    spread = Interval(*np.quantile(means, (0.025, 0.975)).tolist())
    return Estimate(len(records), whole, whole, spread, spread)
