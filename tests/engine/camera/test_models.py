"""Cameras by their data sheets, laid under the settings."""

import json

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.imager import Spectrum
from eyas.engine.camera.models import MODELS
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.config import SimConfig


@pytest.mark.parametrize("name", MODELS)
def test_a_model_gives_what_is_not_set(name):
    camera = validated(CameraConfig, {"model": name, "width": 100})
    assert camera.is_modelled
    assert camera.width == 100
    for key, value in MODELS[name]["imager"].items():
        assert getattr(camera.imager, key) == value
    again = validated(CameraConfig, json.loads(camera.model_dump_json()))
    assert again == camera


def test_what_is_set_stays():
    given = {
        "model": "small-drone",
        "imager": {"f_number": 1.7},
        "exposure": {"speed": 1.5},
        "link": None,
    }
    camera = validated(CameraConfig, given)
    assert camera.imager.f_number == 1.7
    assert camera.imager.full_well == MODELS["small-drone"]["imager"]["full_well"]
    assert camera.exposure.speed == 1.5
    assert camera.exposure.time == MODELS["small-drone"]["exposure"]["time"]


def test_another_model_takes_the_place_of_the_first():
    config = updated(SimConfig(), {"camera": {"model": "small-drone"}})
    config = updated(config, {"camera": {"imager": {"f_number": 1.7}}})
    assert config.camera.imager.f_number == 1.7
    assert config.camera.imager.full_well == 8180.0
    other = updated(config, {"camera": {"model": "analogue-video"}})
    assert other.camera.imager.f_number == 1.7
    assert other.camera.imager.full_well == 63000.0
    assert other.camera.dirt is None
    grey = updated(other, {"camera": {"model": "global-shutter"}})
    assert grey.camera.spectrum is Spectrum.GREY
    drone = updated(SimConfig(), {"camera": {"model": "small-drone"}})
    assert updated(drone, {"camera": {"model": None}}) == SimConfig()


def test_an_unknown_model_is_refused_with_the_nearest():
    with pytest.raises(ConfigError, match=r"model: 'smal-drone' .*'small-drone'"):
        CameraConfig(model="smal-drone")
