import math

import numpy as np
import pytest

from eyas.engine.trackers.lowpass import low_pass, settle

UNIT_STEP = (0.0445, 0.1924, 0.4100, 0.6236, 0.7973, 0.9200, 0.9955, 1.0339, 1.0471, 1.0453)


def reference(values):
    """The usual form of the original's filter, with its published coefficients."""
    x1 = x2 = y1 = y2 = 0.0
    results = []
    for x in values:
        y = 0.0445267 * x + 0.0890535 * x1 + 0.0445267 * x2 + 1.3207911 * y1 - 0.4988981 * y2
        x1, x2, y1, y2 = x, x1, y, y1
        results.append(y)
    return results


def test_unit_step_response_is_the_original_s():
    memory = np.zeros(2)
    response = [low_pass(memory, 1.0) for _ in UNIT_STEP]
    assert response == pytest.approx(UNIT_STEP, abs=5e-5)


def test_any_signal_gives_what_the_usual_form_gives():
    memory = np.zeros(2)
    signal = np.random.default_rng(0).normal(size=200)
    response = [low_pass(memory, value) for value in signal]
    assert response == pytest.approx(reference(signal), abs=1e-5)


def test_settled_filter_gives_its_value_at_once_and_for_ever():
    memory = np.zeros(2)
    settle(memory, 1.37)
    for _ in range(1000):
        assert low_pass(memory, 1.37) == pytest.approx(1.37, rel=1e-12)


def test_signals_at_39_hertz_lose_3_decibels():
    memory = np.zeros(2)
    omega = 2 * math.pi * 39.2 / 500
    response = [low_pass(memory, math.sin(omega * k)) for k in range(5000)]
    amplitude = math.sqrt(2 * np.mean(np.square(response[2500:])))
    assert amplitude == pytest.approx(math.sqrt(0.5), abs=0.01)
