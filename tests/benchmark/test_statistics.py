"""Figures and their intervals, on samples whose truth is known."""

import json
from pathlib import Path

import numpy as np
import pytest

from eyas.benchmark.statistics.intervals import (
    clusters_of,
    difference_interval,
    episodes_to_tell,
    improvement,
    mean_of,
    restricted_mean,
    restricted_mean_of,
    survival,
    worst_fifth_of,
)

REAL = {
    name: np.array(steps) / 375
    for name, steps in json.loads(
        (Path(__file__).parent / "real_steps_in_view.json").read_text()
    ).items()
}
"""TSR of 400 episodes of shipped policies, of seeds 1,000,000 to 1,000,399."""

DIRECTIONS = np.arange(400) % 4


def alone(count):
    """Each sample is a seed of its own; four strata, as of start directions."""
    return clusters_of(range(count), (np.arange(count) % 4).tolist())


def percentile(values, rng):
    """The usual stratified bootstrap: what was used before."""
    parts = [values[place::4] for place in range(4)]
    sums = sum(part[rng.integers(len(part), size=(300, len(part)))].sum(axis=1) for part in parts)
    return np.quantile(sums / len(values), (0.025, 0.975))


def samples(count, tries, seed=1):
    """Rows of so many real episodes, equally many of each start direction in turn."""
    rng = np.random.default_rng(seed)
    for _ in range(tries):
        yield 4 * rng.integers(100, size=count) + np.arange(count) % 4


@pytest.mark.parametrize("name", ["robust-citystreet-day", "anywhere-village-day"])
@pytest.mark.parametrize("count", [40, 100])
def test_intervals_of_real_episodes_hold_the_truth_as_often_as_they_say(name, count):
    real, tries = REAL[name], 1500
    truth, below, above = real.mean(), 0, 0
    for rows in samples(count, tries):
        low, high = mean_of(real[rows], alone(count), 1.0).interval
        below += high < truth
        above += low > truth
    assert 0.925 <= 1.0 - (below + above) / tries <= 0.98
    assert max(below, above) / tries < 0.05


def test_the_bootstrap_that_is_mostly_used_would_flatter():
    """So the test above can fail: of 40 episodes these lie above the truth far too often."""
    real, rng, tries = REAL["robust-citystreet-day"], np.random.default_rng(2), 600
    bounds = np.array([percentile(real[rows], rng) for rows in samples(40, tries)])
    above = (bounds[:, 0] > real.mean()).mean()
    assert above > 0.05
    assert above + (bounds[:, 1] < real.mean()).mean() > 0.075


def test_two_weathers_of_a_seed_are_one_observation():
    """The same traffic and start: as if independent, the interval would be too narrow."""
    both = np.stack((REAL["robust-citystreet-day"], REAL["robust-citystreet-foggy"]), axis=1)
    assert np.corrcoef(both.T)[0, 1] > 0.4
    truth, tries, held, naive = both.mean(), 1000, 0, 0
    seeds = np.repeat(np.arange(100), 2)
    together = clusters_of(seeds.tolist(), (seeds % 4).tolist())
    apart = clusters_of(range(200), (seeds % 4).tolist())
    for rows in samples(100, tries):
        values = both[rows].ravel()
        for clusters in (together, apart):
            low, high = mean_of(values, clusters, 1.0).interval
            held += clusters is together and low <= truth <= high
            naive += clusters is apart and low <= truth <= high
    assert 0.925 <= held / tries <= 0.98
    assert naive / tries < 0.92
    estimate = mean_of(both[:100].ravel(), together, 1.0)
    assert (estimate.n, estimate.seeds) == (200, 100)


def test_intervals_of_real_differences_hold():
    """The same policy in two weathers, paired."""
    real = REAL["robust-citystreet-foggy"] - REAL["robust-citystreet-day"]
    held, tries = 0, 1500
    for rows in samples(100, tries):
        low, high = difference_interval(real[rows], alone(100), 1.0)
        held += low <= real.mean() <= high
    assert 0.925 <= held / tries <= 0.985


def test_a_perfect_sample_does_not_promise_a_perfect_policy():
    low, high = mean_of([1.0] * 40, alone(40), 1.0).interval
    assert 0.88 < low < 0.93
    assert high == 1.0
    assert mean_of([1.0] * 400, alone(400), 1.0).interval.low > 0.98
    assert mean_of([0.0] * 40, alone(40), 1.0).interval.high > 0.05
    assert worst_fifth_of([1.0] * 40, alone(40)).interval.low < 0.7


def test_a_spoilt_perfect_sample_is_not_surer_than_a_perfect_one():
    spoilt = mean_of([0.997] + [1.0] * 39, alone(40), 1.0).interval
    assert spoilt.low < 0.93


def test_no_interval_is_made_of_too_few_seeds():
    four, five = clusters_of(range(4), [0] * 4), clusters_of(range(5), [0, 0, 1, 1, 1])
    assert mean_of([0.1, 0.9, 0.5, 0.4], four, 1.0).interval is None
    assert difference_interval(np.array([0.1, 0.9, 0.5, 0.4]), four, 1.0) is None
    assert mean_of([0.1, 0.9, 0.5, 0.4, 0.3], five, 1.0).interval is not None
    same_seed = clusters_of([7] * 40, [0] * 40)
    assert mean_of(REAL["robust-citystreet-day"][:40], same_seed, 1.0).interval is None
    assert worst_fifth_of(np.linspace(0, 1, 24), alone(24)).interval is None
    assert worst_fifth_of(np.linspace(0, 1, 25), alone(25)).interval is not None


def test_small_strata_are_pooled():
    large = clusters_of(range(16), [0] * 6 + [1] * 5 + [2] * 3 + [3] * 2)
    assert [large.strata.tolist().count(each) for each in set(large.strata)] == [5, 6, 5]
    assert large.degrees == 13
    left = clusters_of(range(14), [0] * 6 + [1] * 5 + [2] * 3)  # too few to be a pool
    assert set(left.strata) == {0}


def test_variances_are_unbiased_whatever_the_number_of_strata():
    """With the factor n / (n - 1) in each stratum."""
    rng, found = np.random.default_rng(5), []
    clusters = clusters_of(range(20), [place % 4 for place in range(20)])
    for _ in range(4000):
        values = rng.normal(size=20) + 10.0 * np.array([0, 1, 2, 3] * 5)
        found.append(clusters.variance(values - values.mean()))
    assert np.mean(found) == pytest.approx(1.0 / 20, rel=0.03)


def test_figures_without_a_limit_have_intervals_above_0():
    rng = np.random.default_rng(3)
    values = rng.exponential(2.0, 40)
    low, high = mean_of(values, alone(40)).interval
    assert 0.0 < low < values.mean() < high
    assert mean_of([0.0] * 40, alone(40)).interval is None


def test_the_worst_fifth_is_a_mean_of_a_fifth():
    values = np.array([0.0, 0.2, 1.0, 1.0, 0.9, 0.8, 1.0, 1.0, 1.0, 1.0])
    assert worst_fifth_of(values, alone(10)).mean == pytest.approx(0.1)
    assert worst_fifth_of(values[:7], alone(7)).mean == pytest.approx((0.0 + 0.4 * 0.2) / 1.4)
    assert worst_fifth_of([0.5], alone(1)).mean == pytest.approx(0.5)


def test_the_number_of_episodes_that_would_tell_is_the_textbooks():
    """(1.96 + 0.84)^2 (sd / difference)^2, here with a standard deviation of 0.1 of differences."""
    differences = 0.02 + 0.1 * np.array([1.0, -1.0] * 50)
    clusters = clusters_of(range(100), [0] * 100)
    assert episodes_to_tell(differences, clusters) == pytest.approx(7.85 * 25, rel=0.03)
    assert episodes_to_tell(np.zeros(100), clusters) is None
    twice = clusters_of(np.repeat(range(100), 2).tolist(), [0] * 200)
    # Each seed flown twice with the same result: twice the episodes are needed.
    assert episodes_to_tell(np.repeat(differences, 2), twice) == pytest.approx(390, rel=0.03)


def test_rare_large_differences_are_thought_to_be_more_frequent_than_seen():
    """Half a pair more like the largest: without it, 89 of 100 intervals of 40 pairs hold."""
    differences = np.zeros(40)
    differences[3] = 0.8
    low, high = difference_interval(differences, clusters_of(range(40), [0] * 40), 1.0)
    plain = 2.0227 * differences.std(ddof=1) / np.sqrt(40)
    assert high - low == pytest.approx(2.0 * plain * np.sqrt(1.5), rel=1e-3)


def test_equal_pairs_do_not_promise_equal_policies():
    low, high = difference_interval(np.zeros(100), alone(100), 1.0)
    assert (low, high) == pytest.approx((-0.03, 0.03))
    assert difference_interval(np.zeros(100), alone(100), None) is None


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


def test_intervals_of_censored_times_hold_the_truth():
    """Exponential losses; half the flights are cut off before the end, as by a crash."""
    rng, held, tries = np.random.default_rng(4), 0, 600
    for _ in range(tries):
        true, cut = rng.exponential(4.0, 40), np.where(rng.random(40) < 0.5, 1.0, 2.0)
        found = restricted_mean_of(np.minimum(true, cut), true < cut, 2.0, alone(40))
        held += found.interval.low <= 4.0 * (1.0 - np.exp(-0.5)) <= found.interval.high
    assert 0.92 <= held / tries <= 0.98
