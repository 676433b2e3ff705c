import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.engine.behaviours.chain import chain_of, chain_through, joints, outline
from eyas.engine.behaviours.timetable import ride, time_of
from eyas.engine.targets.habit import Behaviour, Habit

WALK = Habit(Behaviour.POLYLINE, 2.0, 2.0, 2.5, 1.0)
Corner = st.tuples(st.floats(-30, 30), st.floats(-30, 30))


def apart(points) -> bool:
    sides = np.roll(points, -1, axis=0) - points
    return bool((np.hypot(*sides.T) > 0.5).all())


def test_an_arc_leads_along_its_circle():
    chain = chain_of([(0.0, math.pi, 0.5)], (1.0, 2.0, 0.0))
    end = joints(chain)
    assert (end.x[-1], end.y[-1]) == pytest.approx((3.0, 4.0))
    assert end.yaw[-1] == pytest.approx(math.pi / 2)


@settings(max_examples=60, deadline=None)
@given(st.lists(Corner, min_size=2, max_size=5).map(np.array).filter(apart))
def test_a_closed_path_ends_where_it_begins_however_often_it_is_gone_round(points):
    chain = chain_through(points, 1.0, 3)
    end = joints(chain)
    # Bends of less than 1e-5 rad are not turned.
    assert (end.x[-1], end.y[-1]) == pytest.approx((end.x[0], end.y[0]), abs=1e-4)
    # It cuts corners by little, and goes nowhere else.
    away = np.linalg.norm(outline(chain)[:, None] - points, axis=2).min(axis=0)
    assert away.max() < 1.6


@settings(max_examples=60, deadline=None)
@given(st.lists(Corner, min_size=2, max_size=5).map(np.array).filter(apart))
def test_motion_is_the_same_at_once_and_step_by_step_and_within_its_limits(points):
    chain = chain_through(points, 1.0, 2)
    time = np.arange(0.0, min(time_of(chain, WALK), 60.0), 0.02)
    every = ride(chain, WALK, time)
    some = ride(chain, WALK, time[::7])
    for a, b in zip((*every.poses, *every[1:]), (*some.poses, *some[1:]), strict=True):
        assert np.array_equal(np.asarray(a)[::7], b)
    step = np.hypot(np.diff(every.poses.x), np.diff(every.poses.y))
    assert step.max() <= 2.0 * 0.02 + 1e-9
    assert step.sum() == pytest.approx(every.travelled[-1], rel=0.01)
    assert every.speed.max() <= 2.0 + 1e-9
    turned = np.abs(np.diff(every.poses.yaw))
    assert turned.max() <= 2.5 * 0.02 + 1e-6
    moving = every.speed[:-1] > 0.1
    heading = np.arctan2(np.diff(every.poses.y), np.diff(every.poses.x))
    off = np.abs((heading - every.poses.yaw[:-1] + np.pi) % (2 * np.pi) - np.pi)
    assert off[moving].max() < 0.06


def test_a_path_that_ends_is_stood_on():
    chain = chain_of([(0.0, 3.0, 0.0)], (0.0, 0.0, 0.0))
    after = ride(chain, WALK, np.array([time_of(chain, WALK) + 5.0]))
    assert (after.poses.x[0], after.speed[0], after.travelled[0]) == pytest.approx((3.0, 0.0, 3.0))
