import math

import pytest

from eyas.engine.task.direction import TargetDirection, target_centre, target_direction

HEADINGS = [-3.0, -1.0, 0.0, 1.0, 3.0, math.pi, -math.pi]


@pytest.mark.parametrize("yaw", HEADINGS)
def test_turns_have_their_true_sense_at_every_heading(yaw):
    assert target_direction(0.02, 0.0, yaw + 2e-4, yaw, 0.5) == TargetDirection.LEFT
    assert target_direction(0.02, 0.0, yaw - 2e-4, yaw, 0.5) == TargetDirection.RIGHT
    assert target_direction(0.02, 0.0, yaw + 0.5e-4, yaw, 0.5) == TargetDirection.STRAIGHT
    assert target_direction(0.0006, -0.0006, yaw - 0.5e-4, yaw, 0.5) == TargetDirection.STOP


def test_turning_past_west_is_no_jump():
    assert target_direction(0.02, 0.0, -math.pi + 1e-3, math.pi - 1e-3, 0.5) == TargetDirection.LEFT
    assert (
        target_direction(0.02, 0.0, math.pi - 1e-3, -math.pi + 1e-3, 0.5) == TargetDirection.RIGHT
    )


def test_moving_begins_at_half_a_metre_a_second():
    assert target_direction(0.0, 0.00101, 0.0, 0.0, 0.5) == TargetDirection.STRAIGHT
    assert target_direction(0.0, 0.00099, 0.0, 0.0, 0.5) == TargetDirection.STOP


def test_a_slow_kind_moves_at_less():
    assert target_direction(8e-5, 0.0, 0.0, 0.0, 0.01) == TargetDirection.STRAIGHT
    assert target_direction(1e-5, 0.0, 0.0, 0.0, 0.01) == TargetDirection.STOP


def test_centre_of_a_vehicle_is_a_metre_behind_its_reference_point():
    assert target_centre(5.0, 6.0, math.pi / 2, -1.0) == pytest.approx((5.0, 5.0))
    assert target_centre(5.0, 6.0, 1.0, 0.0) == (5.0, 6.0)
