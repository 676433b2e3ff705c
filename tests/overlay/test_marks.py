"""What an overlay shows of a tracker, on the shipped map and traffic."""

import numpy as np
import pytest

from eyas.core.pinhole import project
from eyas.overlay.marks import chase_pose
from eyas.sim.build import build_simulation
from eyas.sim.config import SimConfig
from eyas.state.draw import Picture
from eyas.state.tracker import CameraPose
from eyas.task.config import RewardConfig, RewardType, StartConfig
from eyas.task.reward import axis_depth, view_centre, view_share

CONFIG = SimConfig(start=StartConfig(pitch=1.2, height=22.0))
FIRST = np.zeros(1, np.int32)


def started(config: SimConfig = CONFIG, count: int = 1, *, shared: bool = False):
    simulation = build_simulation(config, count, shared_world=shared)
    simulation.reset()
    return simulation


def overlay_of(simulation, trackers=None):
    return simulation._projection.of(0, trackers)


def chased(simulation, size=(120, 160), *, overlay=True) -> Picture:
    picture = Picture.create(1, *size)
    viewpoint = chase_pose(CameraPose(simulation.cameras.position, simulation.cameras.rotation))
    one = CameraPose(viewpoint.position[:1], viewpoint.rotation[:1])
    simulation.draw_from(FIRST, one, picture, overlay=overlay)
    return picture


def test_only_the_colours_change_and_draw_stays_clean():
    simulation = started()
    wanted = {"depth": True, "object_id": True, "subject": True, "class_id": True}
    clean, overlaid, again = (Picture.create(1, 60, 80, **wanted) for _ in range(3))
    simulation.draw(FIRST, clean)
    simulation.draw_overlaid(FIRST, overlaid)
    simulation.draw(FIRST, again)
    for name in ("depth", "object_id", "subject_box", "subject_pixels", "class_id"):
        assert np.array_equal(getattr(clean, name), getattr(overlaid, name))
    assert np.array_equal(clean.rgb, again.rgb)
    assert (clean.rgb != overlaid.rgb).any(axis=-1).mean() > 0.2


def test_a_camera_sees_its_own_view_at_the_edge_of_its_picture():
    simulation = started()
    _, view = overlay_of(simulation).areas
    corners = np.column_stack([view.corners, np.full(len(view.corners), view.ground)])
    column, row, _ = project(
        corners, simulation.cameras.position[0], simulation.cameras.rotation[0], 320, 240, 0.7854
    )
    assert column == pytest.approx([0, 0, 320, 320], abs=1e-6)
    assert row == pytest.approx([0, 240, 240, 0], abs=1e-6)


def test_the_range_is_where_the_view_is_rewarded():
    simulation = started()
    area, _ = overlay_of(simulation).areas
    rules, position = simulation._rules, simulation.cameras.position[0]
    rotation = simulation.cameras.rotation[0]
    depth = axis_depth(position, rotation, rules.ground)
    middle = area.corners.mean(axis=0)
    for factor, rewarded in ((0.98, True), (1.02, False)):
        for x, y in middle + factor * (area.corners - middle):
            assert (view_share(position, rotation, depth, x, y, rules) > 0) == rewarded


def test_the_range_of_a_distance_reward_is_a_circle():
    reward = RewardConfig(type=RewardType.DISTANCE, distance_range=5.0)
    simulation = started(CONFIG.model_copy(update={"reward": reward}))
    area, _ = overlay_of(simulation).areas
    position, rotation = simulation.cameras.position[0], simulation.cameras.rotation[0]
    middle = view_centre(position, rotation, axis_depth(position, rotation, area.ground))
    assert np.hypot(*(area.corners - middle).T) == pytest.approx(5.0)
    assert len(area.corners) >= 24


def test_the_gem_stands_over_the_target_and_turns_and_the_reward_is_told():
    simulation = started()
    before = overlay_of(simulation)
    simulation.follow(100)
    after = overlay_of(simulation)
    gem = after.solids[0].positions
    middle = simulation.targets.centre[0]
    assert gem[:, :2].mean(axis=0) == pytest.approx(middle[:2], abs=0.05)
    assert gem[:, 2].min() > simulation.target_size(0)[2]
    moved = gem - before.solids[0].positions
    assert not np.allclose(moved, moved[0], atol=0.02)
    assert after.labels[0].text == f"reward {simulation.reward[0]:.2f}"
    simulation.targets.lost[0] = True
    assert not overlay_of(simulation).solids


def test_a_chase_view_shows_the_drone_and_its_view_and_the_same_bytes_twice():
    simulation = started()
    clean, first, again = chased(simulation, overlay=False), chased(simulation), chased(simulation)
    assert np.array_equal(first.rgb, again.rgb)
    assert first.depth is None
    viewpoint = chase_pose(CameraPose(simulation.cameras.position, simulation.cameras.rotation))
    pose = viewpoint.position[0], viewpoint.rotation[0]
    field = 2 * np.arctan(np.tan(0.475) * 160 / 120)
    column, row, _ = project(simulation.trackers.position[0], *pose, 160, 120, field)
    changed = (clean.rgb[0] != first.rgb[0]).any(axis=-1)
    assert changed[round(row) - 2 : round(row) + 3, round(column) - 2 : round(column) + 3].all()
    below = np.append(overlay_of(simulation).areas[0].corners.mean(axis=0), 0.0)
    column, row, _ = project(below, *pose, 160, 120, field)
    assert 0 < column < 160
    assert 0 < row < 120


def test_a_view_shows_every_drone_of_its_world_and_no_other():
    for shared in (True, False):
        simulation = started(count=2, shared=shared)
        behind = chase_pose(CameraPose(simulation.cameras.position, simulation.cameras.rotation))
        second = CameraPose(behind.position[1:], behind.rotation[1:])
        clean, overlaid = Picture.create(1, 180, 240), Picture.create(1, 180, 240)
        simulation.draw_from(FIRST, second, clean, overlay=False)
        simulation.draw_from(FIRST, second, overlaid)
        field = 2 * np.arctan(np.tan(0.475) * 240 / 180)
        pose = second.position[0], second.rotation[0]
        column, row, _ = project(simulation.trackers.position[1], *pose, 240, 180, field)
        changed = (clean.rgb[0] != overlaid.rgb[0]).any(axis=-1)
        assert changed[int(row), int(column)] == shared


def test_a_chase_camera_of_one_that_looks_straight_down_is_upright():
    down = np.array([[[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]])
    pose = chase_pose(CameraPose(np.array([[5.0, 6.0, 20.0]]), down), back=6.0, up=2.5)
    assert pose.position[0] == pytest.approx([-1.0, 6.0, 22.5])
    assert pose.rotation[0].T @ pose.rotation[0] == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(pose.rotation[0]) == pytest.approx(1.0)
    assert pose.rotation[0, 0, 0] > 0
