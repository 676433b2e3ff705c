"""Swept boxes against the same motion in shapely and in small steps, and analytic cases."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from eyas.engine.task.sweep import NEVER, Sweep, sweep_cylinder, sweep_prism, while_level
from eyas.lanes import interpreted

prism, cylinder, level = map(interpreted, (sweep_prism, sweep_cylinder, while_level))

HALF = 0.403


def sweep(at=(0.0, 0.0, 5.0), motion=(0.0, 0.0, 0.0), yaw=0.0, half=(HALF, HALF, 0.183)):
    return Sweep(*at, *motion, math.cos(yaw), math.sin(yaw), *half)


def touch_of(motion, outline):
    points = np.array(outline, np.float64)
    return prism(motion, points, 0, len(points), 0.0, 1.0)


WALL = [(5.0, -1.0), (5.01, -1.0), (5.01, 1.0), (5.0, 1.0)]
"""One centimetre thin."""


@pytest.mark.parametrize("speed", [40.0, 1000.0, 10_000.0])
def test_nothing_is_fast_enough_to_pass_through_a_thin_wall(speed):
    way = max(speed * 0.002, 0.1)
    begin = 5.0 - HALF - 0.5 * way
    touch = touch_of(sweep(at=(begin, 0.0, 5.0), motion=(way, 0.0, 0.0)), WALL)
    assert touch.share == pytest.approx(0.5)
    assert touch.x == pytest.approx(5.0)
    assert abs(touch.y) <= HALF + 1e-9


def test_a_wall_is_touched_when_the_front_reaches_it_and_not_before():
    for gap, touches in ((1e-6, False), (-1e-6, True)):
        still = sweep(at=(5.0 - HALF - gap, 0.0, 5.0))
        assert (touch_of(still, WALL).share < NEVER) == touches


def test_a_corner_leads_when_the_box_is_turned():
    reach = HALF * math.sqrt(2.0)
    motion = sweep(at=(5.0 - reach - 1.0, 0.0, 5.0), motion=(2.0, 0.0, 0.0), yaw=math.pi / 4)
    touch = touch_of(motion, WALL)
    assert touch.share == pytest.approx(0.5)
    assert (touch.x, touch.y) == pytest.approx((5.0, 0.0))


def test_a_box_that_begins_within_a_solid_touches_it_at_once():
    touch = touch_of(sweep(), [(-9, -9), (9, -9), (9, 9), (-9, 9)])
    assert (touch.share, touch.x, touch.y) == (0.0, 0.0, 0.0)


def test_a_pole_is_touched_at_its_nearest_point():
    pole = np.array([3.0, 0.0, 0.1])
    touch = cylinder(sweep(motion=(4.0, 0.0, 0.0)), pole, 0.0, 1.0)
    assert touch.share == pytest.approx((3.0 - 0.1 - HALF) / 4.0)
    assert (touch.x, touch.y) == pytest.approx((2.9, 0.0))
    # Past a corner: the circle around it decides.
    aside = np.array([3.0, HALF + 0.06, 0.1])
    touch = cylinder(sweep(motion=(4.0, 0.0, 0.0)), aside, 0.0, 1.0)
    assert touch.share == pytest.approx((3.0 - 0.08 - HALF) / 4.0)
    assert (touch.x, touch.y) == pytest.approx((2.92, HALF))
    beside = np.array([3.0, HALF + 0.101, 0.1])
    assert cylinder(sweep(motion=(4.0, 0.0, 0.0)), beside, 0.0, 1.0).share == NEVER


@pytest.mark.parametrize(
    ("z", "down", "share"),
    [
        (5.0, 0.0, (0.0, 1.0)),
        (10.0, 0.0, None),
        (10.0, -10.0, ((10.0 - 0.183 - 8.0) / 10.0, 1.0)),
        (10.0, -100.0, ((10.0 - 0.183 - 8.0) / 100.0, (10.0 + 0.183) / 100.0)),
    ],
)
def test_a_solid_matters_while_the_box_is_as_high(z, down, share):
    start, end = level(sweep(at=(0.0, 0.0, z), motion=(0.0, 0.0, down)), 0.0, 8.0)
    assert (start > end) if share is None else (start, end) == pytest.approx(share)


def star(radii):
    """A polygon that need not be convex, about the origin."""
    angles = np.linspace(0.0, 2 * math.pi, len(radii), endpoint=False)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])


def placed(motion, share):
    """The box at a share of its motion, in shapely."""
    box = shapely.box(
        -motion.half_length, -motion.half_width, motion.half_length, motion.half_width
    )
    turned = rotate(box, math.atan2(motion.sine, motion.cosine), origin=(0, 0), use_radians=True)
    return translate(turned, motion.x + share * motion.motion_x, motion.y + share * motion.motion_y)


numbers = st.integers(-600, 600).map(lambda number: number / 100)


@given(
    radii=st.lists(st.floats(0.3, 4.0), min_size=3, max_size=9),
    place=st.tuples(numbers, numbers),
    way=st.tuples(numbers, numbers),
    yaw=st.floats(-3.0, 3.0),
    sizes=st.tuples(st.floats(0.1, 2.0), st.floats(0.1, 2.0)),
)
def test_touches_are_those_of_the_swept_outline(radii, place, way, yaw, sizes):
    motion = sweep((*place, 0.0), (*way, 0.0), yaw, (*sizes, 1.0))
    outline = star(np.array(radii))
    solid = shapely.Polygon(outline)
    swept = shapely.MultiPoint(
        [*placed(motion, 0).exterior.coords, *placed(motion, 1).exterior.coords]
    ).convex_hull
    apart = solid.distance(swept)
    deep = solid.intersection(swept).area
    assume(apart > 1e-6 or deep > 1e-6)  # rounding decides what only grazes
    touch = touch_of(motion, outline)
    assert (touch.share < NEVER) == (apart == 0.0)
    if touch.share < NEVER:
        assert 0.0 <= touch.share <= 1.0
        box, point = placed(motion, touch.share), shapely.Point(touch.x, touch.y)
        assert box.distance(point) < 1e-6
        assert solid.distance(point) < 1e-6
        before = placed(motion, max(touch.share - 1e-3, 0.0))
        assert touch.share == 0.0 or before.intersection(solid).area < 1e-2
