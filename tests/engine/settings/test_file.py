import json
import re

import pytest

from eyas.dat.settings.adapter import from_original
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.variation import Mirrored, Uniform
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings, save_settings
from eyas.engine.traffic.config import TrafficConfig

CONFIG = EyasConfig(
    seed=3,
    start={"pitch": {"choice": [0.7, 1.1]}, "direction": {"mirrored": [0.1, 0.3]}},
    traffic={"colour": [0.1, 0.2, 0.3]},
    world={"map": "lake", "seed": 4},
)


def write(tmp_path, text):
    path = tmp_path / "settings.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_saved_settings_load_back_equal_and_are_left_alone(tmp_path):
    path = tmp_path / "config.json"
    save_settings(CONFIG, path)
    before = path.read_bytes()
    assert load_settings(path) == CONFIG
    load_settings(path, ["seed=9"])
    assert path.read_bytes() == before


def test_both_notations_are_told_apart(tmp_path):
    assert load_settings(write(tmp_path, '{"video": {"fps": 9}}')).video.fps == 9.0
    legacy = load_settings(write(tmp_path, '{"Out_Video": {"fps": 9}}'))
    assert legacy == from_original({"Out_Video": {"fps": 9}})


def test_no_file_and_no_keys_give_the_defaults(tmp_path):
    assert load_settings(None) == EyasConfig()
    assert load_settings(write(tmp_path, "{}")) == EyasConfig()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "line 1, column 1"),
        ('{"video": {"fps":\n 9}', "line 2, column 4"),
        ('{"video": {,}}', "line 1, column 12"),
        ("[1, 2]", "not a JSON object"),
        ('{"seed": 1, "seed": 2}', "'seed' appears twice"),
        (b"\xff\xfe\x00", "UTF-8"),
        ("[" * 100_000, "recursion|overflow"),  # older Pythons, 3.14
        ('{"seed": ' + "9" * 5000 + "}", "digits"),
    ],
)
def test_a_file_that_is_no_object_is_told_with_its_name(tmp_path, text, said):
    path = write(tmp_path, text)
    with pytest.raises(DataFileError) as caught:
        load_settings(path)
    line = str(caught.value)
    assert line.startswith(f"{path}: ")
    assert re.search(said, line)
    assert "\n" not in line


@pytest.mark.parametrize("name", ["nowhere.json", "."])
def test_a_file_that_cannot_be_read_is_told(tmp_path, name):
    with pytest.raises(DataFileError, match="cannot read"):
        load_settings(tmp_path / name)


def test_a_byte_order_mark_is_no_error(tmp_path):
    assert load_settings(write(tmp_path, b'\xef\xbb\xbf{"seed": 4}')).seed == 4


def test_the_latest_override_wins_in_either_notation():
    assert load_settings(None, ["video.fps=9", "Out_Video.fps=10"]).video.fps == 10.0
    assert load_settings(None, ["Out_Video.fps=10", "video.fps=9"]).video.fps == 9.0
    assert load_settings(None, ["seed=1", "seed=2"]).seed == 2


def test_overrides_are_json_or_bare_words():
    config = load_settings(
        None,
        [
            "world.map=village",
            'world.weather="snow"',
            'start.height={"uniform": [1, 2]}',
            "traffic.colour=[1, 0, 0]",
            "traffic.seed=null",
            "video.flight=random",
            'video={"fps": 9}',
            "wire.address=10.0.0.1",
        ],
    )
    assert (config.world.map, config.world.weather) == ("village", "snow")
    assert config.start.height == Uniform(uniform=(1.0, 2.0))
    assert config.traffic.colour == (1.0, 0.0, 0.0)
    assert (config.video.fps, config.video.flight) == (9.0, None)
    assert config.wire.address == "10.0.0.1"


def test_a_switch_of_the_original_wakes_the_values_of_its_file(tmp_path):
    group = {"horizon_bias_random_max": 8, "horizon_bias_random_min": 6}
    path = write(tmp_path, json.dumps({"Drone_Random_Config": group}))
    switch = "Drone_Random_Config.horizon_bias_random=true"
    assert load_settings(path, [switch]).start.horizontal_bias == Mirrored(mirrored=(6.0, 8.0))
    later = ["Drone_Random_Config.horizon_bias_random_max=7", "seed=1", switch]
    assert load_settings(path, later).start.horizontal_bias == Mirrored(mirrored=(6.0, 7.0))


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("video.fps", "--set 'video.fps': not of the form key=value"),
        ("=3", "--set '=3': not of the form"),
        ("video..fps=3", "--set 'video..fps=3': not of the form"),
        ("video.fsp=3", "video.fsp: unknown key; did you mean 'fps'?"),
        ("video.fps.x=3", 'video.fps: {"x": 3} is not allowed: a number'),
        ("video=3", "video: 3 is not allowed: an object"),
        ("video.fps=fast", "video.fps: 'fast' is not allowed: a number"),
        ("Out_Video.fps=fast", "Out_Video.fps: 'fast' is not allowed: a number"),
        ("Out_Video.fsp=3", "Out_Video.fsp: unknown key; did you mean 'fps'?"),
        ("seed=NaN", "seed: NaN is not allowed: a whole number"),
        ("seed=-1", "seed: -1 is not allowed: a whole number"),
    ],
)
def test_a_wrong_override_is_one_line_in_its_own_notation(override, line):
    with pytest.raises(ConfigError) as caught:
        load_settings(None, [override])
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)


def test_a_rate_that_does_not_divide_500_is_told_with_the_rate_in_effect(caplog, tmp_path):
    load_settings(None, ["control.frequency=125"])
    assert not caplog.records
    load_settings(None, ["Control_Frequence=150"])
    load_settings(write(tmp_path, '{"Control_Frequence": 166.6}'))
    assert [record.getMessage() for record in caplog.records] == [
        "control.frequency: 150 does not divide 500; an action lasts 3 steps of 2 ms, "
        "so the effective rate is 166.7 Hz",
        "control.frequency (Control_Frequence): 166.6 does not divide 500; an action lasts 3 steps "
        "of 2 ms, so the effective rate is 166.7 Hz",
    ]


def test_the_settings_of_the_originals_client_are_recognised(tmp_path):
    path = write(tmp_path, '{"Benchmark": {"Need_render": 0, "Action_dim": 7}}')
    with pytest.raises(DataFileError, match=r"the original's client.*config/env_config\.json"):
        load_settings(path)


@pytest.mark.parametrize("order", [1, -1])
def test_a_name_stands_for_the_source_of_the_traffic(order, tmp_path):
    changes = ["traffic=live", "traffic.max_vehicles=8"][::order]
    assert load_settings(None, changes).traffic == TrafficConfig(source="live", max_vehicles=8)
    path = tmp_path / "settings.json"
    path.write_text('{"traffic": "live"}')
    assert load_settings(path).traffic == TrafficConfig(source="live")
    assert updated(EyasConfig(seed=4), {"traffic": "live"}).traffic.source == "live"
    with pytest.raises(ConfigError, match=r"^traffic\.source: 'liv' is not .* mean 'live'"):
        load_settings(None, ["traffic=liv"])


MISSPELT = {
    "env": lambda settings: {"env": {"mixture": [{}, {"settings": settings}]}},
    "train": lambda settings: {
        "train": {"stages": [{"total_timesteps": 1000, "settings": settings}]}
    },
}


@pytest.mark.parametrize("place", MISSPELT)
@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"worl": {"map": "x"}}, "worl: unknown key; did you mean 'world'"),
        ({"done": {"max_height": float("inf")}}, "done.max_height: Infinity is not allowed"),
        ({"done": {"max_height": float("nan")}}, "done.max_height: NaN is not allowed"),
        ({"world": {"map": "\ud800"}}, "world.map: "),
        ({"\ud800": 1}, "settings: "),
        (
            {"env": {"mixture": [{"settings": {"lidr": {}}}]}},
            "env.mixture.0.settings.lidr: unknown",
        ),
        ({"reward": 5}, "reward: 5 is not allowed: an object with "),
    ],
)
def test_settings_of_kinds_and_stages_are_checked_when_loaded(tmp_path, place, settings, line):
    path = tmp_path / "settings.json"
    path.write_text(json.dumps(MISSPELT[place](settings)))
    where = {"env": "env.mixture.1.settings.", "train": "train.stages.0.settings."}[place]
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    assert str(caught.value).startswith(where + line)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("place", MISSPELT)
def test_right_ones_come_back_as_they_were(tmp_path, place):
    values = MISSPELT[place]({"world": {"weather": "night"}, "custom": {"mesh": "a.glb"}})
    config = validated(EyasConfig, values)
    save_settings(config, tmp_path / "saved.json")
    assert load_settings(tmp_path / "saved.json") == config


@pytest.mark.parametrize(
    ("name", "kind"), [("bus", "bus"), ("Car", "passenger"), ("lorry", "truck")]
)
def test_a_class_of_vehicles_as_target_names_the_setting_that_chooses_it(name, kind):
    with pytest.raises(ConfigError, match=rf"SUMO_VEHICLE with traffic\.vehicle_type={kind}$"):
        load_settings(None, [f"target={name}"])
