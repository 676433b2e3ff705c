"""Cameras that see other light: near infrared and thermal, in pictures of trackers."""

import numpy as np
import pytest

import eyas
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.renderer import CpuRenderer

HOT = {"world": {"map": "citystreet", "hour": 22.0}}


def _images(config: dict, steps: int = 2, count: int = 3) -> np.ndarray:
    env = eyas.make_vec("citystreet-day", count, config=config)
    seen, _ = env.reset(seed=4)
    for _ in range(steps):
        seen, *_ = env.step(np.zeros(count, np.int64))
    env.close()
    return seen


def _camera(**camera: object) -> dict:
    return {"camera": camera, **HOT}


def test_a_thermal_picture_is_grey_and_shows_the_target_warm():
    thermal, plain = _images(_camera(spectrum="thermal")), _images(_camera())
    assert (thermal == thermal[..., :1]).all()
    assert not np.array_equal(thermal, plain)
    # The target is in the middle, on a road that has cooled down less than the lawns.
    assert thermal[:, 36:48, 36:48].max() > thermal.mean() + 20


def test_for_a_thermal_picture_nothing_is_drawn_but_what_it_is_made_of(monkeypatch):
    drawn, draw = [], CpuRenderer.draw

    def noted(renderer, views, movers, picture, *settings):
        drawn.append(picture)
        draw(renderer, views, movers, picture, *settings)

    monkeypatch.setattr(CpuRenderer, "draw", noted)
    _images(_camera(spectrum="thermal"), count=1)
    assert len(drawn) == 3
    assert all(picture.normal is not None for picture in drawn)


def test_thermal_pictures_do_not_depend_on_the_number_of_drones():
    assert np.array_equal(
        _images(_camera(spectrum="thermal"), count=1)[0],
        _images(_camera(spectrum="thermal"), count=4)[0],
    )


def test_a_lens_bends_temperatures():
    wide = {"field_of_view": 2.2, "lens": {"model": "fisheye"}}
    exact = {"noise": 0.0, "fixed_pattern": 0.0}
    seen = _images(_camera(spectrum="thermal", thermal=exact, **wide))[..., 0]
    outside = _images(_camera(**wide)).max(axis=-1) == 0
    assert 0.1 < outside.mean() < 0.5
    assert (seen[:, :4, :4] == seen[:, :1, :1]).all()  # the lens' mount, of one temperature
    assert seen[~outside].std() > 20


def test_near_infrared_is_grey_and_has_noise_by_night():
    night = {"world": {"map": "citystreet", "weather": "night"}}
    seen = _images({"camera": {"spectrum": "near-infrared"}, **night})
    assert (seen == seen[..., :1]).all()
    assert seen.std() > 5


def test_what_a_thermal_camera_has_not_is_refused():
    with pytest.raises(ConfigError, match=r"camera\.imager: .* must be left out where spectrum is"):
        eyas.make_config({"camera": {"spectrum": "thermal", "imager": {}}})
    with pytest.raises(ConfigError, match=r"lens\.vignetting, .* must be left out"):
        eyas.make_config({"camera": {"spectrum": "thermal", "lens": {"vignetting": 0.5}}})
