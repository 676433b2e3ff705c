"""Losses and finds, from hand-made views; a control step is 0.1 s, so a loss is 5 steps."""

import numpy as np
import pytest

from eyas.benchmark.flight.meter import watched


def of(text, *, broken_off=False):
    return watched(np.array([each == "x" for each in text]), 0.1, broken_off=broken_off)


def test_a_target_that_stays_is_never_lost():
    found = of("xxxxxxxxxx")
    assert (found["lost_after"], found["losses"], found["found_after"]) == (None, 0, 0.0)
    assert found["watched"] == pytest.approx(1.0)


def test_a_short_gap_is_no_loss():
    assert of("xxx....xxx")["losses"] == 0


def test_a_loss_begins_where_the_target_leaves_and_ends_where_it_is_back():
    found = of("xx.....xxx......x")
    assert found["lost_after"] == pytest.approx(0.2)
    assert found["watched"] == pytest.approx(0.2)
    assert (found["losses"], found["found_again"]) == (2, 2)
    assert found["search_time"] == pytest.approx(0.55)


def test_the_last_loss_may_never_end():
    found = of("xxx.....")
    assert (found["losses"], found["found_again"], found["search_time"]) == (1, 0, None)


def test_time_counts_from_when_the_target_is_first_found():
    found = of("......xxxx.....")
    assert found["found_after"] == pytest.approx(0.6)
    assert found["losses"] == 1
    assert found["watched"] == pytest.approx(0.4)


def test_a_target_that_is_never_seen():
    found = of("......")
    assert (found["found_after"], found["lost_after"], found["losses"]) == (None, None, 0)


def test_a_crash_loses_the_target():
    found = of("xxxx", broken_off=True)
    assert (found["losses"], found["lost_after"]) == (1, pytest.approx(0.4))
    assert of("xxx.....", broken_off=True)["losses"] == 1
