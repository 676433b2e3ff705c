"""Exact following."""

import math

import numpy as np
import pytest

from eyas.state.tracker import TrackerState
from eyas.trackers.carry import carry_drone, offset_pose
from eyas.trackers.columns import COMMANDED_YAW, MEMORY_COLUMNS


def carried(state, memory, pose):
    carry_drone(
        pose,
        memory,
        state.position[0],
        state.velocity[0],
        state.acceleration[0],
        state.orientation[0],
        state.euler[0],
        state.angular_velocity[0],
        state.commanded_position[0],
    )


def test_an_offset_turns_with_the_target():
    target, offset = np.array([10.0, 20.0, 0.3]), np.array([-5.0, 2.0, 22.0, 0.5])
    x, y, z, yaw = offset_pose(target, 1.0, offset)
    assert math.hypot(x - 10.0, y - 20.0) == pytest.approx(math.hypot(5.0, 2.0))
    assert (math.cos(1.5) * (x - 10.0) + math.sin(1.5) * (y - 20.0)) == pytest.approx(-5.0)
    assert (z, yaw) == pytest.approx((22.3, 1.5))


def test_rates_are_differences_over_two_milliseconds():
    state, memory = TrackerState.create(1), np.zeros(MEMORY_COLUMNS)
    carried(state, memory, (0.02, 0.0, 0.0, 3.1))
    carried(state, memory, (0.05, 0.0, 0.0, -3.1))
    assert state.velocity[0, 0] == pytest.approx(15.0)
    assert state.acceleration[0, 0] == pytest.approx(2500.0)
    # From 3.1 to -3.1 it is a short way through pi, to the left.
    assert state.angular_velocity[0, 2] == pytest.approx((2 * math.pi - 6.2) / 0.002)
    assert memory[COMMANDED_YAW] == -3.1
    assert state.orientation[0] == pytest.approx([math.cos(1.55), 0.0, 0.0, -math.sin(1.55)])
