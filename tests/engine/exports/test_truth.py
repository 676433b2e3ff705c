"""A thousand random frames of all sorts of targets: pictures, boxes and depth say the same."""

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import project
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.frame import Frame, RecordedAction, Subject
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT, LABELLED

from ...kit.walkers import FEW

pytestmark = pytest.mark.slow  # what its tests share takes long to make

SIZE, TRACKERS, TIMES = 84, 12, 17
NEAR = {"height": {"uniform": [3.0, 9.0]}, "pitch": {"uniform": [0.2, 1.2]}}
HIGH = {"height": {"uniform": [6.0, 30.0]}, "pitch": {"uniform": [0.3, 1.3]}}
CROWD = [{"kind": "Pedestrian", "count": 40, "behaviour": "crossing"}]
WORLDS = {
    "cars": {"world": {"map": "citystreet"}, "start": HIGH},
    "town": {"world": {"map": "downtown"}, "start": HIGH},
    "trucks": {"traffic": {"vehicle_type": "trailer", "max_vehicles": 12}, "start": HIGH},
    "people": {"target": "Pedestrian", "extras": CROWD, "start": NEAR},
    "robots": {"world": {"map": "village"}, "target": "Mantis", "objects": FEW, "start": NEAR},
}


def frames_of(settings: dict) -> list[Frame]:
    config = EyasConfig(**settings, camera={"width": SIZE, "height": SIZE})
    simulation = build_simulation(config, each_alone(TRACKERS))
    wanted = {"depth": True, "object_id": True, "class_id": True, "actors": simulation.actors}
    picture = Picture.create(TRACKERS, SIZE, SIZE, subject=True, **wanted)
    rng, frames = np.random.default_rng(5), []
    simulation.reset()
    for number in range(TIMES):
        simulation.carry(20 + 40 * (number % 5))
        simulation.reset(simulation.snapshot.episodes.done | (rng.random(TRACKERS) < 0.2))
        for n in range(TRACKERS):  # a little aside, so that the border cuts some
            aside = rng.normal(0.0, 0.2)
            turn = np.array([[np.cos(aside), -np.sin(aside)], [np.sin(aside), np.cos(aside)]])
            rotation = simulation.snapshot.cameras.rotation[n]
            rotation[:, :2] = rotation[:, :2] @ turn
        simulation.draw(np.arange(TRACKERS, dtype=np.int32), picture)
        for n in range(TRACKERS):
            moment = moment_of(simulation, n, picture, n)
            frames.append(frame_of(moment, n, picture, n, number, RecordedAction(-1, None)))
    return frames


@pytest.fixture(scope="module", params=WORLDS)
def frames(request) -> list[Frame]:
    return frames_of(WORLDS[request.param])


def subjects(frames: list[Frame]) -> list[tuple[Frame, Subject]]:
    return [(frame, each) for frame in frames for each in (frame.target, *frame.others)]


def test_masks_are_within_the_boxes_that_labels_tell(frames):
    for frame, subject in subjects(frames):
        rows, columns = np.nonzero(frame.object_id == subject.object_id)
        assert len(rows) == subject.seen_pixels
        if not len(rows):
            assert not subject.visible_box.any()
            continue
        extent = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
        assert subject.visible_box.tolist() == extent
        (left, top, right, bottom), visible = subject.box.tolist(), extent
        assert left <= visible[0] < visible[2] <= right
        assert top <= visible[1] < visible[3] <= bottom
        assert set(frame.class_id[rows, columns].tolist()) == {int(subject.object_class)}


def test_labels_list_all_that_masks_show(frames):
    for frame in frames:
        shown = set(frame.object_id[np.isin(frame.class_id, [*LABELLED])].tolist())
        told = {other.object_id for other in frame.others}
        target = {frame.target.object_id} if frame.target.seen_pixels else set()
        assert shown == told | target


def test_depth_is_that_of_the_3d_box(frames):
    for frame, subject in subjects(frames):
        if not subject.seen_pixels:
            continue
        _, _, ahead = seen_corners(frame, subject)
        depth = frame.depth[frame.object_id == subject.object_id]
        pixel = ahead.max() / frame.camera.intrinsics[0, 0]  # its size there [m]
        assert ahead.min() - 0.25 - pixel < depth.min()
        assert depth.max() < ahead.max() + 0.25 + pixel


def test_whole_boxes_agree_with_pixels_and_with_3d_corners(frames):
    whole_in_view = cut = hidden = 0
    for frame, subject in subjects(frames):
        column, row, ahead = seen_corners(frame, subject)
        if ahead.min() < 0.5 or not subject.covered_pixels:
            continue
        pixel = frame.camera.intrinsics[0, 0] / ahead.min()  # of one metre, at the nearest corner
        left, top, right, bottom = subject.whole_box.tolist()
        outside = [column.min() - left, row.min() - top, right - column.max(), bottom - row.max()]
        assert max(outside) < 0.5 + 0.25 * pixel, subject  # antennas, and what leans in curves
        past = subject.whole_box[:2] - subject.box[:2], subject.box[2:] - subject.whole_box[2:]
        assert np.concatenate(past).max() < 1.0
        share = subject.truncated(frame.camera)
        whole_in_view += share == 0.0
        cut += 0.0 < share < 1.0
        hidden += subject.seen_pixels < subject.covered_pixels
    assert whole_in_view > 30
    assert cut > 5
    assert hidden > 5


def seen_corners(frame: Frame, subject: Subject) -> tuple[np.ndarray, ...]:
    corners = [subject.corners, *(box.corners for box in subject.section_boxes)]
    if subject.posed_corners is not None:
        corners = [subject.posed_corners]
    camera = frame.camera
    pose = camera.position, camera.rotation
    return project(np.concatenate(corners), *pose, SIZE, SIZE, camera.field_of_view)


def test_a_target_that_is_not_there_is_in_no_picture():
    simulation = build_simulation(EyasConfig(**WORLDS["people"]), each_alone(1))
    simulation.reset()
    present = simulation.traffic.motion.sampled().table["present"] > 0.0
    row, actor = np.argwhere(~present[:-1] & ~present[1:])[0].tolist()
    simulation.follow(0, actor)
    simulation.snapshot.targets.actor[0] = actor
    simulation.snapshot.episodes.tick[0] = round(row / simulation.traffic.motion.rate * 500)
    wanted = {"object_id": True, "actors": simulation.actors}
    picture = Picture.create(1, 480, 640, subject=True, **wanted)
    simulation.draw(np.zeros(1, np.int32), picture)
    moment = moment_of(simulation, 0, picture, 0)
    frame = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None))
    target = frame.target
    assert target.object_id == ACTOR_OBJECT + actor
    assert (target.seen_pixels, target.covered_pixels) == (0, 0)
    assert not target.whole_box.any()
    assert target.truncated(frame.camera) == 1.0
    assert not (frame.object_id == target.object_id).any()
