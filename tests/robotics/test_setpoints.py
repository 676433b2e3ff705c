"""The velocity that a set point asks for."""

import math
from itertools import pairwise
from types import SimpleNamespace

import pytest

from eyas.robotics.mavlink.setpoints import Goal, SpeedLimits, toward

LIMITS = SpeedLimits(cruise=12.0, most=20.0, up=3.0, down=1.0, acceleration=4.0)


def place(east=0.0, yaw=0.0):
    return SimpleNamespace(commanded=(east, 0.0, 0.0), commanded_yaw=yaw, yaw=yaw)


@pytest.mark.parametrize("degrees", [0, 30, 90, 200])
def test_velocities_of_the_body_turn_with_its_heading(degrees):
    yaw = math.radians(degrees)
    (east, north, _), _ = toward(Goal(velocity=(2.0, 1.0, 0.0), body=True), place(yaw=yaw), LIMITS)
    ahead = east * math.cos(yaw) + north * math.sin(yaw)
    left = north * math.cos(yaw) - east * math.sin(yaw)
    assert (ahead, left) == pytest.approx((2.0, 1.0))


def test_it_slows_down_before_a_place_no_harder_than_it_can_brake():
    goal, step = Goal(position=(0.0, 0.0, 0.0)), 0.01
    speeds = [toward(goal, place(east=-step * k), LIMITS)[0][0] for k in range(1, 4000)]
    assert speeds[-1] == LIMITS.cruise
    assert all(near <= far + 1e-12 for near, far in pairwise(speeds))
    brakes = [0.5 * (far + near) * (far - near) / step for near, far in pairwise(speeds)]
    assert 0.5 * LIMITS.acceleration < max(brakes) < LIMITS.acceleration


def test_height_and_speed_keep_their_limits():
    (east, north, up), _ = toward(Goal(velocity=(30.0, 40.0, 9.0)), place(), LIMITS)
    assert (math.hypot(east, north), up) == pytest.approx((20.0, 3.0))
    assert toward(Goal(velocity=(0.0, 0.0, -9.0)), place(), LIMITS)[0][2] == -1.0
