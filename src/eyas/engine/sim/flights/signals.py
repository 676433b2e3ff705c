"""Signals over time: smooth them, let them lag, and look them up between their samples.

A flight is a cubic B-spline whose control points are `STEP` apart. It stays within the hull of its
control points, its acceleration is linear between their second differences, and its jerk is a third
difference: what is true of the differences is true at every instant of the flight.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]

STEP = 0.04  # Time between two control points [s]


class Rates(NamedTuple):
    """The largest derivatives of a signal, per second to the first, second and third power."""

    first: float
    second: float
    third: float


def steps_in(seconds: float) -> int:
    """Return the number of steps in a time [s]."""
    return round(seconds / STEP)


def rates_of(signal: Floats) -> Rates:
    """Return the largest derivatives of the spline of a signal, shape (M,) or (M, K)."""
    table = signal.reshape(len(signal), -1)
    found = []
    for _ in range(3):
        table = np.diff(table, axis=0) / STEP
        found.append(float(np.linalg.norm(table, axis=1).max(initial=0.0)))
    return Rates(*found)


def averaged(signal: Floats, seconds: float, *, steady: bool = False) -> Floats:
    """Return a signal smoothed by three moving averages that reach so far to both sides together.

    No value comes from farther away, so that an upper bound over that reach stays one.

    Args:
        signal: Shape (M, ...).
        seconds: How far a value reaches [s].
        steady: Whether it is taken to go on beyond its ends as it goes there, as what moves does;
            else it stays there what it is, as bounds do.
    """
    half = steps_in(seconds) // 3
    if half < 1:
        return np.array(signal, np.float64)
    smooth, width = np.asarray(signal, np.float64), 2 * half + 1
    for _ in range(3):
        # Sums of differences from the first value keep the digits of large coordinates.
        wide = _extended(smooth - smooth[0], half, steady=steady)
        sums = np.cumsum(np.concatenate([np.zeros_like(wide[:1]), wide]), axis=0)
        smooth = smooth[0] + (sums[width:] - sums[:-width]) / width
    return smooth


def _extended(signal: Floats, by: int, *, steady: bool) -> Floats:
    """Return a signal with so many values more at both ends, see `averaged`, as `np.pad` has them,
    which takes five times as long.
    """
    if by >= len(signal):  # it is reflected more than once
        how = {"mode": "reflect", "reflect_type": "odd"} if steady else {"mode": "edge"}
        ends = [(by, by), *[(0, 0)] * (signal.ndim - 1)]
        return np.pad(signal, ends, **how)  # type: ignore[call-overload, no-any-return]
    first, last = signal[:1], signal[-1:]
    if steady:
        before, after = 2 * first - signal[by:0:-1], 2 * last - signal[-2 : -by - 2 : -1]
    else:
        before, after = np.repeat(first, by, axis=0), np.repeat(last, by, axis=0)
    return np.concatenate([before, signal, after])


def highest(signal: Floats, seconds: float) -> Floats:
    """Return the largest value within a time [s] before and after each, shape (M,)."""
    half = steps_in(seconds)
    wide = np.pad(signal, half, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(wide, 2 * half + 1)
    largest: Floats = windows.max(axis=1)
    return largest


def later(signal: Floats, seconds: float) -> Floats:
    """Return a signal, shape (M, K), that comes later by a time [s], and was as steady before."""
    by = steps_in(seconds)
    if by == 0:
        return np.array(signal)
    before = signal[0] + (signal[1] - signal[0]) * np.arange(-by, 0)[:, None]
    return np.concatenate([before, signal[:-by]])[: len(signal)]


def trailing(
    signal: Floats,  # Shape (M, K)
    frequency: float,  # Undamped natural frequency [rad/s]
    damping: float,  # Damping ratio; below 1 it overshoots
) -> Floats:
    """Return how something with inertia goes after a signal: late, and over it when it turns."""
    speed = (signal[1] - signal[0]) / STEP
    place = signal[0] - speed * (2.0 * damping / frequency)
    trailed = np.empty_like(signal)
    for step, goal in enumerate(signal):
        pull = frequency * frequency * (goal - place) - 2.0 * damping * frequency * speed
        speed = speed + STEP * pull
        place = place + STEP * speed
        trailed[step] = place
    return trailed


def tremor(count: int, columns: int, size: float, rng: np.random.Generator) -> Floats:
    """Return a slow unrest of some size, shape (M, K), of waves of 2 to 10 s."""
    time = np.arange(count) * STEP
    unrest = np.zeros((count, columns))
    for column in range(columns):
        for period in rng.uniform(2.0, 10.0, 3).tolist():
            phase = float(rng.uniform(0.0, 2.0 * math.pi))
            unrest[:, column] += exact.sin(2.0 * math.pi / period * time + phase)
    return unrest * (size / 3.0)


def sampled_at(points: Floats, times: Floats) -> Floats:
    """Return points of the spline of control points, shape (M, K), at times [s], shape (T, K).

    The second point is that of time 0, since a spline is led by the points on both sides.
    """
    last = len(points) - 1
    place = np.maximum(times / STEP, 0.0) + 1.0
    first = np.minimum(place.astype(np.int64), last)
    u = np.minimum(place - first, 1.0)[:, None]
    a, b, c, d = (points[np.clip(first + k, 0, last)] for k in (-1, 0, 1, 2))
    v = 1.0 - u
    weights = (
        v * v * v / 6.0,
        (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
        (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0,
        u * u * u / 6.0,
    )
    sampled: Floats = weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d
    return sampled
