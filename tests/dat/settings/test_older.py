"""Files of older versions of the original, and files that are not strictly JSON."""

import logging

import pytest

from eyas.dat.settings.adapter import from_original, with_original
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings, read_settings


def test_older_keys_and_values_are_read_with_a_line_each(caplog):
    older = {
        "Sumo_Random_Mode": 1,
        "Reward_Config": {"reward_range": 6.5},
        "Sumo_Params": {"car_type": "private"},
    }
    newer = {"Reward_Config": {"distance_range": 6.5}, "Sumo_Params": {"car_type": "passenger"}}
    assert from_original(older) == from_original(newer)
    lines = [record.getMessage() for record in caplog.records]
    for key in ("Sumo_Random_Mode", "Reward_Config.reward_range", "Sumo_Params.car_type"):
        assert sum(line.startswith(f"{key}: ") for line in lines) == 1
    assert with_original(EyasConfig(), older).reward.distance_range == 6.5


def test_a_present_key_wins_over_its_older_name():
    both = {"Reward_Config": {"reward_range": 3, "distance_range": 5}}
    assert from_original(both).reward.distance_range == 5


def test_all_unknown_keys_are_in_one_message():
    wrong = {"Out_Video": {"fsp": 1, "fps": 2}, "Sumo_Prams": {}, "Done_Range": {"qqqq": 1}}
    with pytest.raises(ConfigError) as caught:
        from_original(wrong)
    line = str(caught.value)
    assert line.startswith("Sumo_Prams: unknown key; did you mean 'Sumo_Params'?; known: ")
    assert line.endswith("; also unknown: Done_Range.qqqq, Out_Video.fsp (did you mean 'fps'?)")
    native = r"^reward\.tpye: .*; also unknown: video\.fsp \(did you mean 'fps'\?\), wat$"
    with pytest.raises(ConfigError, match=native):
        updated(EyasConfig(), {"video": {"fsp": 1}, "reward": {"tpye": 1}, "wat": 1})


@pytest.mark.parametrize(
    ("group", "name"),
    [
        ("Drone_Random_Config", "height"),
        ("Drone_Random_Config", "view_pitch"),
        ("Drone_Random_Config", "horizon_bias"),
        ("Other_Params", "obj_edge_distribution"),
        ("Env_Params", "bgl"),
    ],
)
def test_limits_in_the_wrong_order_are_said(group, name, caplog):
    switch = "background_luminosity_random" if name == "bgl" else f"{name}_random"
    joint = "" if name.startswith("obj") else "_random"
    values = {f"{name}{joint}_min": 1.25, f"{name}{joint}_max": 0.75}
    from_original({group: {**values, switch: False}})
    assert not caplog.records
    from_original({group: {**values, switch: True}})
    (record,) = caplog.records
    assert record.getMessage().startswith(f"{group}.{name}{joint}_min: 1.25 is above {group}.")


LOOSE = """{ // the mode, "train" or not
    "Simulation_Mode": "train", /* two
    lines, } */ "World_Path": "a//b/*c*/\\"d,}/lake-day.wbt",
    "Sumo_Params": {"normalize_color": [1, 0, 0, ], },
}
"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le"])
def test_comments_last_commas_and_other_encodings_are_read(tmp_path, caplog, encoding):
    path = tmp_path / "env_config.json"
    path.write_bytes(LOOSE.encode(encoding))
    values = read_settings(path)
    assert values["World_Path"] == 'a//b/*c*/"d,}/lake-day.wbt'
    assert load_settings(path).world.map == "lake"
    assert any("not strictly JSON" in record.getMessage() for record in caplog.records)
    assert {record.levelno for record in caplog.records} == {logging.WARNING}


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ('{"a": 1, // x\n "b" 3}', "line 2, column 6"),
        ("{/* x", "line 1, column 6"),
        ("[,]", "line 1, column 2"),
        ('{"a": 1,,}', "line 1, column 9"),
        ('{"' + '\\"' * 200_000, "line 1"),
        ("{" + "/*" * 200_000, "line 1"),
        ("{a" + " " * 200_000, "line 1"),
    ],
)
def test_what_is_still_wrong_is_named_where_it_stands(tmp_path, text, place):
    path = tmp_path / "env_config.json"
    path.write_text(text)
    with pytest.raises(DataFileError, match=f"{place}.*not valid JSON"):
        read_settings(path)
