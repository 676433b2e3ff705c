import csv
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from eyas.engine.state.terrain import Plane
from eyas.engine.task.config import RewardMode, RewardType
from eyas.engine.task.ground import ground_corners
from eyas.engine.task.reward import axis_depth, reward_value, rewarded_size, view_centre, view_share

FLOOR = -0.1
FIELD = 0.7854
"""The field of view of the original's camera."""

LEVEL = Plane(0.0, 0.0, FLOOR, 0.0, 0.0)
VECTORS = Path(__file__).parents[2] / "kit" / "reward_vectors.csv"

# Camera, yaw, pitch, target, view range, centre, share, continuous reward.
REGULAR = [
    ((0, 0, 22), 0.3, 1.37, (8, 2), 1.0, (4.2973, 1.3293), 0.510588, 0.487246),
    ((0, 0, 22), 0.3, 1.37, (8, 2), 0.7, (4.2973, 1.3293), 0.286682, 0.093968),
    ((0, 0, 22), 0.3, 1.37, (3, 6), 1.0, (4.2973, 1.3293), 0.482563, 0.421481),
    ((0, 0, 22), 0.3, 1.37, (1, -1), 1.0, (4.2973, 1.3293), 0.429219, 0.306155),
    ((0, 0, 22), 0.3, 1.37, (7, -4), 1.0, (4.2973, 1.3293), 0.378410, 0.213414),
    ((0, 0, 22), 0.3, 1.37, (4, 1), 1.0, (4.2973, 1.3293), 0.943292, 0.997577),
    ((0, 0, 22), 0.3, 1.37, (12, 4), 1.0, (4.2973, 1.3293), 0.0, 0.0),
    ((10, -5, 15), -2.0, 0.8, (7, -22), 1.0, (3.8971, -18.3352), 0.569039, 0.627349),
    ((10, -5, 15), -2.0, 0.8, (6, -13), 0.7, (3.8971, -18.3352), 0.0, 0.0),
    ((10, -5, 15), -2.0, 0.8, (-3, -20), 0.7, (3.8971, -18.3352), 0.231066, 0.049308),
    ((0, 0, 13), 2.9, 0.6, (-26, 9), 1.0, (-18.5921, 4.5812), 0.647175, 0.794766),
    ((0, 0, 13), 2.9, 0.6, (-14, 4), 0.7, (-18.5921, 4.5812), 0.321871, 0.132599),
]

near = st.floats(-25, 25)
in_picture = st.floats(-0.99, 0.99)
anything = st.floats(allow_nan=False, allow_infinity=False)


def evaluate(rules, position, rotation, x, y, ground=LEVEL):
    """Return the reward, the share and the middle of the view for a target on a plane."""
    position = np.array(position, np.float64)
    z = ground.z + ground.rise_east * (x - ground.x) + ground.rise_north * (y - ground.y)
    below = Plane(float(x), float(y), float(z), ground.rise_east, ground.rise_north)
    depth = axis_depth(position, rotation, below)
    middle = view_centre(position, rotation, depth)
    share = view_share(position, rotation, depth, below, rewarded_size(FIELD, rules))
    distance = math.hypot(x - middle[0], y - middle[1])
    return reward_value(share, distance, depth, rules), share, middle


def test_rewards_equal_400_of_the_original_s(rules_with, look):
    with VECTORS.open() as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == 400
    kinds = {
        "discrete": (RewardType.VIEW, RewardMode.DISCRETE),
        "continuous": (RewardType.VIEW, RewardMode.CONTINUOUS),
        "dist_discrete": (RewardType.DISTANCE, RewardMode.DISCRETE),
        "dist_continuous": (RewardType.DISTANCE, RewardMode.CONTINUOUS),
    }
    for row in rows:
        camera, rotation = (row["cx"], row["cy"], row["cz"]), look(row["yaw"], row["pitch"])
        scales = {"view_range": row["lambda"], "view_scale": row["scale"]}
        for column, (type_, mode) in kinds.items():
            rules = rules_with(type=type_, mode=mode, **scales)
            reward, _, middle = evaluate(rules, camera, rotation, row["px"], row["py"])
            assert reward == pytest.approx(row[column], abs=1e-6), (column, row)
            assert middle == pytest.approx((row["f0x"], row["f0y"]), abs=1e-6)


@pytest.mark.parametrize("case", REGULAR)
def test_view_rewards_equal_the_published_table(case, rules_with, look):
    camera, yaw, pitch, target, view_range, centre, share, continuous = case
    rules = rules_with(view_range=view_range)
    reward, got, middle = evaluate(rules, camera, look(yaw, pitch), *target)
    assert middle == pytest.approx(centre, abs=1e-4)
    assert got == pytest.approx(share, abs=1e-6)
    assert reward == pytest.approx(continuous, abs=1e-6)


def inside(polygon, x, y):
    """How far inside a convex counter-clockwise polygon a point is; negative outside [m]."""
    polygon = polygon[:, :2]
    edges = np.roll(polygon, -1, axis=0) - polygon
    offset = np.array([x, y]) - polygon
    cross = edges[:, 0] * offset[:, 1] - edges[:, 1] * offset[:, 0]
    return float(np.min(cross / np.linalg.norm(edges, axis=1)))


@settings(max_examples=150)
@given(st.floats(-3.2, 3.2), st.floats(0.15, 1.57), st.floats(0.3, 1.5), near, near)
def test_a_target_is_rewarded_exactly_where_the_picture_shows_ground(
    rules_with, look, yaw, pitch, view_range, x, y
):
    rules, rotation = rules_with(view_range=view_range), look(yaw, pitch)
    margin = inside(ground_corners((0, 0, 20), rotation, rewarded_size(FIELD, rules), LEVEL), x, y)
    assume(abs(margin) > 1e-6)
    _, share, _ = evaluate(rules, (0, 0, 20), rotation, x, y)
    assert (share > 0) == (margin > 0)


def shown_at(rules, camera, rotation, column, row):
    """Return the ground point at a place of the rewarded rectangle, whose sides are at -1 and 1."""
    half_width, half_height = rewarded_size(FIELD, rules)
    ray = rotation @ [1.0, column * half_width, row * half_height]
    return np.array(camera)[:2] - ray[:2] * (camera[2] - FLOOR) / ray[2]


@settings(max_examples=50)
@given(
    st.floats(-3.2, 3.2), st.floats(0.4, 1.5), in_picture, in_picture, st.floats(0.05, 0.95)
)  # fmt: skip
def test_share_falls_evenly_from_the_middle_to_the_edge(
    rules_with, look, yaw, pitch, column, row, part
):
    rules, rotation = rules_with(view_range=1.0), look(yaw, pitch)
    target = shown_at(rules, (0, 0, 20), rotation, column, row)
    _, whole, middle = evaluate(rules, (0, 0, 20), rotation, *target)
    assert whole > 0.0
    between = np.array(middle) + part * (target - middle)
    _, share, _ = evaluate(rules, (0, 0, 20), rotation, *between)
    assert 1 - share == pytest.approx(part * (1 - whole), abs=1e-9)


# Heading 0, pitch to the horizon, straight down: where the original's slopes give no number.
@pytest.mark.parametrize("yaw", [0.0, math.pi / 2, math.pi, -math.pi / 2, 0.4])
@pytest.mark.parametrize("pitch", [0.01, 0.3012, 0.8, 1.5, math.pi / 2])
def test_target_in_the_middle_has_the_full_share(rules_with, look, yaw, pitch):
    rules, rotation = rules_with(), look(yaw, pitch)
    _, _, middle = evaluate(rules, (3, 4, 20), rotation, 0.0, 0.0)
    reward, share, _ = evaluate(rules, (3, 4, 20), rotation, *middle)
    assert share == pytest.approx(1.0)
    assert reward == pytest.approx(math.tanh(4.0))
    assert evaluate(rules_with(mode=RewardMode.DISCRETE), (3, 4, 20), rotation, *middle)[0] == 1.0


@settings(max_examples=60)
@given(
    st.floats(-3, 3), near, near, st.floats(-3, 3), st.floats(0.5, 1.5), in_picture, in_picture
)  # fmt: skip
def test_moving_and_turning_the_world_changes_nothing(
    rules_with, look, turn, dx, dy, yaw, pitch, column, row
):
    rules, rotation = rules_with(view_range=1.0), look(yaw, pitch)
    x, y = shown_at(rules, (5, -7, 20), rotation, column, row)
    _, share, _ = evaluate(rules, (5, -7, 20), rotation, x, y)
    c, s = math.cos(turn), math.sin(turn)
    camera = (c * 5 + s * 7 + dx, s * 5 - c * 7 + dy, 20)
    target = (c * x - s * y + dx, s * x + c * y + dy)
    _, moved, _ = evaluate(rules, camera, look(yaw + turn, pitch), *target)
    assert 0.0 < share == pytest.approx(moved, abs=1e-9)


@pytest.mark.parametrize("type_", RewardType)
@pytest.mark.parametrize("mode", RewardMode)
@settings(max_examples=60)
@given(
    st.tuples(anything, anything, anything), st.floats(-4, 4), st.floats(-2, 4), anything, anything
)
def test_finite_inputs_give_finite_rewards_between_0_and_1(
    rules_with, look, type_, mode, camera, yaw, pitch, x, y
):
    rules = rules_with(type=type_, mode=mode)
    reward, share, _ = evaluate(rules, camera, look(yaw, pitch), x, y)
    assert 0.0 <= reward <= 1.0
    assert 0.0 <= share <= 1.0


@pytest.mark.parametrize("type_", RewardType)
@pytest.mark.parametrize("pitch", [0.0, -0.4, -math.pi / 2, math.pi])
def test_a_camera_that_does_not_look_down_has_no_reward(rules_with, look, type_, pitch):
    rules = rules_with(type=type_)
    reward, share, middle = evaluate(rules, (3, 4, 20), look(0.5, pitch), 3.1, 4.1)
    assert reward == share == 0.0
    assert middle == (3.0, 4.0)


@pytest.mark.parametrize("pitch", [-0.5, 0.5])
def test_a_camera_below_the_ground_has_no_reward(rules_with, look, pitch):
    reward, share, middle = evaluate(rules_with(), (3, 4, -0.2), look(0.5, pitch), 3.1, 4.1)
    assert reward == share == 0.0
    assert middle == (3.0, 4.0)


def test_distance_reward_ends_at_its_range(rules_with, look):
    rotation = look(0.0, 1.0)
    for mode in RewardMode:
        rules = rules_with(type=RewardType.DISTANCE, mode=mode, distance_scale=0.001)
        middle = evaluate(rules, (0, 0, 20), rotation, 0, 0)[2]
        expected = 1.0 if mode is RewardMode.DISCRETE else 1 - math.tanh(0.001 * 6.9**3)
        assert evaluate(rules, (0, 0, 20), rotation, middle[0], 6.9)[0] == pytest.approx(expected)
        assert evaluate(rules, (0, 0, 20), rotation, middle[0], 7.1)[0] == 0.0


def test_ground_corners_are_the_published_ones_in_order(rules_with, look):
    size = rewarded_size(FIELD, rules_with(view_range=1.0))
    corners = ground_corners((0, 0, 22), look(0.3, 1.37), size, LEVEL)
    expected = [(8.6420, 13.1119), (-4.7237, 7.7358), (0.4694, -9.0518), (14.5361, -5.9421)]
    assert corners[:, :2] == pytest.approx(np.array(expected), abs=1e-4)
    assert (corners[:, 2] == FLOOR).all()


def test_ground_is_cut_off_where_the_picture_shows_the_horizon(rules_with, look):
    size, rotation = rewarded_size(FIELD, rules_with(view_range=1.0)), look(0.5, 0.1)
    corners = ground_corners((3, 4, 20), rotation, size, LEVEL, reach=500.0)
    # Depth in the sense of the rays: 1 m along the axis for each share of the way down.
    depth = (corners - (3, 4, 20)) @ rotation[:, 0]
    assert sorted(depth)[2:] == pytest.approx([500.0, 500.0])
    assert inside(corners, *(np.array([3, 4]) + 100 * rotation[:2, 0])) > 0
    assert len(ground_corners((3, 4, 20), look(0.5, -1.0), size, LEVEL)) == 0
    assert len(ground_corners((3, 4, -0.2), look(0.5, 1.0), size, LEVEL)) == 0
