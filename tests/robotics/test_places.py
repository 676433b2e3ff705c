"""Where vehicles of a fleet stand before they fly."""

import numpy as np
import pytest

from eyas.engine.core.errors import SpawnError
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.robotics.mavlink.fleet import standing_places


def fleet_of(count):
    simulation = build_simulation(
        SimConfig(world={"map": "simpleway-grass"}, same_target=True), together(count)
    )
    simulation.reset()
    return simulation


def test_many_stand_around_the_first_target_apart_from_each_other_the_nearest_first():
    simulation = fleet_of(1500)
    places = standing_places(simulation)[:, :2]
    away = np.linalg.norm(places - simulation.snapshot.targets.position[0, :2], axis=1)
    assert (np.diff(away) > -1e-6).all()
    assert 60.0 < away[-1] <= 120.0
    apart = np.linalg.norm(places[:200, None] - places[None, :200], axis=2)
    assert apart[~np.eye(200, dtype=bool)].min() > 4.0 - 1e-6


def test_too_many_are_refused_with_the_number_for_which_there_is_room():
    with pytest.raises(SpawnError, match=r"of 3000 find free ground within 120 m.* up to 2\d{3}$"):
        standing_places(fleet_of(3000))
