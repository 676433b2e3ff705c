"""Figures and their intervals, on samples whose truth is known."""

import numpy as np
import pytest

from eyas.evaluation.statistics import (
    estimate,
    improvement,
    interquartile_mean,
    restricted_mean,
    stratified_resamples,
    survival,
)


def test_the_interquartile_mean_leaves_out_a_quarter_at_each_end():
    assert interquartile_mean(np.array([9.0, 1.0, 2.0, 3.0])) == 2.5
    # Computed once with rliable 1.2 (scipy.stats.trim_mean).
    assert interquartile_mean(np.array([0.1, 0.9, 0.4, 0.35, 0.8, 0.2, 0.6])) == pytest.approx(0.47)


def test_resamples_keep_the_size_of_each_stratum():
    strata = ["a"] * 3 + ["b"] * 5
    drawn = stratified_resamples(strata, 50)
    assert drawn.shape == (50, 8)
    assert ((drawn < 3).sum(axis=1) == 3).all()
    assert np.array_equal(drawn, stratified_resamples(strata, 50))


@pytest.mark.parametrize("per_stratum", [10, 40])
def test_the_interval_holds_the_true_mean_about_as_often_as_it_says(per_stratum):
    """Skewed scores in four strata with different means, as those of episodes are."""
    rng, held, tries = np.random.default_rng(1), 0, 200
    strata = np.repeat(np.arange(4), per_stratum).tolist()
    for _ in range(tries):
        values = rng.beta(4.0, 1.5, len(strata)) + np.array(strata)
        low, high = estimate(values.tolist(), strata).mean_interval
        held += low <= 4.0 / 5.5 + 1.5 <= high
    assert 0.90 <= held / tries <= 0.99


def test_pairs_that_are_equal_count_half():
    assert improvement([1.0, 2.0, 3.0, 4.0], [2.0, 2.0, 3.0, 3.0]) == 0.5
    assert improvement([0.0, 0.0], [1.0, 2.0]) == 1.0


def test_the_survival_curve_is_that_of_a_textbook():
    """Kaplan-Meier by hand: 6 at risk, events at 1 and 3 (two), 4 and 5 are censored."""
    times, ended = [1.0, 3.0, 3.0, 4.0, 5.0, 2.0], [True, True, True, False, False, False]
    at, left = survival(times, ended)
    assert at.tolist() == [0.0, 1.0, 3.0]
    assert left.tolist() == pytest.approx([1.0, 5 / 6, 5 / 6 * 2 / 4])
    assert restricted_mean(times, ended, 5.0) == pytest.approx(1 + 2 * 5 / 6 + 2 * 5 / 12)


def test_without_losses_the_restricted_mean_is_the_whole_time():
    assert restricted_mean([3.0, 3.0], [False, False], 3.0) == 3.0
    assert restricted_mean([0.0, 0.0], [True, True], 3.0) == 0.0


def test_leaving_out_what_was_never_lost_would_be_too_short():
    """Exponential times cut off at 2: the estimate is that of the true distribution."""
    rng = np.random.default_rng(3)
    true = rng.exponential(2.0, 4000)
    watched = np.minimum(true, 2.0)
    estimated = restricted_mean(watched.tolist(), (true < 2.0).tolist(), 2.0)
    assert estimated == pytest.approx(2.0 * (1.0 - np.exp(-1.0)), rel=0.03)
    assert watched[true < 2.0].mean() < 0.75 * estimated
