"""A flight of the demo without its page."""

import numpy as np

from eyas.demo.flight import DemoFlight
from eyas.engine.settings.config import EyasConfig


def test_a_pilot_appears_over_a_target_that_is_far_away_and_flies_to_one_that_is_near():
    flight = DemoFlight(EyasConfig(world={"map": "simpleway-grass"}), vehicles=5)
    trackers = flight.simulation.snapshot.trackers
    start = trackers.position[0].copy()
    for away, appears in ((20.0, False), (45.0, True)):
        flight.simulation.place(np.append(start + np.array((away, 0.0, 10.0)), 0.0)[None])
        assert flight.appear() is appears
        left = float(np.hypot(*(trackers.position[0] - start)[:2]))  # a start is drawn anew
        assert (left < 15.0) is appears
