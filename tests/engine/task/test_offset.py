import math

import numpy as np
import pytest

from eyas.engine.sim.step import offset_pose


def test_an_offset_turns_with_the_target():
    target, offset = np.array([10.0, 20.0, 0.3]), np.array([-5.0, 2.0, 22.0, 0.5])
    x, y, z, yaw = offset_pose(target, 1.0, offset)
    assert math.hypot(x - 10.0, y - 20.0) == pytest.approx(math.hypot(5.0, 2.0))
    assert (math.cos(1.5) * (x - 10.0) + math.sin(1.5) * (y - 20.0)) == pytest.approx(-5.0)
    assert (z, yaw) == pytest.approx((22.3, 1.5))


def test_the_heading_is_wrapped():
    *_, yaw = offset_pose(np.zeros(3), 3.0, np.array([0.0, 0.0, 0.0, 1.0]))
    assert yaw == pytest.approx(4.0 - 2 * math.pi)
