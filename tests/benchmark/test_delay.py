"""Latencies of measured systems."""

import numpy as np
import pytest
from own_policies import TimesOfLooks

from eyas.benchmark.plan.latency import PROFILES, delay_from
from eyas.engine.core.errors import EyasError


@pytest.mark.parametrize("name", PROFILES)
def test_a_profile_has_the_mean_and_the_percentile_that_were_measured(name):
    delay, (rate, mean, p95) = delay_from(name), PROFILES[name]
    delay.begin([5])
    taken = 1e3 * np.array([delay.next(0, 0.0) for _ in range(20_000)])
    assert taken.mean() == pytest.approx(mean, rel=0.02)
    assert np.quantile(taken, 0.95) == pytest.approx(p95, rel=0.02)
    assert delay.period == 1.0 / rate


def test_latencies_of_a_profile_are_the_episodes_own():
    one, both = delay_from("openfly"), delay_from("openfly")
    one.begin([8])
    both.begin([7, 8])
    alone = [one.next(0, 0.0) for _ in range(5)]
    assert [both.next(number, 0.0) for _ in range(5) for number in (0, 1)][1::2] == alone


def test_the_first_measured_answers_are_free_as_libraries_warm_up():
    delay = delay_from("measured")
    for _ in range(2):  # each flight warms up anew
        delay.begin([1])
        assert [delay.next(0, 0.25) for _ in range(5)] == [0.0, 0.0, 0.0, 0.25, 0.25]


def test_a_flight_with_a_profile_repeats_and_is_late(fly):
    late = fly("follow", latency="aerialvla")
    assert late == fly("follow", latency="aerialvla", batch=1)
    prompt = fly("follow")
    assert all(one.cr < other.cr - 20.0 for one, other in zip(late, prompt, strict=True))


def test_a_system_decides_no_faster_than_its_rate(fly):
    """6.2 Hz: a look at most every 162 ms, which are 21 control steps of 8 ms."""
    TimesOfLooks.count.clear()
    fly("own_policies:TimesOfLooks", latency="aerialvla", in_process=True)
    looks = max(TimesOfLooks.count.values())
    assert 10 <= looks <= 18  # 375 / 21 = 17.9
    TimesOfLooks.count.clear()
    fly("own_policies:TimesOfLooks", latency="0", in_process=True)
    assert max(TimesOfLooks.count.values()) == 375


def test_an_unknown_profile_is_told_with_the_nearest():
    with pytest.raises(EyasError, match=r"--latency: 'OpenFly' .* did you mean 'openfly'"):
        delay_from("OpenFly")
