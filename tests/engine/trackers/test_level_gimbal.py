"""The mended gimbal: its joints and the pose of its camera against products of rotations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.engine.trackers.gimbal import camera_pose
from eyas.engine.trackers.level_gimbal import carried_along, level_angles, level_pose
from eyas.lanes import interpreted

_angles, _pose, _carried = map(interpreted, (level_angles, level_pose, carried_along))
_of_original = interpreted(camera_pose)


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    turns = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(turns[axis])


def posed(pose, gimbal, attitude=(1.0, 0.0, 0.0, 0.0)):
    position, rotation = np.zeros(3), np.zeros((3, 3))
    pose(np.array([1.0, 2.0, 3.0]), np.array(attitude), np.array(gimbal), position, rotation)
    return position, rotation


@settings(max_examples=200)
@given(
    st.floats(0.5, 1.5), st.floats(-0.5, 0.5), st.floats(-0.65, 0.65), st.floats(-0.65, 0.65)
)  # fmt: skip
def test_its_joints_keep_the_camera_level_however_the_body_tilts(pitch, yaw, roll, body_pitch):
    gimbal = _angles(pitch, yaw, roll, body_pitch)
    joints = about("z", gimbal[2]) @ about("x", gimbal[0]) @ about("y", gimbal[1])
    seen = about("y", body_pitch) @ about("x", roll) @ joints
    assert seen == pytest.approx(about("z", yaw) @ about("y", pitch), abs=1e-9)
    assert posed(_pose, gimbal)[1] == pytest.approx(joints, abs=1e-12)


def test_its_camera_is_where_its_joints_carry_it():
    roll, pitch, yaw = 0.3, 1.9, -0.7
    link = np.array([0.13, -0.00469654, -0.013]), np.array([0.000625212, -0.00530346, -0.0207448])
    offset = about("y", pitch) @ [0.00754686, 0.0160388, -0.00586401]
    expected = link[0] + about("z", yaw) @ about("x", roll) @ (link[1] + offset)
    place = posed(_pose, (roll, pitch, yaw))[0] - (1, 2, 3)
    assert place == pytest.approx(expected, abs=1e-12)


def test_both_gimbals_are_one_while_the_body_is_level():
    for pitch, yaw in ((0.5, 0.0), (1.37, 0.4), (1.5, -1.0)):
        assert _angles(pitch, yaw, 0.0, 0.0) == pytest.approx((0.0, pitch, yaw), abs=1e-12)
        for ours, theirs in zip(
            posed(_pose, (0.0, pitch, yaw)), posed(_of_original, (0.0, pitch, yaw)), strict=True
        ):
            assert ours == pytest.approx(theirs, abs=1e-12)


def test_each_joint_is_carried_along_by_the_body_s_turn_about_its_axis():
    gimbal, change = np.array([0.4, 1.2, -0.9]), np.array([0.3, -0.2, 0.7])
    to_roll = about("z", gimbal[2])
    to_pitch = to_roll @ about("x", gimbal[0])
    axes = to_roll[:, 0], to_pitch[:, 1], np.array([0.0, 0.0, 1.0])
    assert _carried(gimbal, tuple(change)) == pytest.approx([axis @ change for axis in axes])
