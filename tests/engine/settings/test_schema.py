"""The schema of settings accepts what Eyas does, and describes every setting."""

import json

import jsonschema
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import PRESETS, preset_file
from eyas.engine.settings.schema import config_schema


@pytest.fixture(scope="module")
def check():
    schema = config_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema).validate


def test_the_defaults_and_the_presets_fit(check):
    check(json.loads(EyasConfig().model_dump_json()))
    for name in set(PRESETS) - {"dat-eval", "dat-train"}:  # those are in the original's format
        check(json.loads(preset_file(name).read_text()))


@pytest.mark.parametrize(
    "wrong",
    [
        {"camera": {"widht": 100}},
        {"camera": {"width": 1}},
        {"camera": {"samples": 3}},
        {"target": "Zebra"},
        {"start": {"height": "high"}},
    ],
)
def test_what_eyas_refuses_does_not_fit(wrong, check, tmp_path):
    file = tmp_path / "settings.json"
    file.write_text(json.dumps(wrong))
    with pytest.raises(ConfigError):
        load_settings(file)
    with pytest.raises(jsonschema.ValidationError):
        check(wrong)


@pytest.mark.parametrize("right", [{"traffic": "live"}, {"start": {"height": {"choice": [9, 12]}}}])
def test_short_forms_fit(right, check, tmp_path):
    file = tmp_path / "settings.json"
    file.write_text(json.dumps(right))
    load_settings(file)
    check(right)


def test_a_file_may_name_its_schema(check, tmp_path):
    file = tmp_path / "settings.json"
    named = {"$schema": "eyas.schema.json", "camera": {"width": 64}}
    file.write_text(json.dumps(named))
    check(named)
    assert load_settings(file).camera.width == 64


def test_it_tells_what_settings_are_for():
    camera = config_schema()["$defs"]["FurtherCameraConfig"]["properties"]  # in part inherited
    assert "[rad]" in camera["field_of_view"]["description"]
    assert "name" in camera


def test_the_command_prints_it(eyas_command):
    assert json.loads(eyas_command("config", "schema").stdout) == config_schema()
