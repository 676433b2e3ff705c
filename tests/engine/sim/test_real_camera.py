"""The camera model in simulations: off, on, drawn twice, alone and together."""

import numpy as np
import pytest

from eyas.engine.core.config import validated
from eyas.engine.render.kernels.tent import filter_pixels
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture


def simulation_of(count=2, weather="day", **camera):
    values = {"camera": {"width": 64, "height": 48, **camera}, "world": {"weather": weather}}
    simulation = build_simulation(validated(SimConfig, values), each_alone(count))
    simulation.reset()
    return simulation


def picture_of(simulation, *trackers):
    chosen = np.array(trackers or range(simulation.count), np.int32)
    picture = Picture.create(len(chosen), 48, 64, object_id=True)
    simulation.draw(chosen, picture)
    return picture


def test_a_picture_drawn_twice_is_the_same_and_the_next_one_has_other_noise():
    simulation = simulation_of(model="small-drone", dirt={"drops": 2}, link={"slice_loss": 0.3})
    still = np.zeros((2, 4))
    for _ in range(3):
        first, again = picture_of(simulation).rgb, picture_of(simulation).rgb
        np.testing.assert_array_equal(first, again)
        simulation.advance(still, 1)
        assert (picture_of(simulation).rgb != first).mean() > 0.05


def test_a_tracker_alone_sees_what_it_sees_among_others():
    settings = {"model": "small-drone", "dirt": {}, "link": {"slice_loss": 0.3, "freezes": 2.0}}
    many, few = simulation_of(3, **settings), simulation_of(1, **settings)
    for _ in range(4):
        shown = picture_of(many, 2, 0).rgb
        np.testing.assert_array_equal(picture_of(few, 0).rgb[0], shown[1])
        many.advance(np.zeros((3, 4)), 20)
        few.advance(np.zeros((1, 4)), 20)


def test_what_is_random_does_not_depend_on_which_episodes_are_shown():
    settings = {"imager": {"full_well": {"uniform": [3000.0, 9000.0]}}, "dirt": {"drops": 2}}
    shown, unseen = (simulation_of(shutter={"blur": True}, **settings) for _ in range(2))
    for trackers in (None, np.array([True, False]), None):
        picture_of(shown)
        for simulation in (shown, unseen):
            simulation.reset(trackers)
    np.testing.assert_array_equal(picture_of(unseen).rgb, picture_of(shown).rgb)


def test_pixels_are_filtered_as_by_the_renderer_or_before_a_sensor_counts_them():
    plain, modelled, sharp = (
        picture_of(simulation_of(**camera)).rgb
        for camera in ({}, {"defocus": 1e-9}, {"pixel_filter": "box"})
    )
    np.testing.assert_array_equal(plain, modelled)
    assert (plain != sharp).any()
    filter_pixels(sharp)
    np.testing.assert_array_equal(plain, sharp)
    sensor = {"full_well": 1e6, "read_noise": 0.0}
    tent, box = (
        picture_of(simulation_of(imager=sensor, pixel_filter=which)).rgb.astype(int)
        for which in ("tent", "box")
    )
    steps = [np.abs(np.diff(rgb, axis=2)).mean() for rgb in (tent, box)]
    assert steps[0] < 0.8 * steps[1]


def test_ids_are_those_of_the_clean_picture():
    plain, real = simulation_of(), simulation_of(imager={}, dirt={}, link={})
    seen, shown = picture_of(plain), picture_of(real)
    np.testing.assert_array_equal(seen.object_id, shown.object_id)
    assert (seen.rgb != shown.rgb).any()


def test_boxes_are_measured_beside_blurred_colours():
    simulation = simulation_of(1, shutter={"blur": True, "exposure": 0.1})
    for _ in range(3):
        simulation.advance(np.array([[8.0, 0.0, 0.0, 0.8]]), 50)
    picture = Picture.create(1, 48, 64, subject=True)
    simulation.draw(np.zeros(1, np.int32), picture)
    assert simulation.snapshot.trackers.velocity[0, :2].any()
    whole = Picture.create(1, 48, 64, rgb=False, subject=True, object_id=True)
    simulation.draw(np.zeros(1, np.int32), whole)
    np.testing.assert_array_equal(picture.subject_box, whole.subject_box)


def test_night_is_noisy_and_day_is_not():
    noise = {}
    for weather in ("day", "night"):
        simulation = simulation_of(1, weather, model="small-drone", link={"quality": None})
        first = picture_of(simulation).rgb.astype(float)
        simulation.advance(np.zeros((1, 4)), 1)
        noise[weather] = np.median(np.abs(picture_of(simulation).rgb - first))
    assert noise["day"] <= 3.0
    assert noise["night"] > 4.0 * max(noise["day"], 1.0)


@pytest.mark.parametrize("spectrum", ["grey", "colour"])
def test_information_tells_time_and_speed_of_the_last_exposure(spectrum):
    from eyas.engine.envs.information import information

    simulation = simulation_of(2, "night", spectrum=spectrum, imager={})
    picture_of(simulation)
    told = information(simulation)
    assert told["exposure_time"] == pytest.approx([0.02, 0.02])
    assert (told["iso"] > 1000).all()
    assert "iso" not in information(simulation_of())
