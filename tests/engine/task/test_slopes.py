"""Rewards, ends of episodes and packets on a hill: closed forms."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.optics.pinhole import project
from eyas.engine.state.terrain import Plane, Terrain, height_over
from eyas.engine.task.config import RewardMode, RewardType
from eyas.engine.task.done import DoneReason, judge
from eyas.engine.task.ground import ground_corners
from eyas.engine.task.observe import clear_episode, observe
from eyas.engine.task.packet_rows import PacketRows
from eyas.engine.task.reward import axis_depth, rewarded_size, view_centre, view_share

N = 1
FIELD = 0.7854
FLOOR, EAST, NORTH = -0.1, 0.15, -0.25
FLAT = Plane(0.0, 0.0, 0.0, 0.0, 0.0)

tilts = st.tuples(st.floats(-math.pi, math.pi), st.floats(0.0, 0.6))
headings, pitches = st.floats(-math.pi, math.pi), st.floats(0.3, 1.55)


def relief(x, y):
    return 60.0 + EAST * x + NORTH * y


@pytest.fixture(scope="module")
def hill():
    """A hill of constant slope, 200 m wide."""
    at = np.arange(-100.0, 101.0, 5.0)
    return Terrain(FLOOR, relief(at, at[:, None]).astype(np.float32), -100.0, -100.0, 5.0)


def tilt(direction, angle):
    """Return a rotation about a horizontal axis."""
    axis = np.array([math.cos(direction), math.sin(direction), 0.0])
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def tilted(turn, point):
    """Return the plane that the level one through the origin becomes, at one of its points."""
    up = turn[:, 2]
    return Plane(*(float(c) for c in point), float(-up[0] / up[2]), float(-up[1] / up[2]))


def seen(rules, position, rotation, ground):
    """Return depth, middle and share for a target where the plane touches the ground."""
    rotation = np.ascontiguousarray(rotation)
    depth = axis_depth(position, rotation, ground)
    return (
        depth,
        view_centre(position, rotation, depth),
        view_share(position, rotation, depth, ground, rewarded_size(FIELD, rules)),
    )


@settings(max_examples=100)
@given(tilts, headings, pitches, st.floats(-25, 25), st.floats(-25, 25))
def test_tilting_the_whole_world_leaves_the_share_as_it_was(
    rules_with, look, world, yaw, pitch, x, y
):
    rules, turn = rules_with(view_range=1.0), tilt(*world)
    camera, rotation = np.array([2.0, -3.0, 20.0]), look(yaw, pitch)
    assume((turn @ camera)[2] > 0.0)
    level = Plane(x, y, 0.0, 0.0, 0.0)
    depth, middle, share = seen(rules, camera, rotation, level)
    slope = tilted(turn, turn @ [x, y, 0.0])
    moved = seen(rules, turn @ camera, turn @ rotation, slope)
    assert moved[0] == pytest.approx(depth, rel=1e-9)
    assert moved[1] == pytest.approx((turn @ [*middle, 0.0])[:2], abs=1e-6)
    assert moved[2] == pytest.approx(share, abs=1e-9)


@settings(max_examples=60)
@given(tilts, headings, st.floats(-0.2, 1.55))
def test_tilting_the_whole_world_tilts_the_seen_ground_with_it(rules_with, look, world, yaw, pitch):
    size, turn = rewarded_size(FIELD, rules_with(view_range=1.0)), tilt(*world)
    camera, rotation = np.array([2.0, -3.0, 20.0]), look(yaw, pitch)
    level = ground_corners(camera, rotation, size, FLAT, reach=300.0)
    slope = tilted(turn, turn @ [5.0, 6.0, 0.0])
    corners = ground_corners(turn @ camera, turn @ rotation, size, slope, reach=300.0)
    assert corners.shape == level.shape
    np.testing.assert_allclose(corners, level @ turn.T, atol=1e-6)
    assert corners.shape[1] == 3
    for corner in corners.tolist():
        assert height_over(slope, *corner) == pytest.approx(0.0, abs=1e-6)


def test_corners_on_a_slope_lie_at_the_corners_of_the_picture(rules_with, look):
    ground, camera = Plane(3.0, 4.0, 60.0, EAST, NORTH), np.array([3.0, 4.0, 82.0])
    rotation = look(1.0, 1.2)
    size = rewarded_size(FIELD, rules_with(view_range=1.0))
    corners = ground_corners(camera, rotation, size, ground)
    column, row, _ = project(corners, camera, rotation, 320, 240, FIELD)
    assert column == pytest.approx([0, 0, 320, 320], abs=1e-6)
    assert row == pytest.approx([0, 240, 240, 0], abs=1e-6)


def watched(snapshot, hill, rules, look, x, y, height=20.0):
    """Look from over the hill at a target that stands on it at a place; return its episode."""
    trackers, cameras, targets, episodes, _ = snapshot
    place = np.array([10.0, 20.0, FLOOR + relief(10.0, 20.0) + height])
    trackers.position[N] = cameras.position[N] = place
    cameras.rotation[N] = look(0.4, 1.1)
    targets.position[N] = targets.centre[N] = x, y, FLOOR + relief(x, y) + 0.3
    clear_episode(episodes, N)
    size = rewarded_size(FIELD, rules)
    observe(trackers, cameras, targets, episodes, N, hill, rules, size)
    return episodes


def middle_of_view(height=20.0):
    """Where the optical axis of `watched` meets the hill, by walking along it."""
    forward = np.array([math.cos(0.4) * math.cos(1.1), math.sin(0.4) * math.cos(1.1)])
    # height + down * t over the point below, which rises by slope * t.
    t = height / (math.sin(1.1) + EAST * forward[0] + NORTH * forward[1])
    return 10.0 + t * forward[0], 20.0 + t * forward[1]


@pytest.mark.parametrize(
    ("type_", "mode", "best"),
    [
        (RewardType.VIEW, RewardMode.CONTINUOUS, math.tanh(4.0)),
        (RewardType.VIEW, RewardMode.DISCRETE, 1.0),
        (RewardType.DISTANCE, RewardMode.CONTINUOUS, 1.0),
        (RewardType.DISTANCE, RewardMode.DISCRETE, 1.0),
    ],
)
def test_a_target_in_the_middle_of_the_picture_is_rewarded_in_full(
    type_, mode, best, snapshot, hill, rules_with, look
):
    episodes = watched(snapshot, hill, rules_with(type=type_, mode=mode), look, *middle_of_view())
    assert episodes.reward[N] == pytest.approx(best, abs=1e-6)


def test_what_stands_in_the_middle_of_a_flat_view_does_not_on_the_hill(
    snapshot, hill, rules_with, look
):
    reach = 20.0 / math.tan(1.1)
    x, y = 10.0 + reach * math.cos(0.4), 20.0 + reach * math.sin(0.4)
    episodes = watched(snapshot, hill, rules_with(), look, x, y)
    assert 0.1 < episodes.reward[N] < 0.999


def test_a_distance_is_horizontal_and_counts_from_the_middle(snapshot, hill, rules_with, look):
    rules = rules_with(type=RewardType.DISTANCE)
    x, y = middle_of_view()
    episodes = watched(snapshot, hill, rules, look, x + 3.0, y - 2.0)
    expected = 1.0 - math.tanh(0.01 * math.hypot(3.0, 2.0) ** 3)
    assert episodes.reward[N] == pytest.approx(expected, abs=1e-6)


def test_the_middle_of_the_view_lies_on_the_hill_in_state_and_packet(
    snapshot, hill, rules_with, look
):
    x, y = middle_of_view()
    watched(snapshot, hill, rules_with(), look, x + 1.0, y)
    expected = [x, y, FLOOR + relief(x, y)]
    assert snapshot.episodes.view_centre[N] == pytest.approx(expected, abs=1e-4)
    _, packets = PacketRows(snapshot, CameraConfig(), hill).now()
    # The view centre is told in the world frame, all else over the floor.
    assert packets[N, 39:42] == pytest.approx(expected, abs=1e-4)
    assert packets[N, 44] == pytest.approx(relief(x + 1.0, y) + 0.3, abs=1e-4)
    assert packets[N, 47] == pytest.approx(relief(10.0, 20.0) + 20.0, abs=1e-4)


@pytest.mark.parametrize("place", [(-80.0, -80.0), (0.0, 0.0), (77.0, 31.0)])
@pytest.mark.parametrize(
    ("height", "reason"),
    [
        (1.99, DoneReason.HEIGHT),
        (2.01, DoneReason.NONE),
        (49.99, DoneReason.NONE),
        (50.01, DoneReason.HEIGHT),
    ],
)
def test_heights_are_measured_over_the_hill_below(
    place, height, reason, snapshot, hill, rules_with
):
    trackers, _, targets, episodes, _ = snapshot
    episodes.step_count[N], episodes.reward[N] = 500, 1.0
    trackers.position[N] = *place, relief(*place) + height
    trackers.commanded_position[N] = trackers.position[N]
    assert judge(trackers, targets, episodes, N, hill, rules_with()) == reason
