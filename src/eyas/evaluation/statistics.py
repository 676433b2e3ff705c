"""Figures of a sample of episodes with their uncertainty.

Interquartile mean and stratified bootstrap as in Agarwal et al., "Deep reinforcement learning at
the edge of the statistical precipice" (NeurIPS 2021); Kaplan and Meier, "Nonparametric estimation
from incomplete observations" (1958).
"""

from collections.abc import Callable, Hashable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Estimate",
    "Interval",
    "estimate",
    "improvement",
    "interquartile_mean",
    "restricted_mean",
    "stratified_resamples",
    "survival",
]

Floats = NDArray[np.float64]
Statistic = Callable[[Floats], Floats]
"""Takes samples along the last axis, shape (..., n); returns a figure of each, shape (...)."""

RESAMPLES = 2000
"""Number of bootstrap samples."""

LEVEL = 0.95
"""Share of repetitions of which the interval should hold the true value."""

SEED = 0
"""Seed of the bootstrap, so that the same records give the same interval."""


class Interval(NamedTuple):
    """A confidence interval."""

    low: float
    high: float


class Estimate(NamedTuple):
    """The figures of a sample."""

    n: int
    mean: float
    iqm: float
    """Interquartile mean."""
    mean_interval: Interval | None
    """None, like the other, if the samples are not independent."""
    iqm_interval: Interval | None


def interquartile_mean(values: Floats) -> Floats:
    """Return the mean of the middle half of the samples on the last axis.

    As SciPy's `trim_mean(values, 0.25)`, which leaves out the whole part of n / 4 at each end.
    """
    n = values.shape[-1]
    cut = n // 4
    middle: Floats = np.sort(values, axis=-1)[..., cut : n - cut].mean(axis=-1)
    return middle


def mean(values: Floats) -> Floats:
    """Return the mean of the samples on the last axis."""
    average: Floats = values.mean(axis=-1)
    return average


def stratified_resamples(
    strata: Sequence[Hashable], resamples: int = RESAMPLES, seed: int = SEED
) -> NDArray[np.int64]:
    """Return indices that take as many samples of each stratum as it has, with replacement.

    Args:
        strata: Stratum of each of n samples.
        resamples: Number of resamples R.
        seed: Seed of the drawing.

    Returns:
        Shape (R, n).
    """
    rng = np.random.default_rng(seed)
    members: dict[Hashable, list[int]] = {}
    for index, stratum in enumerate(strata):
        members.setdefault(stratum, []).append(index)
    sampled = [
        np.array(indices)[rng.integers(len(indices), size=(resamples, len(indices)))]
        for indices in members.values()
    ]
    return np.concatenate(sampled, axis=1)


def interval_of(values: Floats, statistic: Statistic, resamples: NDArray[np.int64]) -> Interval:
    """Return the percentile interval of a figure.

    Args:
        values: n samples.
        statistic: The figure.
        resamples: From `stratified_resamples`.
    """
    tail = 0.5 * (1.0 - LEVEL)
    low, high = np.quantile(statistic(values[resamples]), (tail, 1.0 - tail)).tolist()
    return Interval(low, high)


def estimate(values: Sequence[float], strata: Sequence[Hashable] | None) -> Estimate:
    """Return the figures of a sample.

    Args:
        values: n samples, at least one.
        strata: Stratum of each; None: they are not independent, so that there are no intervals.
    """
    array = np.asarray(values, np.float64)
    middle, iqm = float(array.mean()), float(interquartile_mean(array))
    if strata is None:
        return Estimate(len(array), middle, iqm, None, None)
    resamples = stratified_resamples(strata)
    return Estimate(
        n=len(array),
        mean=middle,
        iqm=iqm,
        mean_interval=interval_of(array, mean, resamples),
        iqm_interval=interval_of(array, interquartile_mean, resamples),
    )


def improvement(first: Sequence[float], second: Sequence[float]) -> float:
    """Return the share of pairs of which the second is larger; equal ones count half."""
    difference = np.asarray(second, np.float64) - np.asarray(first, np.float64)
    return float((np.sign(difference) + 1.0).mean() / 2.0)


def survival(times: ArrayLike, ended: ArrayLike) -> tuple[Floats, Floats]:
    """Return the Kaplan-Meier curve.

    Args:
        times: Time of each event, or until which none had come, n of them.
        ended: Whether the event has come at this time.

    Returns:
        The K + 1 times from which each value holds, 0 and those with an event, and the share that
        is left, both of shape (K + 1,).
    """
    at, happened = np.asarray(times, np.float64), np.asarray(ended, np.bool_)
    events = np.unique(at[happened])
    factors = [
        1.0 - np.count_nonzero(happened & (at == time)) / np.count_nonzero(at >= time)
        for time in events
    ]
    left = np.concatenate(([1.0], np.cumprod(factors)))
    return np.concatenate(([0.0], events)), left


def restricted_mean(times: ArrayLike, ended: ArrayLike, horizon: float) -> float:
    """Return the mean time until the event, or until the horizon: the area below the curve."""
    start, left = survival(times, ended)
    stop = np.minimum(np.concatenate((start[1:], [horizon])), horizon)
    return float((left * np.maximum(stop - np.minimum(start, horizon), 0.0)).sum())
