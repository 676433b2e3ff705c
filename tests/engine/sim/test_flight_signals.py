"""Signals of flights: bounds stay bounds, lags lag, splines are smooth."""

import numpy as np
import pytest

from eyas.engine.sim.flights.signals import (
    STEP,
    averaged,
    highest,
    later,
    rates_of,
    sampled_at,
    steps_in,
    trailing,
)


def test_a_smoothed_upper_bound_is_one():
    rng = np.random.default_rng(0)
    wild = rng.uniform(0.0, 50.0, 400) * (rng.random(400) < 0.05)
    smooth = averaged(highest(wild, 0.8), 0.8)
    assert (smooth >= wild - 1e-9).all()
    assert rates_of(smooth).second < 0.1 * rates_of(wild).second


def test_smoothing_reaches_no_farther_than_it_says():
    peak = np.zeros(200)
    peak[100] = 1.0
    reached = np.flatnonzero(averaged(peak, 0.6) > 1e-12)
    assert (100 - reached.min()) * STEP <= 0.6
    assert averaged(peak, 0.6).sum() == pytest.approx(1.0)


def test_what_trails_is_late_and_overshoots():
    way = np.zeros((300, 1))
    way[50:] = 10.0
    trailed = trailing(way, 1.5, 0.5)[:, 0]
    assert trailed[60] < 5.0
    assert 11.0 < trailed.max() < 13.0
    assert trailed[-1] == pytest.approx(10.0, abs=0.3)
    steady = np.arange(200.0)[:, None]
    lag = steady - trailing(steady, 1.5, 0.5)
    assert np.ptp(lag) < 0.2 * lag.mean()  # as if it had begun before
    assert later(steady, 0.4)[:, 0].tolist() == (np.arange(200.0) - 10).tolist()


def test_a_spline_keeps_the_rates_of_its_points():
    rng = np.random.default_rng(1)
    points = averaged(rng.normal(size=(100, 3)).cumsum(axis=0), 0.5)
    rates = rates_of(points)
    fine = sampled_at(points, np.arange(1900) * 0.002)
    for order, most in enumerate(rates, 1):
        own = np.linalg.norm(np.diff(fine, n=order, axis=0), axis=1).max() / 0.002**order
        assert own <= most * 1.001


@pytest.mark.parametrize("steady", [False, True])
@pytest.mark.parametrize("seconds", [0.2, 0.6, 9.0])
def test_signals_go_on_beyond_their_ends_as_numpy_pads_them(steady, seconds):
    signal = np.random.default_rng(0).normal(size=(20, 3)).cumsum(axis=0)
    half, smooth = steps_in(seconds) // 3, signal
    how = {"mode": "reflect", "reflect_type": "odd"} if steady else {"mode": "edge"}
    for _ in range(3):
        wide = np.pad(smooth - smooth[0], [(half, half), (0, 0)], **how)
        sums = np.concatenate([np.zeros((1, 3)), wide]).cumsum(axis=0)
        smooth = smooth[0] + (sums[2 * half + 1 :] - sums[: -2 * half - 1]) / (2 * half + 1)
    np.testing.assert_array_equal(averaged(signal, seconds, steady=steady), smooth)
