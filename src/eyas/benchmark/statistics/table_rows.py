"""The rows of a table: all episodes, and those of each map, condition, target and visibility."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from eyas.benchmark.episodes.episode import SETS_APART
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.statistics.intervals import (
    Clusters,
    Estimate,
    clusters_of,
    difference_interval,
    elo_of,
    mean_of,
    rate_of,
    restricted_mean_of,
    worst_fifth_of,
)


class Figure(NamedTuple):
    """A figure of an episode."""

    read: Callable[[EpisodeRecord], float | None]
    """Reads it from the record; records for which it is None are left out of a row's mean."""
    high: float | None = None  # The largest value that is possible, if there is one
    signed: bool = False  # True if negative values are valid


def figures_of(
    protocol: Protocol, records: Sequence[EpisodeRecord] = (), *, as_published: bool = False
) -> dict[str, Figure]:
    """Return the figures that episodes have.

    Args:
        records: Records with the figures that only this protocol has. Of these, one whose values
            are all from 0 to 1 is a share.
        as_published: Whether CR and TSR are those that the original's code would have printed.
    """
    horizon, steps = protocol.steps * protocol.period, float(protocol.steps)
    found = {
        "cr": Figure(lambda record: record.cr, steps),
        "tsr": Figure(lambda record: record.tsr, 1.0),
        "flawless": Figure(lambda record: float(_is_flawless(record)), 1.0),
        "seen": Figure(lambda record: record.seen, 1.0),
        "visible": Figure(lambda record: record.visible, 1.0),
        "watched": Figure(lambda record: record.watched, horizon),
        "losses": Figure(lambda record: float(record.losses)),
        "found_again": Figure(lambda record: float(record.found_again)),
        "search_time": Figure(lambda record: record.search_time, horizon),
        "crashed": Figure(lambda record: float(record.crashed), 1.0),
        "failed": Figure(lambda record: float(record.error is not None), 1.0),
        "centre_error": Figure(lambda record: record.centre_error),
        "path": Figure(lambda record: record.path),
        "height": Figure(lambda record: record.height),
        "jerk": Figure(lambda record: record.jerk),
    }
    if as_published:
        found["cr"] = Figure(lambda record: record.published.cr, steps)
        found["tsr"] = Figure(lambda record: record.published.tsr, 1.0)
    for name in dict.fromkeys(name for record in records for name in record.figures):
        read = partial(_own_figure, name)
        known = [value for record in records if (value := read(record)) is not None]
        if name in protocol.gaps:
            found[name] = Figure(read, 1.0, signed=True)
        elif all(0.0 <= value <= 1.0 for value in known):
            found[name] = Figure(read, 1.0)
        else:
            found[name] = Figure(read, signed=True)
    return found


def _own_figure(name: str, record: EpisodeRecord) -> float | None:
    return record.figures.get(name)


class TableRow(NamedTuple):
    """A row of a table."""

    group: str  # `all`, `solvable`, `seeds`, `map`, `weather`, `target` or `visibility`
    name: str
    records: list[EpisodeRecord]
    figures: dict[str, Estimate]

    @property
    def label(self) -> str:
        """What stands at the beginning of the printed row."""
        return self.name if self.group == self.name else f"{self.group} {self.name}"


def clusters_in(records: Sequence[EpisodeRecord]) -> Clusters:
    """Return which records are one observation: those of one seed, or of one site.

    They have the same traffic and start in every weather and with every version, so that a lucky
    seed raises all of them; at one site, all targets vanish and come out at the same places.
    """
    sites = [each.variant.partition("@")[2] for each in records]
    keys = [
        (each.map, site) if site else each.seed for each, site in zip(records, sites, strict=True)
    ]
    return clusters_of(
        keys, [0 if site else each.direction for each, site in zip(records, sites, strict=True)]
    )


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


Groups = Mapping[str, Callable[[EpisodeRecord], str]]
"""What each record belongs to, by the name of the group of rows."""


def rows_of(
    records: Sequence[EpisodeRecord], protocol: Protocol, *, as_published: bool = False
) -> list[TableRow]:
    """Return the rows of a table.

    Args:
        as_published: Whether CR and TSR are those that the original's code would have printed, of
            the episodes that it would not have dropped.
    """
    figures = figures_of(protocol, records, as_published=as_published)
    if as_published:
        records = [record for record in records if record.published.cr > 0.0]
    horizon = protocol.steps * protocol.period
    rows = []
    for group, name, chosen in groups_of(records, protocol.groups):
        if chosen:
            found = _means(chosen, figures)
            tsr = [figures["tsr"].read(record) for record in chosen]
            found["worst_fifth"] = worst_fifth_of(np.array(tsr, np.float64), clusters_in(chosen))
            found |= _times(chosen, horizon)
            if protocol.ratings:
                found |= _elo(chosen, protocol)
            if protocol.reference:
                found |= _fall(chosen, records, protocol.reference)
            rows.append(TableRow(group, name, chosen, found))
    return rows


def groups_of(
    records: Sequence[EpisodeRecord], groups: Groups
) -> Iterator[tuple[str, str, list[EpisodeRecord]]]:
    """Yield group, name and records of each row; a group of one row is left out."""
    yield "all", "all", list(records)
    solvable = [record for record in records if record.solvable]
    if 0 < len(solvable) < len(records):
        yield "solvable", "solvable", solvable
    yield from _sets(records)
    labels_of = {
        "map": [record.map for record in records],
        "weather": [record.weather for record in records],
        "target": [record.target for record in records],
        "visibility": thirds(records),
        **{name: [belongs(record) for record in records] for name, belongs in groups.items()},
    }
    for group, labels in labels_of.items():
        for label in sorted(set(labels)) if len(set(labels)) > 1 else ():
            pairs = zip(records, labels, strict=True)
            yield group, label, [record for record, own in pairs if own == label]


def _sets(records: Sequence[EpisodeRecord]) -> Iterator[tuple[str, str, list[EpisodeRecord]]]:
    """Yield group, name and records of each set of seeds, if there are several."""
    ordered = sorted(records, key=lambda record: record.seed)
    starts = [
        number
        for number, (one, next_) in enumerate(pairwise(ordered), 1)
        if next_.seed - one.seed >= SETS_APART // 2
    ]
    for begin, end in pairwise((0, *starts, len(ordered))) if starts else ():
        yield "seeds", f"from {ordered[begin].seed}", ordered[begin:end]


def _is_flawless(record: EpisodeRecord) -> bool:
    return record.found_after is not None and record.losses == 0


def _means(records: list[EpisodeRecord], figures: dict[str, Figure]) -> dict[str, Estimate]:
    found = {}
    for name, figure in figures.items():
        known = [
            (record, value) for record in records if (value := figure.read(record)) is not None
        ]
        if known:
            own, values = zip(*known, strict=True)
            clusters = clusters_in(own)
            if figure.signed:
                spread = difference_interval(np.array(values), clusters, figure.high)
                mean = float(np.mean(values))
                found[name] = Estimate(len(values), clusters.count, mean, spread)
            else:
                found[name] = mean_of(values, clusters, figure.high)
    return found


def _elo(records: Sequence[EpisodeRecord], protocol: Protocol) -> dict[str, Estimate]:
    """Return the rating against the variants with ratings: an episode is a game, of which who
    follows gets the share of the time before the first loss.
    """
    games = [each for each in records if each.variant in protocol.ratings]
    if not games:
        return {}
    horizon = protocol.steps * protocol.period
    scores = [min(each.watched / horizon, 1.0) for each in games]
    ratings = [protocol.ratings[each.variant] for each in games]
    return {"elo": elo_of(scores, ratings, clusters_in(games))}


def _fall(
    chosen: list[EpisodeRecord], records: Sequence[EpisodeRecord], reference: str
) -> dict[str, Estimate]:
    """Return by which share of it the TSR is below that of the reference in the same episodes.

    Its interval is that of a ratio of two means, linearised.
    """
    known = {_start_of(record): record.tsr for record in records if record.variant == reference}
    pairs = [
        (record, known[_start_of(record)])
        for record in chosen
        if record.variant != reference and _start_of(record) in known
    ]
    if not pairs:
        return {}
    own, expected = [record for record, _ in pairs], np.array([value for _, value in pairs])
    values = np.array([record.tsr for record in own])
    if expected.mean() == 0.0:
        return {}
    left = values.mean() / expected.mean()
    falls = 1.0 - left - (values - left * expected) / expected.mean()
    clusters = clusters_in(own)
    spread = difference_interval(falls, clusters, 1.0)
    return {"fall": Estimate(len(own), clusters.count, float(1.0 - left), spread)}


def _start_of(record: EpisodeRecord) -> tuple[object, ...]:
    """Return what the variants of one episode have in common."""
    return record.map, record.weather, record.target, record.seed, record.direction


def _times(records: list[EpisodeRecord], horizon: float) -> dict[str, Estimate]:
    """Return times of which some are censored: until the target is lost (`kept`), and found; and
    how often it is lost while it is followed.

    The times are restricted means of Kaplan-Meier curves.
    """
    seen = [record for record in records if record.found_after is not None]
    finds = [record.found_after is not None for record in records]
    waits = [
        record.duration if record.found_after is None else record.found_after for record in records
    ]
    times = {"to_find": restricted_mean_of(waits, finds, horizon, clusters_in(records))}
    hours = [record.tsr * horizon / 3600.0 for record in records]
    if any(hours):
        losses = [record.losses for record in records]
        times["losses_per_hour"] = rate_of(losses, hours, clusters_in(records))
    if seen:
        lost = [record.lost_after is not None for record in seen]
        watched = [record.watched for record in seen]
        times["kept"] = restricted_mean_of(watched, lost, horizon, clusters_in(seen))
    return times
