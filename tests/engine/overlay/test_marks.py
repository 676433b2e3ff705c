"""What an overlay shows of a tracker, on the shipped map and traffic."""

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import project
from eyas.engine.overlay.marks import Marks
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import CameraState
from eyas.engine.state.terrain import Plane, Terrain, height_over
from eyas.engine.task.config import RewardConfig, RewardType, StartConfig
from eyas.engine.task.reward import axis_depth, rewarded_size, view_centre, view_share

CONFIG = SimConfig(start=StartConfig(pitch=1.2, height=22.0))
FIRST = np.zeros(1, np.int32)
FLAT = Terrain.flat(-0.1)
CHASED = 1.2
"""Field of view of the cameras that follow [rad]."""


def started(config: SimConfig = CONFIG, count: int = 1, *, shared: bool = False):
    simulation = build_simulation(config, (together if shared else each_alone)(count))
    simulation.reset()
    return simulation


def overlay_of(simulation, trackers=None, terrain=FLAT):
    marks = Marks(simulation.snapshot, terrain, simulation.config.camera)
    return marks.of(0, simulation.rules, trackers)


def behind(cameras: CameraState) -> CameraState:
    """Cameras 6 m behind and 2.5 m above others, that look down on them and their ground."""
    ahead = cameras.rotation[:, :, 0] * (1.0, 1.0, 0.0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    up = np.array([0.0, 0.0, 1.0])
    forward = np.cos(0.78) * ahead - np.sin(0.78) * up
    left = np.cross(up, ahead)
    return CameraState(
        position=cameras.position - 6.0 * ahead + 2.5 * up,
        rotation=np.stack([forward, left, np.cross(forward, left)], axis=2),
        field_of_view=np.full(len(ahead), CHASED),
    )


def chased(simulation, size=(120, 160), *, overlay=True) -> Picture:
    picture = Picture.create(1, *size)
    viewpoint = behind(simulation.snapshot.cameras)
    one = CameraState(*(array[:1] for array in viewpoint))
    simulation.draw_from(FIRST, one, picture, overlay=overlay)
    return picture


def test_only_the_colours_change_and_draw_stays_clean():
    simulation = started()
    wanted = {"depth": True, "object_id": True, "subject": True, "class_id": True}
    clean, overlaid, again = (Picture.create(1, 60, 80, **wanted) for _ in range(3))
    simulation.draw(FIRST, clean)
    simulation.draw(FIRST, overlaid, overlay=True)
    simulation.draw(FIRST, again)
    for name in ("depth", "object_id", "subject_box", "subject_pixels", "class_id"):
        assert np.array_equal(getattr(clean, name), getattr(overlaid, name))
    assert np.array_equal(clean.rgb, again.rgb)
    assert (clean.rgb != overlaid.rgb).any(axis=-1).mean() > 0.2


def test_a_camera_sees_its_own_view_at_the_edge_of_its_picture():
    simulation = started()
    cameras = simulation.snapshot.cameras
    for terrain in (FLAT, hill_below(simulation)):
        _, view = overlay_of(simulation, terrain=terrain).areas
        column, row, _ = project(
            view.corners, cameras.position[0], cameras.rotation[0], 320, 240, 0.7854
        )
        assert column == pytest.approx([0, 0, 320, 320], abs=1e-6)
        assert row == pytest.approx([0, 240, 240, 0], abs=1e-6)
        for corner in view.corners.tolist():
            assert height_over(view.ground, *corner) == pytest.approx(0.0, abs=1e-9)


def hill_below(simulation) -> Terrain:
    """A hill of constant slope that is at z = 0 under the target."""
    x, y, _ = simulation.snapshot.targets.centre[0]
    at = np.arange(-200.0, 201.0, 100.0)
    relief = 200.0 + 0.2 * at - 0.1 * at[:, None]
    return Terrain(-200.0, relief.astype(np.float32), x - 200.0, y - 200.0, 100.0)


def test_the_range_is_where_the_view_is_rewarded():
    simulation = started()
    rules, cameras = simulation.rules, simulation.snapshot.cameras
    position, rotation = cameras.position[0], cameras.rotation[0]
    size = rewarded_size(cameras.field_of_view[0], rules)
    for terrain in (FLAT, hill_below(simulation)):
        area, _ = overlay_of(simulation, terrain=terrain).areas
        middle = area.corners.mean(axis=0)
        for factor, rewarded in ((0.98, True), (1.02, False)):
            for x, y, z in (middle + factor * (area.corners - middle)).tolist():
                below = Plane(x, y, z, area.ground.rise_east, area.ground.rise_north)
                depth = axis_depth(position, rotation, below)
                share = view_share(position, rotation, depth, below, size)
                assert (share > 0) == rewarded


def test_the_range_of_a_distance_reward_is_a_circle():
    reward = RewardConfig(type=RewardType.DISTANCE, distance_range=5.0)
    simulation = started(CONFIG.model_copy(update={"reward": reward}))
    area, _ = overlay_of(simulation).areas
    cameras = simulation.snapshot.cameras
    position, rotation = cameras.position[0], cameras.rotation[0]
    middle = view_centre(position, rotation, axis_depth(position, rotation, area.ground))
    assert np.hypot(*(area.corners[:, :2] - middle).T) == pytest.approx(5.0)
    assert area.corners[:, 2] == pytest.approx(-0.1)
    assert len(area.corners) >= 24


def test_the_gem_stands_over_the_target_and_turns_and_the_reward_is_told():
    simulation = started()
    targets = simulation.snapshot.targets
    before = overlay_of(simulation)
    simulation.carry(100)
    after = overlay_of(simulation)
    gem = after.solids[0].positions
    assert gem[:, :2].mean(axis=0) == pytest.approx(targets.centre[0, :2], abs=0.05)
    assert gem[:, 2].min() > targets.size[0, 2]
    moved = gem - before.solids[0].positions
    assert not np.allclose(moved, moved[0], atol=0.02)
    assert after.labels[0].text == f"reward {simulation.snapshot.episodes.reward[0]:.2f}"
    targets.lost[0] = True
    assert not overlay_of(simulation).solids


def test_a_chase_view_shows_the_drone_and_its_view_and_the_same_bytes_twice():
    simulation = started()
    clean, first, again = chased(simulation, overlay=False), chased(simulation), chased(simulation)
    assert np.array_equal(first.rgb, again.rgb)
    assert first.depth is None
    viewpoint = behind(simulation.snapshot.cameras)
    pose = viewpoint.position[0], viewpoint.rotation[0]
    column, row, _ = project(simulation.snapshot.trackers.position[0], *pose, 160, 120, CHASED)
    changed = (clean.rgb[0] != first.rgb[0]).any(axis=-1)
    assert changed[round(row) - 2 : round(row) + 3, round(column) - 2 : round(column) + 3].all()
    below = overlay_of(simulation).areas[0].corners.mean(axis=0)
    column, row, _ = project(below, *pose, 160, 120, CHASED)
    assert 0 < column < 160
    assert 0 < row < 120


def test_a_view_shows_every_drone_of_its_world_and_no_other():
    for shared in (True, False):
        simulation = started(count=2, shared=shared)
        both = behind(simulation.snapshot.cameras)
        second = CameraState(*(array[1:] for array in both))
        clean, overlaid = Picture.create(1, 180, 240), Picture.create(1, 180, 240)
        simulation.draw_from(FIRST, second, clean, overlay=False)
        simulation.draw_from(FIRST, second, overlaid)
        pose = second.position[0], second.rotation[0]
        column, row, _ = project(simulation.snapshot.trackers.position[1], *pose, 240, 180, CHASED)
        changed = (clean.rgb[0] != overlaid.rgb[0]).any(axis=-1)
        assert changed[int(row), int(column)] == shared
