"""The 3D boxes of moving objects."""

import numpy as np
import pytest

from eyas.engine.exports.movement import Movement, box_corners, posed_corners
from eyas.engine.task.direction import TargetDirection

SIZE = np.array([4.0, 2.0, 1.5])


def boxed(slope: float, *, upright: bool) -> np.ndarray:
    still = (np.zeros(3), 0.0, slope, 0.0, TargetDirection.STRAIGHT, 0.4)
    return box_corners(
        np.array([10.0, 20.0, 5.4]), SIZE, np.pi / 2, Movement(*still, upright=upright)
    )


def test_on_level_ground_corners_go_round_from_the_right_of_the_tail():
    corners = boxed(0.0, upright=False)
    plan = [[11.0, 18.0], [11.0, 22.0], [9.0, 22.0], [9.0, 18.0]]
    np.testing.assert_allclose(corners[:, :2], plan * 2, atol=1e-9)
    np.testing.assert_allclose(corners[:, 2], [5.0] * 4 + [6.5] * 4, atol=1e-9)


@pytest.mark.parametrize("upright", [False, True])
def test_on_a_slope_boxes_tilt_except_those_of_who_stays_upright(upright):
    corners = boxed(0.3, upright=upright)
    ahead, left, up = (corners[k] - corners[0] for k in (1, 3, 4))
    assert [np.linalg.norm(edge) for edge in (ahead, left, up)] == pytest.approx(SIZE.tolist())
    assert ahead[2] == pytest.approx(4.0 * np.sin(0.3))  # uphill
    assert left @ ahead == pytest.approx(0.0, abs=1e-9)
    if upright:
        assert up[:2].tolist() == [0.0, 0.0]
    else:
        assert up @ ahead == pytest.approx(0.0, abs=1e-9)
        assert up[1] < 0.0  # leans back
    assert corners[:4].mean(axis=0) == pytest.approx([10.0, 20.0, 5.0])


@pytest.mark.parametrize("upright", [False, True])
def test_the_box_of_a_moment_stands_where_its_limbs_are(upright):
    extent = np.array([[-0.6, -0.3, 0.01], [0.5, 0.4, 1.7]])
    still = (np.zeros(3), 0.0, 0.2, 0.0, TargetDirection.STRAIGHT, 0.4)
    motion = Movement(*still, upright=upright, extent=extent)
    corners = posed_corners(np.array([10.0, 20.0, 5.4]), np.pi / 2, motion)
    assert corners.shape == (8, 3)
    tail_right, head_right, head_left, _ = corners[:4]
    assert head_right[1] - tail_right[1] == pytest.approx(1.1 * (1.0 if upright else np.cos(0.2)))
    assert head_right[0] - head_left[0] == pytest.approx(0.7)  # it heads north
    slope = (head_right[2] - tail_right[2]) / (head_right[1] - tail_right[1])
    assert slope == pytest.approx(np.tan(0.2))
    up = corners[4] - corners[0]
    assert np.linalg.norm(up) == pytest.approx(1.69)
    assert bool(abs(up[1]) < 1e-9) is upright
    assert posed_corners(np.zeros(3), 0.0, Movement(*still)) is None
