import math

import numpy as np
import pytest

from eyas.engine.core.frames import rotate, rotate_back, wrap_angle


def test_quarter_turn_about_z_takes_forward_to_left():
    quaternion = np.array([math.cos(math.pi / 4), 0.0, 0.0, math.sin(math.pi / 4)])
    assert rotate(quaternion, 1.0, 0.0, 5.0) == pytest.approx((0.0, 1.0, 5.0))
    assert rotate_back(quaternion, 0.0, 1.0, 5.0) == pytest.approx((1.0, 0.0, 5.0))


def test_positive_turn_about_y_takes_forward_down():
    quaternion = np.array([math.cos(0.2), 0.0, math.sin(0.2), 0.0])
    assert rotate(quaternion, 1.0, 0.0, 0.0) == pytest.approx((math.cos(0.4), 0, -math.sin(0.4)))


def test_rotating_there_and_back_changes_nothing():
    rng = np.random.default_rng(3)
    for _ in range(20):
        quaternion = rng.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        vector = rng.normal(size=3)
        turned = rotate(quaternion, *vector)
        assert np.linalg.norm(turned) == pytest.approx(np.linalg.norm(vector))
        assert rotate_back(quaternion, *turned) == pytest.approx(vector)


@pytest.mark.parametrize("angle", [-1e4, -9.5, -math.pi, -1.0, 0.0, 2.5, math.pi, 3.2, 6.3, 1e4])
def test_wrapped_angle_is_the_same_direction_within_half_a_turn(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi <= wrapped <= math.pi
    assert math.cos(wrapped - angle) == pytest.approx(1.0)


def test_angle_within_half_a_turn_stays_exactly_as_it_is():
    for angle in (0.1, -3.1, math.pi, -math.pi):
        assert wrap_angle(angle) == angle
