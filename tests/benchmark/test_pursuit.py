"""The protocol `pursuit`: its drivers, and ratings against them."""

import numpy as np
import pytest

from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.benchmark.statistics.intervals import clusters_of, elo_of
from eyas.engine.behaviours.evader import EvaderDriver


def test_each_fixed_driver_is_flown_and_rated():
    protocol = PROTOCOLS.get("pursuit")
    drivers = {driver.value for driver in EvaderDriver if driver is not EvaderDriver.AGENT}
    assert {*protocol.variants} == {*protocol.ratings} == drivers
    assert protocol.ratings["cruise"] == 1000.0


def test_a_rating_gives_as_many_points_as_were_made():
    clusters = clusters_of(list(range(40)), [0] * 40)
    rated = np.repeat([1000.0, 1200.0], 20)
    even = elo_of(np.repeat([10.0 / 11.0, 0.75], 20), rated, clusters)  # odds of 10 and 3
    assert 1380.0 < even.mean < 1410.0
    rng = np.random.default_rng(0)
    points = (rng.random(40) < 0.5).astype(float)
    spread = elo_of(points, np.full(40, 1000.0), clusters)
    assert spread.interval.low < 1000.0 < spread.interval.high
    assert elo_of(np.ones(40), rated, clusters).mean == pytest.approx(2000.0, abs=1.0)
    assert elo_of(np.ones(40), rated, clusters).interval is None
