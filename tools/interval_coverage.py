"""How often the intervals of `eyas evaluate` hold the truth, on records of real flights.

    for policy in fast eyas; do for map in citystreet downtown village; do
        eyas evaluate --policy $policy --map $map --episodes 100 --out runs/cover/$policy-$map
    done; done
    python tools/interval_coverage.py runs/cover/*

The 400 episodes of a folder are taken for all that there are, so that the truth is known; of these,
seeds are sampled with replacement, as many of each start direction, thousands of times. Folders
that are joined by a comma are one population, in which a seed has several places:

    python tools/interval_coverage.py runs/cover/eyas-day,runs/cover/eyas-night

With `--differences` each two folders are a pair, of which the difference is estimated. The table
tells the share of intervals that hold the truth, and in brackets the shares that lie wholly below
and wholly above it [%]; 95, 2.5 and 2.5 are promised. `percentile` is the bootstrap that is mostly
used, for comparison.
"""

import argparse
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import load_run
from eyas.benchmark.statistics.intervals import (
    Clusters,
    Interval,
    clusters_of,
    difference_interval,
    mean_of,
    restricted_mean,
    restricted_mean_of,
    worst_fifth_of,
)
from eyas.benchmark.statistics.table_rows import figures_of

SIZES = 12, 40, 100
MEANS = "tsr", "cr", "flawless", "centre_error"
COMPARED = "tsr", "cr", "flawless"

Estimator = Callable[[np.ndarray, Clusters], Interval | None]


class Question(NamedTuple):
    """A figure whose truth is known."""

    name: str
    truth: float
    values: np.ndarray
    """Of each record, shape (R, ...)."""
    interval: Estimator


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--differences", action="store_true")
    parser.add_argument("--samples", type=int, default=2000)
    said = parser.parse_args()
    print("| records | figure | truth |", " | ".join(f"n = {size}" for size in SIZES), "|")
    print("|---" * (3 + len(SIZES)) + "|")
    if said.differences:
        for first, second in zip(said.folders[::2], said.folders[1::2], strict=True):
            name = f"{Path(second).name} - {Path(first).name}"
            seeds, questions = differences(Path(first), Path(second))
            report(name, seeds, questions, said.samples)
        return
    for folders in said.folders:
        name = ", ".join(Path(folder).name for folder in folders.split(","))
        report(name, *figures(list(map(Path, folders.split(",")))), said.samples)


def report(name: str, seeds: dict[float, list], questions: list[Question], samples: int) -> None:
    """Print the rows of a population: one for each question."""
    rng = np.random.default_rng(0)
    misses = {(each.name, size): np.zeros(3) for each in questions for size in SIZES}
    for size in SIZES:
        for _ in range(samples):
            rows, clusters = sampled(seeds, size, rng)
            for each in questions:
                found = each.interval(each.values[rows], clusters)
                known = found is not None
                misses[each.name, size] += (
                    known,
                    known and found.high < each.truth - 1e-9,
                    known and found.low > each.truth + 1e-9,
                )
    for each in questions:
        cells = [told(misses[each.name, size]) for size in SIZES]
        print(f"| {name} | {each.name} | {each.truth:.3f} |", " | ".join(cells), "|", flush=True)


def told(counts: np.ndarray) -> str:
    """Return a cell: share of the intervals that hold, and those below and above the truth."""
    if not counts[0]:
        return "-"
    below, above = 100.0 * counts[1:] / counts[0]
    return f"{100.0 - below - above:.1f} ({below:.1f}, {above:.1f})"


def sampled(
    seeds: dict[float, list[list[int]]], size: int, rng: np.random.Generator
) -> tuple[np.ndarray, Clusters]:
    """Return the rows of a sample of so many seeds, and which of them belong together."""
    rows, keys, strata = [], [], []
    for direction, own in seeds.items():
        for place in rng.integers(len(own), size=size // len(seeds)):
            rows += own[place]
            keys += [len(rows)] * len(own[place])  # a seed that is sampled twice is two
            strata += [direction] * len(own[place])
    return np.array(rows), clusters_of(keys, strata)


def by_direction(records: list[EpisodeRecord]) -> dict[float, list[list[int]]]:
    """Return the rows of each seed, for each start direction."""
    rows = defaultdict(list)
    for number, record in enumerate(records):
        rows[record.direction, record.seed].append(number)
    found = defaultdict(list)
    for (direction, _), own in rows.items():
        found[direction].append(own)
    return found


def figures(folders: list[Path]) -> tuple[dict[float, list], list[Question]]:
    """Return the rows of the seeds in some folders, and the questions."""
    runs = [load_run(folder) for folder in folders]
    rules = runs[0][0].plan.rules
    records = [record for _, own in runs for record in own]
    known, horizon = figures_of(rules), rules.steps * rules.period
    questions = []
    for name in MEANS:
        values = np.array([known[name].read(record) for record in records], np.float64)

        interval = partial(mean_interval, high=known[name].high)
        questions.append(Question(name, float(values.mean()), values, interval))
    tsr = questions[0].values
    questions.insert(0, Question("percentile tsr", float(tsr.mean()), tsr, percentile))
    whole = clusters_of(range(len(tsr)), [0] * len(tsr))
    worst = worst_fifth_of(tsr, whole).mean
    questions.append(
        Question("worst_fifth", worst, tsr, lambda own, by: worst_fifth_of(own, by).interval)
    )
    times = np.array([(record.watched, record.lost_after is not None) for record in records])
    kept = restricted_mean(times[:, 0], times[:, 1] > 0.0, horizon)

    def kept_interval(own: np.ndarray, clusters: Clusters) -> Interval | None:
        return restricted_mean_of(own[:, 0], own[:, 1] > 0.0, horizon, clusters).interval

    questions.append(Question("kept", kept, times, kept_interval))
    return by_direction(records), questions


def differences(first: Path, second: Path) -> tuple[dict[float, list], list[Question]]:
    """Return the rows of the seeds of two folders, and the questions about their difference."""
    (stamp, records), (_, others) = load_run(first), load_run(second)
    named = {record.name: record for record in others}
    known, questions = figures_of(stamp.plan.rules), []
    for name in COMPARED:
        read, high, _ = known[name]
        values = np.array([read(named[record.name]) - read(record) for record in records])
        interval = partial(difference_interval, high=high)
        questions.append(Question(name, float(values.mean()), values, interval))
    return by_direction(records), questions


def mean_interval(values: np.ndarray, clusters: Clusters, high: float | None) -> Interval | None:
    """Return the interval of a mean."""
    return mean_of(values, clusters, high).interval


def percentile(values: np.ndarray, clusters: Clusters, resamples: int = 500) -> Interval:
    """Return the interval of the usual stratified bootstrap of records."""
    rng, strata = np.random.default_rng(1), clusters.strata[clusters.of]
    parts = [values[strata == stratum] for stratum in np.unique(strata)]
    sums = sum(
        part[rng.integers(len(part), size=(resamples, len(part)))].sum(axis=1) for part in parts
    )
    return Interval(*np.quantile(sums / len(values), (0.025, 0.975)).tolist())


if __name__ == "__main__":
    main()
