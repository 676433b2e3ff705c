import numpy as np
import pytest

from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.task.direction import TargetDirection
from eyas.engine.task.done import DoneReason

TRACKER, VIEW = 2, 1


def filled(arrays) -> None:
    """Give every number of a record another value, so that none can stand for another."""
    rng = np.random.default_rng(0)
    for array in arrays:
        array[...] = rng.permutation(array.size).reshape(array.shape)


@pytest.fixture
def snapshot() -> Snapshot:
    made = Snapshot.create(3)
    for record in (made.trackers, made.cameras, made.targets):
        filled(record)
    made.targets.model[:] = 4
    made.targets.yaw[:] = 0.5
    made.targets.speed[:] = 3.0
    made.episodes.tick[:] = 10, 20, 30
    made.episodes.step_count[:] = 1, 2, 3
    made.episodes.reward[:] = 0.1, 0.2, 1 / 3
    made.episodes.direction[:] = 3
    made.episodes.reason[:] = 8
    return made


@pytest.fixture
def picture() -> Picture:
    made = Picture.create(2, 4, 5, depth=True, subject=True)
    filled([made.rgb, made.depth, made.subject_box, made.subject_visible_box])
    made.subject_pixels[VIEW] = 3, 4
    return made


def test_a_frame_holds_the_rows_of_its_tracker_and_of_its_view(snapshot, picture):
    action = RecordedAction(2, np.ones(4))
    frame = frame_of(FrameMoment(snapshot, snapshot.episodes), TRACKER, picture, VIEW, 17, action)
    trackers, cameras, targets, *_ = snapshot
    for name in ("position", "velocity", "acceleration", "orientation", "angular_velocity"):
        assert np.array_equal(getattr(frame.tracker, name), getattr(trackers, name)[TRACKER]), name
    assert np.array_equal(frame.tracker.gimbal, trackers.gimbal[TRACKER])
    assert np.array_equal(frame.camera.position, cameras.position[TRACKER])
    assert np.array_equal(frame.camera.rotation, cameras.rotation[TRACKER])
    for name in ("size", "position", "centre"):
        assert np.array_equal(getattr(frame.target, name), getattr(targets, name)[TRACKER]), name
    assert frame.target.object_id == ACTOR_OBJECT + targets.actor[TRACKER]
    assert frame.target.type == MODELS[4].name
    assert np.array_equal(frame.target.box, picture.subject_box[VIEW])
    assert np.array_equal(frame.target.visible_box, picture.subject_visible_box[VIEW])
    assert (frame.camera.width, frame.camera.height) == (5, 4)
    assert frame.target.visible_fraction == 0.75
    assert np.array_equal(frame.rgb, picture.rgb[VIEW])
    assert np.array_equal(frame.depth, picture.depth[VIEW])
    assert (frame.object_id, frame.class_id) == (None, None)
    assert (frame.number, frame.action) == (17, action)


def test_numbers_of_a_frame_are_not_rounded(snapshot, picture):
    frame = frame_of(
        FrameMoment(snapshot, snapshot.episodes),
        TRACKER,
        picture,
        VIEW,
        0,
        RecordedAction(-1, None),
    )
    assert (frame.time, frame.step, frame.episode_time) == (0.06, 3, 0.006)
    assert frame.reward == 1 / 3
    assert (frame.direction, frame.reason) == (TargetDirection.RIGHT, DoneReason.STEP_LIMIT)
    assert frame.target.velocity.tolist() == snapshot.targets.velocity[TRACKER].tolist()


def test_later_steps_and_pictures_leave_a_frame_alone(snapshot, picture):
    frame = frame_of(
        FrameMoment(snapshot, snapshot.episodes),
        TRACKER,
        picture,
        VIEW,
        0,
        RecordedAction(-1, None),
    )
    shared = [*snapshot.trackers, *snapshot.cameras, *snapshot.targets]
    shared += [picture.rgb, picture.depth, picture.subject_box, picture.subject_visible_box]
    records = (frame.tracker, frame.camera, frame.target, frame)
    own = [getattr(record, name) for record in records for name in record.__slots__]
    arrays = [value for value in own if isinstance(value, np.ndarray)]
    assert len(arrays) == 6 + 2 + 7 + 2
    assert not any(np.shares_memory(mine, theirs) for mine in arrays for theirs in shared)
