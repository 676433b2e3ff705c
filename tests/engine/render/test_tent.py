"""The tent filter of pixels: what it computes, where it is applied, and how quiet films are."""

import dataclasses

import numpy as np
import pytest

import eyas.engine.render.kernels.tent as module
from eyas.engine.camera.config import CameraConfig
from eyas.engine.render.kernels.tent import filter_light, filter_pixels
from eyas.engine.state.draw import DrawStage, Picture

from ...kit.small_city import looking

SHAPES = [(1, 84, 84), (3, 8, 8), (2, 1, 1), (2, 5, 10), (2, 9, 11), (5, 33, 37), (1, 200, 320)]


def tented(rgb):
    """Return pictures behind the filter, whose border is repeated, in plain numpy."""
    wide = np.pad(rgb.astype(int), ((0, 0), (1, 1), (1, 1), (0, 0)), "edge")
    across = wide[:, :, :-2] + 2 * wide[:, :, 1:-1] + wide[:, :, 2:]
    return (across[:, :-2] + 2 * across[:, 1:-1] + across[:, 2:] + 8) // 16


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("shape", SHAPES)
def test_sums_are_exact_in_pictures_of_any_shape_and_bands(monkeypatch, shape, threads):
    monkeypatch.setattr(module, "PIXELS_PER_THREAD", 20)
    monkeypatch.setattr(module, "thread_count", lambda: threads)
    rgb = np.random.default_rng(3).integers(0, 256, (*shape, 3)).astype(np.uint8)
    room = np.full((shape[0] + 2, *rgb.shape[1:]), 77, np.uint8)
    room[1:-1] = rgb
    filter_pixels(room[1:-1])
    np.testing.assert_array_equal(room[1:-1], tented(rgb))
    assert (room[[0, -1]] == 77).all()  # nothing beside them is written


def test_what_is_even_stays_and_corners_take_what_lies_beyond_from_themselves():
    rgb = np.zeros((1, 9, 13, 3), np.uint8)
    rgb[:, 0, 0], rgb[:, 4, 6] = 160, 160
    filter_pixels(rgb)
    assert rgb[0, :2, :2, 0].tolist() == [[90, 30], [30, 10]]
    assert rgb[0, 3:6, 5:8, 2].tolist() == [[10, 20, 10], [20, 40, 20], [10, 20, 10]]
    white = np.full((1, 20, 30, 3), 255, np.uint8)
    filter_pixels(white)
    assert (white == 255).all()


@pytest.fixture(scope="module")
def sharp(city):
    """Return a function that draws views, with the filter or without."""
    renderer, traffic = city

    def draw(views, tent, samples=1, until=DrawStage.SHADING, size=(84, 84)):
        facts = {"depth": True, "object_id": True, "class_id": True, "subject": True}
        picture = Picture.create(len(views.position), *size, **facts)
        renderer.draw(dataclasses.replace(views, tent=tent), traffic, picture, samples, until)
        return picture

    return draw


def test_fewer_than_four_samples_are_filtered_unless_told_otherwise(sharp):
    views = looking([(-60.0, 0.0, 19.0), (-20.0, 5.0, 9.0)], 0.1, 0.5, fov=0.8)
    for samples in (1, 2, 4):
        plain, soft = (sharp(views, tent, samples) for tent in (False, True))
        np.testing.assert_array_equal(soft.rgb, tented(plain.rgb))
        usual = sharp(views, None, samples)
        np.testing.assert_array_equal(usual.rgb, (plain if samples == 4 else soft).rgb)
        for name in ("depth", "object_id", "class_id", "subject_box", "subject_pixels"):
            np.testing.assert_array_equal(getattr(plain, name), getattr(soft, name))


def test_films_flicker_by_half_of_what_they_did(sharp):
    """A camera that creeps, and one that turns slowly: quantiles of second differences."""
    for step, turn, pitch in ((0.02, 0.0, 1.0), (0.0, 0.002, 0.3)):
        places = [(-60.0 + step * k, -2.0, 19.0) for k in range(14)]
        views = looking(places, [turn * k for k in range(14)], pitch, fov=0.785)
        films = [sharp(views, tent).rgb.astype(int) for tent in (False, None)]
        before, now = (np.quantile(np.abs(np.diff(film, 2, 0)).max(-1), 0.999) for film in films)
        assert now < min(0.6 * before, 90.0)


def test_a_setting_leaves_it_out_or_asks_for_it():
    assert CameraConfig().tent
    assert CameraConfig(samples=2).tent
    assert not CameraConfig(samples=4).tent
    assert not CameraConfig(pixel_filter="box").tent
    assert CameraConfig(samples=4, pixel_filter="tent").tent


@pytest.mark.parametrize("size", [(9, 8), (84, 84), (20, 37)])
def test_light_is_filtered_by_the_same_weights(size):
    light = np.random.default_rng(5).random((2, 3, *size), np.float32)
    wide = np.pad(light, ((0, 0), (0, 0), (1, 1), (1, 1)), "edge")
    across = wide[..., :-2] * 0.25 + wide[..., 1:-1] * 0.5 + wide[..., 2:] * 0.25
    soft = across[:, :, :-2] * 0.25 + across[:, :, 1:-1] * 0.5 + across[:, :, 2:] * 0.25
    filter_light(light)
    np.testing.assert_allclose(light, soft, rtol=1e-5)
