import math

import numpy as np
import pytest

from eyas.engine.task.spawn import StartValues, start_pose

PLAIN = {
    "pitch": 1.37,
    "height": 22.0,
    "direction": 0.0,
    "horizontal_bias": 0.0,
    "vertical_bias": 0.0,
}


def start(**changes):
    return StartValues(**{**PLAIN, **changes})


def in_drone_frame(position, yaw, target):
    offset = np.asarray(target) - position
    c, s = math.cos(yaw), math.sin(yaw)
    return [c * offset[0] + s * offset[1], -s * offset[0] + c * offset[1], offset[2]]


@pytest.mark.parametrize("target_yaw", [0.0, 2.0, -3.0])
@pytest.mark.parametrize("direction", [0.0, 1.57, -3.0])
@pytest.mark.parametrize(("pitch", "share"), [(1.37, 0.2035), (1.0, 0.642), (0.6, 1.4617)])
def test_target_is_seen_ahead_right_and_below(target_yaw, direction, pitch, share):
    drawn = start(pitch=pitch, direction=direction, horizontal_bias=3.0, vertical_bias=2.0)
    target = (10.0, -5.0, 0.4)
    position, yaw = start_pose(drawn, target, target_yaw, -1.0)
    ahead = share * 22.0 + 1.0 - 2.0
    assert in_drone_frame(position, yaw, target) == pytest.approx([ahead, -3.0, -22.0], abs=3e-3)
    assert math.cos(yaw - target_yaw - direction) == pytest.approx(1.0)
    assert -math.pi <= yaw <= math.pi


def test_targets_that_are_no_vehicles_have_no_compensation():
    position, _ = start_pose(start(), (0.0, 0.0, 0.0), 0.0, ahead=0.0)
    assert position == pytest.approx([-math.tan(math.pi / 2 - 1.37) * 22.0, 0.0, 22.0])


def test_the_place_is_for_the_pitch_as_drawn_even_beyond_the_gimbal_s_limit():
    position, _ = start_pose(start(pitch=math.pi / 2), (0.0, 0.0, 0.0), 0.0, -1.0)
    assert position == pytest.approx([-1.0, 0.0, 22.0])
