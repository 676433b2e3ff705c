"""Figures of a sample of episodes with their uncertainty.

Episodes of one seed have the same traffic and start, so that they are one observation: a cluster.
Variances are those of a stratified sample of clusters, of a figure's influence values: by how much
each episode moves the figure. Which interval is made of them was chosen by simulation on real
records (`tools/interval_coverage.py`): the percentile bootstrap held the truth in 89 % of samples
of 40 instead of 95 %, and lay above it four times as often as below; bias-corrected and accelerated
bootstraps and those of Student's t did better, but not for a policy that fails one time in ten, as
the failures that make the mean are missing in many samples, and so in all their resamples.

Wilson, "Probable inference, the law of succession, and statistical inference" (JASA 1927), with an
effective number of samples as Kott and Carr, "Developing an estimation strategy for a pesticide
data program" (Journal of Official Statistics, 1997); Kaplan and Meier, "Nonparametric estimation
from incomplete observations" (JASA 1958); Greenwood, "The natural duration of cancer" (1926).
"""

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]

LEVEL = 0.95  # Share of repetitions of which the interval should hold the true value
POWER = 0.8  # Share of repetitions in which a difference should be told, see `episodes_to_tell`

_NORMAL, _NORMAL_OF_POWER = 1.959963984540054, 0.8416212335729143
"""Quantiles of the normal distribution: 0.5 (1 + LEVEL), and POWER."""

_STUDENT = 2.372271230299, 2.822498615740, 2.555849679508, 1.589534053394
"""What Student's t adds to the first for one, two, ... inverse degrees of freedom: the expansion of
Cornish and Fisher (1938)."""

FEWEST = 5  # Fewest clusters of which an interval is made, and of which a stratum is one of its own

ENOUGH = 40
"""From so many clusters on, intervals hold about as often as they say (docs/evaluation.md)."""

_UNSEEN = 3.0
"""Rule of three: what none of n clusters shows may still be this share, divided by n, of all."""

_LARGEST_AGAIN = 0.5
"""How many more clusters a variance counts that differ by the largest deviation seen. Without, the
intervals of differences of two good policies held in 89 % of samples of 40; with one, 98 %."""

_WORST = 0.2  # Share of the flights that `worst_fifth` is the mean of


class Interval(NamedTuple):
    """A confidence interval."""

    low: float
    high: float


class Estimate(NamedTuple):
    """A figure of a sample."""

    n: int  # Number of episodes that have it
    seeds: int  # Number of their seeds: the independent observations
    mean: float
    interval: Interval | None  # None if there are too few seeds


@dataclass(frozen=True)
class Clusters:
    """Which of N samples belong together."""

    of: NDArray[np.int64]  # Cluster of each sample, shape (N,)
    strata: NDArray[np.int64]  # Stratum of each of C clusters, shape (C,)

    @property
    def count(self) -> int:
        """C, the number of independent observations."""
        return len(self.strata)

    @property
    def degrees(self) -> int:
        """Degrees of freedom of a variance."""
        return self.count - len(np.unique(self.strata))

    def sums(self, influence: Floats) -> Floats:
        """Return the sum of each cluster's values, shape (C,)."""
        sums: Floats = np.bincount(self.of, influence, minlength=self.count).astype(np.float64)
        return sums

    def variance(
        self,
        influence: Floats,  # By how much each sample moves the figure, times N, shape (N,)
    ) -> float:
        """Return the variance of a figure's mean."""
        sums, total = self.sums(influence), 0.0
        for stratum in np.unique(self.strata):
            own = sums[self.strata == stratum]
            total += len(own) * float(own.var(ddof=1))
        return total / (len(influence) * len(influence))


def clusters_of(keys: Sequence[Hashable], strata: Sequence[Hashable]) -> Clusters:
    """Return the clusters of N samples.

    Strata with fewer than `FEWEST` clusters are pooled, all if the pool would still be too small.

    Args:
        strata: Stratum of each sample; a cluster is in that of its first one.
    """
    number: dict[Hashable, int] = {}
    first: list[Hashable] = []
    for key, stratum in zip(keys, strata, strict=True):
        if key not in number:
            number[key] = len(number)
            first.append(stratum)
    large = {stratum for stratum in first if first.count(stratum) >= FEWEST}
    if 0 < sum(stratum not in large for stratum in first) < FEWEST:
        large = set()
    order = {stratum: place for place, stratum in enumerate(dict.fromkeys(first), 1)}
    own = [order[stratum] if stratum in large else 0 for stratum in first]
    return Clusters(np.array([number[key] for key in keys]), np.array(own))


def interval_of(
    mean: float, variance: float, count: int, degrees: int, high: float | None
) -> Interval | None:
    """Return the interval of a figure that is 0 or more; None if there are too few observations.

    Of a figure with an upper bound: Wilson's interval of a share, with the number of samples whose
    share would have this variance. Of one without: symmetric for the logarithm.
    """
    if count < FEWEST or degrees < 1:
        return None
    wide = _student(degrees)
    if high is None:
        if not (mean > 0.0 and variance > 0.0):
            return None
        factor = float(exact.exp(wide * math.sqrt(variance) / mean))
        return Interval(mean / factor, mean * factor)
    share = min(max(mean / high, 0.0), 1.0)
    # A sample whose values are all equal knows no more than one of as many shares 0 and 1.
    effective = share * (1.0 - share) * high * high / variance if variance > 0.0 else 0.0
    weight = wide * wide / (effective or count)
    middle = (share + 0.5 * weight) / (1.0 + weight)
    half = math.sqrt(share * (1.0 - share) * weight + 0.25 * weight * weight) / (1.0 + weight)
    unseen = min(_UNSEEN / count, 1.0)
    low = min(middle - half, share * (1.0 - unseen))
    top = max(middle + half, share + (1.0 - share) * unseen)
    return Interval(max(low, 0.0) * high, min(top, 1.0) * high)


def mean_of(values: ArrayLike, clusters: Clusters, high: float | None = None) -> Estimate:
    """Return the mean of N samples of 0 or more.

    Args:
        values: The samples, at least one, shape (N,).
    """
    array = np.asarray(values, np.float64)
    mean, spread = float(array.mean()), None
    if clusters.count >= FEWEST:
        influence = array - mean
        variance = clusters.variance(influence)
        if high is None:
            variance += _largest_again(clusters.sums(influence), len(array))
        spread = interval_of(mean, variance, clusters.count, clusters.degrees, high)
    return Estimate(len(array), clusters.count, mean, spread)


def rate_of(events: ArrayLike, times: ArrayLike, clusters: Clusters) -> Estimate:
    """Return how many events N samples have in a unit of their time, not all of which is 0.

    The interval is that of a ratio of two means, linearised, and symmetric for the logarithm.
    """
    count, time = np.asarray(events, np.float64), np.asarray(times, np.float64)
    rate, spread = float(count.sum() / time.sum()), None
    if clusters.count >= FEWEST:
        variance = clusters.variance((count - rate * time) / time.mean())
        spread = interval_of(rate, variance, clusters.count, clusters.degrees, None)
    return Estimate(len(count), clusters.count, rate, spread)


def worst_fifth_of(values: ArrayLike, clusters: Clusters) -> Estimate:
    """Return the mean of the worst fifth of N shares; fractions of a sample count as such."""
    array = np.asarray(values, np.float64)
    size = _WORST * len(array)
    limit = float(np.sort(array)[math.ceil(size) - 1])
    below = np.maximum(limit - array, 0.0)
    mean = limit - float(below.sum()) / size
    # Only the clusters of the fifth say how much it varies.
    count = int(_WORST * clusters.count)
    if count < FEWEST:
        return Estimate(len(array), clusters.count, mean, None)
    influence = (limit - mean) - below / _WORST
    variance = clusters.variance(influence)
    variance += _largest_again(clusters.sums(influence), len(array))
    spread = interval_of(mean, variance, count, count - 1, 1.0)
    return Estimate(len(array), clusters.count, mean, spread)


_ELO = 2.302585092994046 / 400.0  # log(10) / 400, of Elo's scale: 400 points are odds of ten to one
_MOST = 800.0  # Distance to the strongest and the weakest opponent beyond which no rating is given


def elo_of(scores: ArrayLike, opponents: ArrayLike, clusters: Clusters) -> Estimate:
    """Return the rating at which N games would be expected to give as many points as they have
    (Elo 1978, The Rating of Chessplayers).

    Args:
        scores: Points of each game, 0 to 1.
        opponents: Ratings of the opponents.
    """
    points, rated = np.asarray(scores, np.float64), np.asarray(opponents, np.float64)
    low, high = float(rated.min()) - _MOST, float(rated.max()) + _MOST

    def expected(rating: float) -> Floats:
        return 1.0 / (1.0 + exact.exp(_ELO * (rated - rating)))

    for _ in range(60):  # halves the interval to far below a point
        middle = 0.5 * (low + high)
        low, high = (middle, high) if expected(middle).sum() < points.sum() else (low, middle)
    rating, spread = 0.5 * (low + high), None
    hoped = expected(rating)
    slope = _ELO * float((hoped * (1.0 - hoped)).mean())
    if clusters.count >= FEWEST and points.min() < points.max():
        variance = clusters.variance((points - hoped) / slope)
        half = math.sqrt(variance) * _student(clusters.degrees)
        spread = Interval(rating - half, rating + half)
    return Estimate(len(points), clusters.count, rating, spread)


def difference_interval(
    differences: Floats,  # Shape (N,)
    clusters: Clusters,
    high: float | None,
) -> Interval | None:
    """Return the interval of the mean of N paired differences; None if it cannot be had.

    Student's, with a variance that knows of rare large differences which the sample may lack.
    """
    if clusters.count < FEWEST:
        return None
    mean = float(differences.mean())
    largest = _largest_again(clusters.sums(differences), len(differences))
    half = math.sqrt(clusters.variance(differences - mean) + largest)
    half *= _student(clusters.degrees)
    if half == 0.0:
        if high is None:
            return None
        half = high * min(_UNSEEN / clusters.count, 1.0)
    return Interval(mean - half, mean + half)


def episodes_to_tell(differences: Floats, clusters: Clusters) -> int | None:
    """Return how many paired episodes would tell the mean difference from none, with `POWER`.

    Args:
        differences: Shape (N,).

    Returns:
        Their number, to two digits; None if there are too few pairs, or they differ by nothing.
    """
    mean = float(differences.mean())
    if clusters.count < FEWEST or mean == 0.0:
        return None
    wide = (_NORMAL + _NORMAL_OF_POWER) / mean
    needed = len(differences) * clusters.variance(differences - mean) * wide * wide
    return max(int(float(f"{math.ceil(needed):.2g}")), 2 * FEWEST)


def improvement(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the share of pairs of which the second is larger; equal ones count half."""
    difference = np.asarray(second, np.float64) - np.asarray(first, np.float64)
    return float((np.sign(difference) + 1.0).mean() / 2.0)


def survival(times: ArrayLike, ended: ArrayLike) -> tuple[Floats, Floats]:
    """Return the Kaplan-Meier curve.

    Returns:
        The K + 1 times from which each value holds, 0 and those with an event, and the share that
        is left, both of shape (K + 1,).
    """
    events, happened, at_risk = _events(times, ended)
    left = np.concatenate(([1.0], np.cumprod(1.0 - happened / at_risk)))
    return np.concatenate(([0.0], events)), left


def restricted_mean(times: ArrayLike, ended: ArrayLike, horizon: float) -> float:
    """Return the mean time until the event, or until the horizon: the area below the curve."""
    start, left = survival(times, ended)
    stop = np.minimum(np.concatenate((start[1:], [horizon])), horizon)
    return float((left * np.maximum(stop - np.minimum(start, horizon), 0.0)).sum())


def restricted_mean_of(
    times: ArrayLike, ended: ArrayLike, horizon: float, clusters: Clusters
) -> Estimate:
    """Return the mean time until the event, or until the horizon, of N samples."""
    at = np.asarray(times, np.float64)
    mean, spread = restricted_mean(times, ended, horizon), None
    if clusters.count >= FEWEST:
        variance = clusters.variance(_influence(times, ended, horizon))
        spread = interval_of(mean, variance, clusters.count, clusters.degrees, horizon)
    return Estimate(len(at), clusters.count, mean, spread)


def _influence(times: ArrayLike, ended: ArrayLike, horizon: float) -> Floats:
    """Return each sample's influence on the restricted mean, times N (Greenwood's formula)."""
    at, own = np.asarray(times, np.float64), np.asarray(ended, np.bool_)
    events, happened, at_risk = _events(times, ended)
    start, left = survival(times, ended)
    stop = np.minimum(np.concatenate((start[1:], [horizon])), horizon)
    areas = left * np.maximum(stop - np.minimum(start, horizon), 0.0)
    after = np.cumsum(areas[::-1])[::-1][1:]  # area below the curve from each event on
    rest = at_risk - happened
    weight = np.divide(after, rest, out=np.zeros_like(after), where=rest > 0.0)
    ends = own[:, None] & (at[:, None] == events)
    expected = (at[:, None] >= events) * (happened / at_risk)
    moved: Floats = -len(at) * ((ends - expected) * weight).sum(axis=1)
    return moved


def _events(times: ArrayLike, ended: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Return the times with an event, the number of events, and the number left until then."""
    at, happened = np.asarray(times, np.float64), np.asarray(ended, np.bool_)
    events, counts = np.unique(at[happened], return_counts=True)
    at_risk = len(at) - np.searchsorted(np.sort(at), events, side="left")
    return events, counts.astype(np.float64), at_risk.astype(np.float64)


def _largest_again(sums: Floats, total: int) -> float:
    """Return what half a cluster more, as far off as the farthest, adds to a variance."""
    largest = float(np.abs(sums).max()) / total
    return _LARGEST_AGAIN * largest * largest


def _student(degrees: int) -> float:
    """Return the 97.5 % quantile of Student's t, to 0.001 for four degrees or more."""
    more = 0.0
    for term in reversed(_STUDENT):
        more = (more + term) / degrees
    return _NORMAL + more
