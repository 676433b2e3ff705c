"""Exact following: the body is put at a pose."""

import math

import pytest


def test_rates_are_differences_over_two_milliseconds(drone):
    drone.start(0.0, 0.0, 0.0)
    drone.carry(0.02, 0.0, 0.0, 3.1)
    rows = drone.carry(0.05, 0.0, 0.0, -3.1)
    assert rows.velocity[0] == pytest.approx(15.0)
    assert rows.acceleration[0] == pytest.approx(2500.0)
    # From 3.1 to -3.1 it is a short way through pi, to the left.
    assert rows.angular_velocity[2] == pytest.approx((2 * math.pi - 6.2) / 0.002)
    assert drone.trackers.commanded_yaw[1] == -3.1
    assert rows.orientation == pytest.approx([math.cos(1.55), 0.0, 0.0, -math.sin(1.55)])
    assert list(rows.position) == list(rows.commanded_position) == [0.05, 0.0, 0.0]


def test_the_gimbal_keeps_its_angle_while_the_body_is_carried(drone):
    drone.start(pitch=1.2)
    for step in range(50):
        rows = drone.carry(0.1 * step, 0.0, 20.0, 0.05 * step)
        assert rows.gimbal == pytest.approx([0.0, 1.2, 0.0], abs=1e-12)


def test_a_carried_drone_flies_on_from_where_it_is(drone):
    drone.start()
    drone.carry(3.0, 4.0, 25.0, 0.5)
    rows = drone.advance(steps=3)
    assert rows.position == pytest.approx([3.0, 4.0, 25.0])
    assert rows.euler[2] == pytest.approx(0.5)
