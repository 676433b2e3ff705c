import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.gimbal import advance_gimbal, camera_pose, held_pitch, reset_gimbal


def about_x(a):
    return np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])


def about_y(a):
    return np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])


def about_z(a):
    return np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])


def quaternion(roll, pitch, yaw):
    """Body to world, of yaw, then pitch, then roll."""
    result = np.array([1.0, 0.0, 0.0, 0.0])
    for axis, angle in ((3, yaw), (2, pitch), (1, roll)):
        turn = np.zeros(4)
        turn[0], turn[axis] = math.cos(angle / 2), math.sin(angle / 2)
        w, v = result[0], result[1:]
        result = np.array(
            [w * turn[0] - v @ turn[1:], *(w * turn[1:] + turn[0] * v + np.cross(v, turn[1:]))]
        )
    return result


def settled(pitch, yaw=0.0, euler=(0.0, 0.0, 0.0)):
    trackers, memory = TrackerState.create(1), np.zeros((1, 3, 2))
    trackers.euler[0] = euler
    reset_gimbal(trackers, memory, 0, pitch, yaw)
    return trackers, memory


def pose(position, orientation, gimbal):
    camera_position, camera_rotation = np.zeros(3), np.zeros((3, 3))
    camera_pose(np.array(position), orientation, np.array(gimbal), camera_position, camera_rotation)
    return camera_position, camera_rotation


def test_gimbal_is_in_place_at_a_reset_and_stays():
    trackers, memory = settled(1.37)
    assert list(trackers.gimbal[0]) == [0.0, 1.37, 0.0]
    for _ in range(200):
        advance_gimbal(trackers, memory, 0)
        assert trackers.gimbal[0] == pytest.approx([0.0, 1.37, 0.0], abs=1e-12)


def test_a_new_command_passes_the_low_pass():
    trackers, memory = settled(0.5)
    trackers.commanded_gimbal[0] = 1.5, -0.7
    advance_gimbal(trackers, memory, 0)
    assert trackers.gimbal[0] == pytest.approx([0.0, 0.5 + 0.0445, -0.7 * 0.0445], abs=5e-5)
    advance_gimbal(trackers, memory, 0)
    assert trackers.gimbal[0] == pytest.approx([0.0, 0.5 + 0.1924, -0.7 * 0.1924], abs=5e-5)


@pytest.mark.parametrize(("asked", "held"), [(0.2, 0.5), (0.5, 0.5), (1.2, 1.2), (1.57, 1.5)])
def test_commanded_pitch_is_held_within_limits(asked, held):
    assert held_pitch(asked) == held
    trackers, _ = settled(asked)
    assert trackers.commanded_gimbal[0, 0] == trackers.gimbal[0, 1] == held


def test_joints_stop_at_their_limits():
    assert settled(1.0, yaw=2.5)[0].gimbal[0, 2] == 1.7
    assert settled(1.0, yaw=-2.5)[0].gimbal[0, 2] == -1.7
    assert settled(0.5, euler=(0.0, 1.2, 0.0))[0].gimbal[0, 1] == -0.5
    assert settled(1.3, euler=(0.0, -0.23, 0.0))[0].gimbal[0, 1] == 1.5


@settings(max_examples=60)
@given(
    st.floats(-0.35, 0.35), st.floats(-0.35, 0.35), st.floats(-3, 3),
    st.floats(0.5, 1.0), st.floats(-0.5, 0.5),
)  # fmt: skip
def test_camera_looks_where_commanded_however_the_body_tilts(roll, body_pitch, heading, pitch, yaw):
    trackers, _ = settled(pitch, yaw, (roll, body_pitch, heading))
    attitude = quaternion(roll, body_pitch, heading)
    _, rotation = pose([0.0, 0.0, 20.0], attitude, trackers.gimbal[0])
    assert rotation == pytest.approx(about_z(heading + yaw) @ about_y(pitch), abs=1e-9)


def test_camera_of_a_level_drone_sits_where_the_original_s_does():
    theta = 1.1
    expected = np.array([0.130625212, -0.01, -0.0337448])
    expected += about_y(theta) @ [0.00754686, 0.0160388, -0.00586401]
    position, rotation = pose([5.0, 6.0, 7.0], quaternion(0, 0, 0), [0.0, theta, 0.0])
    assert position == pytest.approx(expected + np.array([5, 6, 7]), abs=1e-12)
    assert rotation[:, 0] == pytest.approx([math.cos(theta), 0, -math.sin(theta)])


def test_mount_is_the_chain_of_yaw_pitch_and_roll_joint():
    roll, pitch, yaw = 0.3, 0.9, -0.7
    body = about_z(2.0) @ about_y(-0.2) @ about_x(0.4)
    link = np.array([0.13, -0.00469654, -0.013]), np.array([0.000625212, -0.00530346, -0.0207448])
    offset = about_y(pitch) @ [0.00754686, 0.0160388, -0.00586401]
    expected = body @ (link[0] + about_z(yaw) @ (link[1] + offset)) + [1, 2, 3]
    position, rotation = pose([1.0, 2.0, 3.0], quaternion(0.4, -0.2, 2.0), [roll, pitch, yaw])
    assert position == pytest.approx(expected, abs=1e-12)
    turned = body @ about_z(yaw) @ about_y(pitch) @ about_x(roll)
    assert rotation == pytest.approx(turned, abs=1e-12)
