"""What trackers of one world see of each other."""

import numpy as np
import pytest

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import ALONE
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.state.snapshot import CameraState

AHEAD = 3.0
"""Distance of a tracker from the camera that looks at it [m]."""


@pytest.fixture
def simulation(config):
    """Trackers 0, 1 and 3 share a world; 2 and 4 have other worlds."""
    made = build_simulation(config, np.array([0, 0, 1, 0, ALONE]))
    made.reset()
    return made


def put_before_camera(simulation, tracker: int, camera: int) -> None:
    cameras = simulation.snapshot.cameras
    ahead = cameras.rotation[camera, :, 0]
    simulation.snapshot.trackers.position[tracker] = cameras.position[camera] + AHEAD * ahead


def seen_by(simulation, *trackers: int) -> Picture:
    picture = Picture.create(len(trackers), 96, 128, depth=True, object_id=True, class_id=True)
    simulation.draw(np.array(trackers, np.int32), picture)
    return picture


def test_a_tracker_sees_another_where_it_is(simulation):
    put_before_camera(simulation, 1, camera=0)
    picture = seen_by(simulation, 0)
    body = picture.object_id[0] == ACTOR_OBJECT + simulation.actors + 1
    assert np.array_equal(body, picture.class_id[0] == ObjectClass.ROBOT)
    rows, columns = np.nonzero(body)
    assert abs(rows.mean() - 48) < 4
    assert abs(columns.mean() - 64) < 4
    focal = 64.0 / np.tan(0.5 * simulation.snapshot.cameras.field_of_view[0])
    width = (np.ptp(columns) + 1) * AHEAD / focal
    assert 0.25 < width < 0.65
    assert picture.depth[0][body].min() == pytest.approx(AHEAD, abs=0.3)
    colours = picture.rgb[0][body].astype(float)
    assert np.ptp(colours.mean(axis=0)) < 25  # grey


def test_nobody_sees_itself_or_trackers_of_other_worlds(simulation):
    put_before_camera(simulation, 2, camera=0)
    put_before_camera(simulation, 4, camera=0)
    put_before_camera(simulation, 0, camera=0)
    assert not (seen_by(simulation, 0, 1, 2, 3, 4).class_id == ObjectClass.ROBOT).any()
    alone = build_simulation(simulation.config, np.array([0]))
    alone.reset()
    put_before_camera(alone, 0, camera=0)
    assert not (seen_by(alone, 0).class_id == ObjectClass.ROBOT).any()


def test_pictures_without_a_body_in_view_are_those_without_bodies(simulation):
    """A view from elsewhere with the camera of a tracker shows no trackers."""
    snapshot = simulation.snapshot
    snapshot.trackers.position[1] += (0.0, 0.0, 300.0)
    before = seen_by(simulation, 0, 2)
    plain = Picture.create(2, 96, 128, depth=True, object_id=True, class_id=True)
    chosen = np.array([0, 2], np.int32)
    cameras = CameraState(*(array[chosen] for array in snapshot.cameras))
    simulation.draw_from(chosen, cameras, plain, overlay=False)
    for name in ("rgb", "depth", "object_id", "class_id"):
        np.testing.assert_array_equal(getattr(before, name), getattr(plain, name), err_msg=name)
    put_before_camera(simulation, 1, camera=0)
    assert (seen_by(simulation, 0, 2).rgb[0] != before.rgb[0]).any()


def test_a_picture_does_not_depend_on_the_others_that_are_drawn_with_it(simulation):
    put_before_camera(simulation, 1, camera=0)
    put_before_camera(simulation, 3, camera=1)
    together = seen_by(simulation, 4, 1, 0, 2)
    for row, tracker in enumerate((4, 1, 0, 2)):
        alone = seen_by(simulation, tracker)
        assert np.array_equal(alone.rgb[0], together.rgb[row])
        assert np.array_equal(alone.class_id[0], together.class_id[row])
    ids = {int(each.max()) - ACTOR_OBJECT - simulation.actors for each in together.object_id}
    assert {1, 3} <= ids


def test_a_body_turns_and_tilts_with_its_tracker(simulation):
    put_before_camera(simulation, 1, camera=0)
    orientation = simulation.snapshot.trackers.orientation
    # The camera looks down steeply: a level body shows its plan, one rolled by 90° its side.
    across = []
    for quaternion in ((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.5**0.5, 0.5**0.5, 0.0, 0.0)):
        orientation[1] = quaternion
        across.append(seen_by(simulation, 0).class_id[0] == ObjectClass.ROBOT)
    level, turned, rolled = across
    assert (level != turned).any()
    assert rolled.sum() < 0.75 * level.sum()


def test_who_sees_what_is_measured_as_if_bodies_were_not_actors(simulation):
    put_before_camera(simulation, 1, camera=0)
    picture = Picture.create(2, 96, 128, subject=True, actors=simulation.actors, object_id=True)
    simulation.draw(np.array([0, 1], np.int32), picture)
    assert picture.actor_box.shape == (2, simulation.actors, 4)
    body = ACTOR_OBJECT + simulation.actors + 1
    assert (picture.object_id[0] == body).any()
    seen, all_ = picture.subject_pixels[0]
    target = ACTOR_OBJECT + simulation.snapshot.targets.actor[0]
    assert (picture.object_id[0] == target).sum() == seen < all_  # the body hides some of it
