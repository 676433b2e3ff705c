"""Ways on an open field, where nothing but the edge of the map is in the way."""

from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.behaviours.chain import joints
from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.behaviours.routes import RouteTask, legs, polylines, stops
from eyas.engine.behaviours.timetable import time_of
from eyas.engine.core.rng import stream
from eyas.engine.state.scene import Scene
from eyas.engine.targets.habit import Behaviour

from .habits import HABITS

COUNT = 200


@pytest.fixture(scope="module")
def field() -> GroundObstacles:
    return GroundObstacles(replace(Scene.empty(), size=(400.0, 400.0)), roads=False)


def task(field, kind, seconds=60.0) -> RouteTask:
    lasts = np.full(COUNT, seconds)
    return RouteTask(np.zeros((COUNT, 2)), lasts, HABITS[kind], 0.5, field, stream(3, kind))


def test_polylines_have_two_to_four_corners_within_thirty_metres(field):
    counts, farthest = [], np.zeros(COUNT)
    for k, chain in enumerate(polylines(task(field, "Pedestrian", 1.0))):
        at = joints(chain)
        assert (at.x[-1], at.y[-1]) == pytest.approx((at.x[0], at.y[0]), abs=1e-6)
        counts.append(len(chain.length) // 2)  # a line and an arc for each
        farthest[k] = np.abs([at.x, at.y]).max()
    assert 0.2 < np.bincount(counts, minlength=5)[2:].min() / COUNT
    assert set(counts) == {2, 3, 4}
    assert 29.0 < farthest.max() <= 30.0


def test_a_shrimp_turns_right_after_its_way_and_stops(field):
    habit = HABITS["Shrimp"]
    headings = []
    for chain in stops(task(field, "Shrimp")):
        at = joints(chain)
        assert np.hypot(at.x[1] - at.x[0], at.y[1] - at.y[0]) == pytest.approx(habit.distance)
        assert np.rad2deg(at.yaw[-1] - at.yaw[0]) == pytest.approx(-75.0)
        headings.append(at.yaw[0])
    assert np.ptp(headings) > 6.0  # any direction


def test_who_wanders_turns_at_random_and_who_goes_straight_does_not(field):
    seconds = 60.0
    for kind in ("Create", "Sojourner"):
        habit, wanders = HABITS[kind], HABITS[kind].behaviour is Behaviour.WANDER
        for chain in legs(task(field, kind, seconds), habit.behaviour):
            assert time_of(chain, habit) >= seconds - 1e-6
            assert (chain.spin[1:] != 0.0).all() == wanders or len(chain.spin) == 1
            if wanders:
                assert (chain.length <= 12.0 * habit.speed + 1e-9).all()
                assert len(chain.spin) >= 4
