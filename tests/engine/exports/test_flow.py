"""Optical flow: the next picture, taken back by it, is the first."""

import cv2
import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import project
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.flow import FlowWriter, forward_flow
from eyas.engine.exports.frame import Frame, RecordedAction
from eyas.engine.exports.writer import Summary
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT

from ...kit.walkers import FEW

pytestmark = pytest.mark.slow  # what its tests share takes long to make

WIDTH, HEIGHT, COUNT = 160, 120, 6
NEAR = {"height": {"uniform": [2.0, 4.0]}, "pitch": {"uniform": [0.2, 0.7]}}
LOW = {"height": {"uniform": [4.0, 8.0]}, "pitch": {"uniform": [0.2, 0.6]}}
WORLDS = {
    "cars": {"start": LOW},
    "trucks": {"traffic": {"vehicle_type": "trailer", "max_vehicles": 12}, "start": LOW},
    "people": {"target": "Pedestrian", "objects": FEW, "start": NEAR},
}


def pairs_of(settings: dict, *, still: bool = False) -> list[tuple[Frame, Frame]]:
    """Frames of all trackers 40 ms apart; the cameras move, and zoom, or stand still."""
    config = EyasConfig(**settings, camera={"width": WIDTH, "height": HEIGHT})
    simulation = build_simulation(config, each_alone(COUNT))
    simulation.reset()
    simulation.carry(150)
    cameras = simulation.snapshot.cameras
    wanted = {"depth": True, "object_id": True, "actors": simulation.actors}
    picture = Picture.create(COUNT, HEIGHT, WIDTH, subject=True, **wanted)
    before = [array.copy() for array in cameras]
    frames: list[list[Frame]] = []
    for number in range(2):
        for array, old in zip(cameras, before, strict=True):
            array[:] = old if still else array
        if number and not still:
            cameras.field_of_view[:] = 0.99 * cameras.field_of_view
            turn = np.array([[np.cos(0.01), -np.sin(0.01)], [np.sin(0.01), np.cos(0.01)]])
            cameras.rotation[:, :, :2] = cameras.rotation[:, :, :2] @ turn
        simulation.draw(np.arange(COUNT, dtype=np.int32), picture)
        moments = [moment_of(simulation, n, picture, n, ("parts",)) for n in range(COUNT)]
        action = RecordedAction(-1, None)
        frames.append(
            [frame_of(moment, n, picture, n, number, action) for n, moment in enumerate(moments)]
        )
        simulation.carry(20)
    return list(zip(*frames, strict=True))


def decoded(flow: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return motion [pixels], shape (H, W, 2), and whether it is valid, as KITTI's readers do."""
    return (flow[..., :2].astype(np.float32) - 32768.0) / 64.0, flow[..., 2] == 1


def taken_back(second: np.ndarray, motion: np.ndarray) -> np.ndarray:
    column, line = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    places = (column + motion[..., 0]).astype(np.float32), (line + motion[..., 1])
    return cv2.remap(second, *(np.asarray(place, np.float32) for place in places), cv2.INTER_LINEAR)


@pytest.fixture(scope="module", params=WORLDS)
def pairs(request) -> list[tuple[Frame, Frame]]:
    return pairs_of(WORLDS[request.param])


def test_the_next_picture_taken_back_is_the_first(pairs):
    for first, second in pairs:
        motion, valid = decoded(forward_flow(first, second))
        assert valid.mean() > 0.8
        now = first.rgb.astype(np.float32)
        with_it = np.abs(taken_back(second.rgb, motion) - now).mean(axis=2)
        without = np.abs(second.rgb - now).mean(axis=2)
        assert np.median(with_it[valid]) < 6.0
        assert with_it[valid].mean() < 0.6 * without[valid].mean()
        # Depth tells more sharply than colours: it is that of the point.
        depth = np.minimum(second.parts.depth, 1e3)
        there = taken_back(depth, motion)
        far = np.minimum(first.parts.depth, 1e3)
        assert np.median(np.abs(there - far)[valid] / far[valid]) < 0.05


def test_valid_points_are_of_the_same_thing(pairs):
    for first, second in pairs:
        motion, valid = decoded(forward_flow(first, second))
        line, column = np.nonzero(valid)
        there = np.stack([column, line], axis=1) + motion[valid]
        nearest = np.clip(np.rint(there).astype(int), 0, [WIDTH - 1, HEIGHT - 1])
        same = first.object_id[valid] == second.object_id[nearest[:, 1], nearest[:, 0]]
        assert same.mean() > 0.97


def test_before_a_still_camera_only_what_moves_flows():
    moved = 0
    for first, second in pairs_of({"start": LOW}, still=True):
        motion, valid = decoded(forward_flow(first, second))
        still = first.object_id < ACTOR_OBJECT
        assert not motion[still & valid].any()
        target = first.target
        own = valid & (first.object_id == target.object_id)
        if target.seen_pixels < 20 or np.hypot(*target.velocity[:2]) < 1.0:
            continue
        # The flow of its body is between those of the corners of its box.
        camera = first.camera
        pose = camera.position, camera.rotation, WIDTH, HEIGHT, camera.field_of_view
        before, after = (np.stack(project(f.target.corners, *pose)[:2]) for f in (first, second))
        low, high = (after - before).min(axis=1) - 0.1, (after - before).max(axis=1) + 0.1
        middle = np.median(motion[own], axis=0)
        assert (low < middle).all()
        assert (middle < high).all()
        moved += 1
    assert moved > 1


def test_limbs_flow_by_themselves():
    spread = []
    for first, second in pairs_of(WORLDS["people"], still=True):
        motion, valid = decoded(forward_flow(first, second))
        own = valid & (first.object_id == first.target.object_id)
        parts = np.unique(first.parts.row[own])
        means = [motion[own & (first.parts.row == part)].mean(axis=0) for part in parts.tolist()]
        if len(means) > 3:
            spread.append(np.ptp(means, axis=0).max())
    assert max(spread) > 0.5


def test_points_that_get_hidden_are_not_valid():
    hidden = 0
    for first, second in pairs_of({"start": LOW}, still=True):
        _, valid = decoded(forward_flow(first, second))
        still_now = first.object_id < ACTOR_OBJECT
        covered = still_now & (second.object_id >= ACTOR_OBJECT)
        inside = cv2.erode((second.object_id >= ACTOR_OBJECT).astype(np.uint8), np.ones((3, 3)))
        assert not valid[covered & (inside == 1)].any()
        hidden += int((covered & (inside == 1)).sum())
    assert hidden > 10


def test_files_are_as_kitti_has_them_and_the_last_has_no_valid_pixel(run, episode, pairs):
    from dataclasses import replace

    episode = replace(episode, width=WIDTH, height=HEIGHT)
    part = FlowWriter(run).begin(episode)
    for frame in pairs[0]:
        part.add(frame)
    assert FlowWriter(run).read(episode.folder) == Summary(1)
    part.finish()
    assert FlowWriter(run).read(episode.folder) == Summary(2)
    files = [episode.folder / f"flow/{number:06d}.png" for number in range(2)]
    first, last = (cv2.imread(str(file), cv2.IMREAD_UNCHANGED)[..., ::-1] for file in files)
    assert first.dtype == np.uint16
    np.testing.assert_array_equal(first, forward_flow(*pairs[0]))
    assert not last.any()
