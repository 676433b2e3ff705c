"""Pictures of trackers through their lenses, and the labels of these."""

import cv2
import numpy as np
import pytest

from eyas.engine.camera.lens import LensConfig
from eyas.engine.core.optics.lens import BROWN, FISHEYE, project, rays
from eyas.engine.core.variation import Uniform
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.flow import forward_flow
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.trackers.kinds import tracker_of

SIZE = 60, 84
BARREL = LensConfig(model="brown", k1=-0.3, k2=0.1, right=0.02)


def simulated(config, assets, lens, fov=1.2, count=2):
    camera = config.camera.model_copy(
        update={"height": SIZE[0], "width": SIZE[1], "lens": lens, "field_of_view": fov}
    )
    made = Simulation(
        config.model_copy(update={"camera": camera}), assets, tracker_of(config.tracker),
        each_alone(count),
    )  # fmt: skip
    made.reset()
    return made


def drawn(simulation, size=SIZE, **wanted) -> Picture:
    picture = Picture.create(simulation.count, *size, **wanted)
    simulation.view.draw(np.arange(simulation.count, dtype=np.int32), picture)
    return picture


def test_only_light_changes_where_nothing_bends(config, assets):
    dark = drawn(simulated(config, assets, LensConfig(vignetting=0.6)), depth=True)
    plain = drawn(simulated(config, assets, LensConfig()), depth=True)
    np.testing.assert_array_equal(dark.depth, plain.depth)
    middle = np.s_[:, 25:35, 37:47]
    np.testing.assert_allclose(dark.rgb[middle].astype(int), plain.rgb[middle], atol=3)
    corner = np.s_[:, :4, :4]
    assert dark.rgb[corner].mean() < 0.85 * plain.rgb[corner].mean()


@pytest.mark.parametrize("lens", [BARREL, LensConfig(model="fisheye", k1=0.05)])
def test_all_labels_lie_on_the_bent_picture(config, assets, lens):
    simulation = simulated(config, assets, lens)
    picture = drawn(simulation, depth=True, object_id=True, subject=True)
    view, cameras = simulation.view, simulation.snapshot.cameras
    for tracker in range(2):
        actor = int(simulation.snapshot.targets.actor[tracker])
        mask = picture.object_id[tracker] == ACTOR_OBJECT + actor
        assert mask.sum() == picture.subject_pixels[tracker, 0] > 30
        # The box of its vertices, which nothing clips or hides.
        whole = view.whole_boxes(tracker, view.actors(tracker), np.array([actor]))[0]
        np.testing.assert_allclose(whole, picture.subject_box[tracker], atol=1.5)
        own, field = view.lens_of(tracker), float(cameras.field_of_view[tracker])
        assert own.model == (BROWN if lens is BARREL else FISHEYE)
        at = cameras.position[tracker], cameras.rotation[tracker]
        column, row, _ = project(
            simulation.snapshot.targets.centre[tracker], *at, SIZE[::-1], (field, None), own
        )
        assert mask[int(row), int(column)]
        # In words: where it is in shares of the picture.
        seen = view.in_view(tracker)
        place = seen.place[seen.actor.tolist().index(actor)] * SIZE[::-1]
        np.testing.assert_allclose(place, (column, row), atol=4.0)


def test_parts_are_drawn_through_the_lens(config, assets):
    simulation = simulated(config, assets, BARREL)
    picture = drawn(simulation, depth=True, object_id=True)
    parts = simulation.view.parts(0, simulation.view.actors(0))
    np.testing.assert_array_equal(parts.depth, picture.depth[0])
    np.testing.assert_array_equal(parts.row >= 0, picture.object_id[0] >= ACTOR_OBJECT)


def test_the_lens_changes_no_random_number(config, assets):
    plain = simulated(config, assets, LensConfig())
    bent = simulated(config, assets, LensConfig(model="brown", k1=Uniform(uniform=(-0.2, 0.0))))
    assert bent.view.lens_of(0) != bent.view.lens_of(1)
    for one, other in zip(plain.snapshot.cameras, bent.snapshot.cameras, strict=True):
        np.testing.assert_array_equal(one, other)


def test_things_at_the_edge_of_a_wide_lens_are_posed(config, assets):
    """What only the lens shows is in the draw list: a pinhole of its field would leave it out."""
    fov = 2.0
    simulation = simulated(config, assets, LensConfig(model="fisheye"), fov)
    drawer, chosen = simulation.view.pictures, np.arange(2, dtype=np.int32)
    cameras = simulation.snapshot.cameras
    _, narrow = drawer._views(chosen, cameras, SIZE[0] / SIZE[1])
    few = [(part >= 0).sum() for part in narrow.part]
    _, wide = drawer._views(chosen, cameras, SIZE[0] / SIZE[1], simulation.view.lenses)
    assert sum((part >= 0).sum() for part in wide.part) > sum(few)


def test_drawing_stops_at_stages_through_a_lens(config, assets):
    simulation = simulated(config, assets, BARREL)
    picture = Picture.create(2, *SIZE, depth=True)
    for stage in DrawStage:
        simulation.view.draw(np.arange(2, dtype=np.int32), picture, until=stage)
    assert picture.rgb.any()


def frames_of(simulation, count):
    """Frames of tracker 0, some steps apart."""
    chosen, frames = np.zeros(1, np.int32), []
    for number in range(count):
        if number:
            simulation.advance(np.tile([4.0, 0.5, 0.0, 0.3], (simulation.count, 1)), 40)
        picture = Picture.create(
            1, *SIZE, depth=True, object_id=True, subject=True, actors=simulation.actors
        )
        simulation.view.draw(chosen, picture)
        moment = moment_of(simulation, 0, picture, 0, ("parts",))
        frames.append(frame_of(moment, 0, picture, 0, number, RecordedAction(-1, None)))
    return frames


@pytest.mark.parametrize("lens", [BARREL, LensConfig(model="fisheye", k1=0.05)])
def test_labels_give_opencv_what_it_needs(config, assets, lens):
    (frame,) = frames_of(simulated(config, assets, lens), 1)
    camera = frame.camera
    axes = np.stack([-camera.rotation[:, 1], -camera.rotation[:, 2], camera.rotation[:, 0]])
    own = (frame.target.centre - camera.position) @ axes.T
    matrix, zero = camera.intrinsics.copy(), np.zeros(3)
    matrix[:2, 2] -= 0.5  # OpenCV counts from the middle of the first pixel
    distortion = np.array(camera.distortion)
    if camera.distortion_model == "fisheye":
        place, _ = cv2.fisheye.projectPoints(own[None, None], zero, zero, matrix, distortion)
    else:
        assert camera.distortion_model == "brown"
        place, _ = cv2.projectPoints(own[None], zero, zero, matrix, distortion)
    column, row = np.rint(place.ravel()).astype(int)
    assert frame.object_id[row, column] == frame.target.object_id
    left, top, right, bottom = frame.target.box
    assert left < column < right
    assert top < row < bottom
    assert matrix[0, 2] == pytest.approx((0.5 + lens.right) * SIZE[1] - 0.5)


def test_flow_is_that_of_the_bent_pictures(config, assets):
    first, second = frames_of(simulated(config, assets, BARREL), 2)
    flow = forward_flow(first, second)
    own, fields = first.camera.lens, (first.camera.field_of_view, None)
    ray = rays(first.camera.rotation, SIZE[::-1], fields, own)
    still = (flow[..., 2] == 1) & (first.parts.row < 0) & np.isfinite(first.depth)
    assert still.mean() > 0.3
    point = first.camera.position + first.depth[still][:, None] * ray[still]
    column, row, _ = project(
        point, second.camera.position, second.camera.rotation, SIZE[::-1], fields, own
    )
    rows, columns = np.nonzero(still)
    moved = (flow[still][:, :2].astype(float) - 32768.0) / 64.0
    np.testing.assert_allclose(moved, np.stack([column - columns, row - rows], 1) - 0.5, atol=0.02)
    assert np.abs(moved).max() > 1.0
