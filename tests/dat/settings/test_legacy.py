import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.dat.settings.adapter import (
    from_original,
    is_original,
    save_original,
    to_original,
    with_original,
)
from eyas.dat.settings.keys import ENTRIES
from eyas.dat.settings.layout import nested, original_defaults
from eyas.engine.core.clock import physics_steps
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.variation import Mirrored, Uniform
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings, save_settings

DATA = Path(__file__).parent / "data"
FILES = ("manual_example", "recommended", "shipped")


def read(name):
    kit = Path(__file__).parents[2] / "kit" / "original_settings.json"
    return json.loads((kit if name == "shipped" else DATA / f"{name}.json").read_text())


def flat(values):
    pairs = {}
    for key, value in values.items():
        inner = value if isinstance(value, dict) else {}
        pairs |= {f"{key}.{name}": part for name, part in inner.items()} or {key: value}
    return pairs


@pytest.mark.parametrize("name", FILES)
def test_the_originals_files_load(name):
    config = from_original(read(name))
    assert from_original(to_original(config)) == config


@pytest.mark.parametrize("name", FILES)
def test_files_say_the_same_after_a_round_trip_but_for_keys_without_effect(name):
    said, written = flat(read(name)), flat(to_original(from_original(read(name))))
    for entry in ENTRIES:
        active = entry.write(_fields(from_original(read(name)), entry))
        for key in active.keys() & said.keys():
            assert written[key] == said[key], key


def _fields(config, entry):
    values = json.loads(config.model_dump_json())
    fields = {}
    for path in entry.paths:
        value = config
        for part in path.split("."):
            value = getattr(value, part)
        fields[path] = value
    assert values
    return fields


def test_the_table_has_every_key_once():
    keys = [key for entry in ENTRIES for key in entry.keys]
    assert sorted(keys) == sorted(flat(original_defaults()))


def test_every_setting_is_reached_by_at_most_one_entry():
    paths = [path for entry in ENTRIES for path in entry.paths]
    assert len(paths) == len(set(paths))


def test_missing_groups_and_keys_have_the_manuals_values():
    example = read("manual_example")
    assert from_original({}) == from_original(example)
    assert from_original({"Out_Video": {"fps": 50.0}}) == from_original(example)


def test_the_recommended_set_reads_as_meant():
    config = from_original(read("recommended"))
    assert config.mode == "train"
    assert config.start.pitch == Uniform(uniform=(0.6, 1.38))
    assert config.start.height == Uniform(uniform=(13.0, 22.0))
    assert config.start.direction == Uniform(uniform=(-3.1415926535, 3.1415926535))
    assert config.start.horizontal_bias == Mirrored(mirrored=(2.5, 4.5))
    assert config.start.warm_up_steps == 510
    assert (config.traffic.group_size, config.traffic.colour, config.traffic.seed) == (None,) * 3
    assert config.traffic.route_length == (500.0, 7000.0)
    assert config.done.velocity == 10000.0
    assert config.video.counter_clockwise_rate == 2.0
    assert config.wire.port == 35531


@pytest.mark.parametrize("values", [{}, *map(read, FILES)])
def test_the_originals_file_means_its_traffic(values):
    base = EyasConfig()
    assert base.traffic.demand == "keep_alive"
    assert from_original(values, base).traffic.demand == "respawn"


@pytest.mark.parametrize("values", [{}, *map(read, FILES)])
def test_the_originals_file_means_its_quality_of_pictures(values):
    assert EyasConfig().video.jpeg_quality == 95
    assert from_original(values).video.jpeg_quality == 100


@pytest.mark.parametrize("values", [{}, *map(read, FILES)])
def test_the_originals_file_means_a_start_at_rest_and_no_passers_by(values):
    assert (EyasConfig().start.velocity, EyasConfig().extras) == ("target", None)
    assert EyasConfig().tracker.flight == "mended"
    config = from_original(values)
    assert (config.start.velocity, config.extras) == ("rest", ())
    assert (config.tracker.flight, config.tracker.off_centre) == ("original", True)
    assert not EyasConfig().tracker.off_centre
    assert (config.traffic.signals, config.traffic.lamps) == ("amber", "dark")
    config = from_original(values, EyasConfig())
    assert (config.start.velocity, config.extras) == ("target", None)


def test_traffic_that_lasts_is_a_key_of_ours_in_its_file():
    written = to_original(EyasConfig())
    assert written["Sumo_Params"]["keep_alive"] is True
    assert from_original(written).traffic.demand == "keep_alive"
    assert to_original(from_original({}))["Sumo_Params"]["keep_alive"] is False
    with pytest.raises(
        ConfigError, match=r"^Sumo_Params.keep_alive: 1 is not allowed: true or fal"
    ):
        from_original({"Sumo_Params": {"keep_alive": 1}})


@pytest.mark.parametrize(
    "keys",
    [
        {"fixed_car_group_num": True},
        {"car_group_num": 7},
        {"car_import_interval": 30.0},
        {"min_rou_distance": 400},
        {"max_rou_distance": 3000},
        {"route_num": 50},
    ],
)
def test_a_key_about_groups_means_that_groups_come(keys):
    assert with_original(EyasConfig(), {"Sumo_Params": keys}).traffic.demand == "respawn"
    kept = {"Sumo_Params": keys | {"keep_alive": True}}
    assert with_original(EyasConfig(), kept).traffic.demand == "keep_alive"
    others = {"Sumo_Params": {"max_sumo_car": 30, "fixed_seed": True, "rou_update": True}}
    assert with_original(EyasConfig(), others).traffic.demand == "keep_alive"


def test_what_the_original_cannot_say_is_kept_from_the_base():
    base = EyasConfig(seed=5, camera={"width": 640}, world={"seed": 3})
    config = from_original(read("shipped"), base)
    assert (config.seed, config.camera.width, config.world.seed) == (5, 640, 3)


variations = st.one_of(
    st.floats(0.5, 1.5),
    st.tuples(st.floats(0.5, 1.5), st.floats(0.5, 1.5)).map(lambda pair: Uniform(uniform=pair)),
)
two_sided = st.one_of(
    variations,
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)).map(lambda pair: Mirrored(mirrored=pair)),
)
unit = st.floats(0, 1)
configs = st.fixed_dictionaries(
    {},
    optional={
        "seed": st.integers(0, 2**40),
        "mode": st.sampled_from(["demo", "video", "train"]),
        "target": st.sampled_from(["SUMO_VEHICLE", "BB-8"]),
        "world": st.fixed_dictionaries(
            {
                "map": st.sampled_from(["citystreet", "lake", "simpleway-grass"]),
                "weather": st.sampled_from(["day", "foggy", "snow"]),
                "seed": st.integers(0, 9),
            }
        ),
        "tracker": st.fixed_dictionaries(
            {"kind": st.sampled_from(["drone", "car"]), "supervised": st.booleans()}
        ),
        "control": st.fixed_dictionaries({"frequency": st.integers(1, 500)}),
        "start": st.fixed_dictionaries(
            {"pitch": variations, "height": variations},
            optional={"direction": two_sided, "vertical_bias": two_sided},
        ),
        "traffic": st.fixed_dictionaries(
            {},
            optional={
                "demand": st.sampled_from(["keep_alive", "respawn"]),
                "group_size": st.none() | st.integers(1, 9),
                "colour": st.none() | st.tuples(unit, unit, unit),
                "seed": st.none() | st.integers(0, 9),
                "route_length": st.tuples(st.floats(0, 100), st.floats(200, 300)),
                "vehicle_type": st.sampled_from(["bus", "passenger"]),
            },
        ),
        "light": st.one_of(
            st.fixed_dictionaries({"background": st.floats(-1, 1), "visibility": variations}),
            st.builds(
                lambda pair: {"sun": {"uniform": pair}, "sun_replaces": True}, st.tuples(unit, unit)
            ),
        ),
        "objects": st.fixed_dictionaries({"offset": two_sided}),
        "video": st.fixed_dictionaries(
            {"fps": st.floats(1, 60), "flight": st.sampled_from(["exact", "random"])}
        ),
    },
).map(lambda values: EyasConfig(**values))


@settings(max_examples=60)
@given(configs)
def test_native_to_legacy_and_back_loses_nothing(config):
    flight = config.video.flight or "exact"  # the original knows no camera path
    config = updated(config, {"video": {"flight": flight}})
    written = json.loads(json.dumps(to_original(config)))
    assert from_original(written, config).model_copy(update={"original": None}) == config
    again = from_original(written)
    assert from_original(to_original(again)) == again
    assert again.start == config.start.model_copy(update={"velocity": "rest"})
    assert again.light == config.light
    assert (again.world.map, again.world.weather) == (config.world.map, config.world.weather)


@pytest.mark.parametrize(
    ("values", "path"),
    [
        ({"start": {"pitch": {"choice": [1.0, 1.2]}}}, "start.pitch"),
        ({"start": {"pitch": {"choice": [1.0]}}}, "start.pitch"),
        ({"light": {"sun": {"uniform": [0, 1]}}}, "light.sun_replaces"),
        ({"light": {"sun": 0.5, "sun_replaces": True}}, "light.sun_replaces"),
        ({"world": {"map": "a/b"}}, "world.map"),
    ],
)
def test_what_cannot_be_said_is_one_line(values, path, tmp_path, caplog):
    config = EyasConfig(**values)
    with pytest.raises(ConfigError, match=rf"^{path}: .* cannot be expressed in env_config.json$"):
        to_original(config)
    assert not save_original(config, tmp_path / "env_config.json")
    assert not list(tmp_path.iterdir())
    assert path in caplog.text


def test_saved_files_load_back(tmp_path):
    config = from_original(read("recommended"))
    assert save_original(config, tmp_path / "env_config.json")
    assert from_original(json.loads((tmp_path / "env_config.json").read_text())) == config


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"Control_Frequence": 0}, "Control_Frequence: 0 is not allowed: a number from 1 to 500"),
        (
            {"Control_Frequency": 9},
            "Control_Frequency: unknown key; did you mean 'Control_Frequence'?",
        ),
        ({"Out_Vidoe": {}}, "Out_Vidoe: unknown key; did you mean 'Out_Video'?"),
        ({"Out_Video": {"fsp": 1}}, "Out_Video.fsp: unknown key; did you mean 'fps'?"),
        ({"Out_Video": 3}, "Out_Video: 3 is not allowed: an object with channels, fps"),
        ({"Out_Video": {"fps": "50"}}, "Out_Video.fps: '50' is not allowed: a number"),
        (
            {"Out_Video": {"channels": 4.0}},
            "Out_Video.channels: 4.0 is not allowed: a whole number",
        ),
        ({"Verbose": 1}, "Verbose: 1 is not allowed: true or false"),
        ({"Tracker_Def": "DRON"}, "Tracker_Def: 'DRON' is not allowed; did you mean 'DRONE'?"),
        ({"Tracker_Def": "drone"}, "Tracker_Def: 'drone' is not allowed; known: CAR, DRONE"),
        ({"Tracker_Def": 3}, "Tracker_Def: 3 is not allowed: 'DRONE' or 'CAR'"),
        (
            {"Simulation_Mode": "vidoe"},
            "Simulation_Mode: 'vidoe' is not allowed; did you mean 'video'?",
        ),
        ({"World_Path": 3}, "World_Path: 3 is not allowed: text"),
        (
            {"Sumo_Params": {"normalize_color": "red"}},
            "Sumo_Params.normalize_color: 'red' is not allowed: a list of 3 numbers",
        ),
        (
            {"Drone_Random_Config": {"height_fixed": float("nan")}},
            "Drone_Random_Config.height_fixed: NaN is not allowed: a number",
        ),
    ],
)
def test_a_wrong_key_or_value_is_told_in_the_originals_words(values, line):
    with pytest.raises(ConfigError) as caught:
        from_original(values)
    assert str(caught.value).startswith(line)


@pytest.mark.parametrize(
    ("group", "keys", "path"),
    [
        ("Drone_Random_Config", {"height_random_max": -3}, "height_random_max: -3"),
        ("Drone_Random_Config", {"height_random_min": 0}, "height_random_min: 0"),
        ("Drone_Random_Config", {"height_random": 1}, "height_random: 1"),
        ("Drone_Random_Config", {"height_fixed": "a"}, "height_fixed: 'a'"),
        ("Drone_Random_Config", {"view_pitch_fixed": True}, "view_pitch_fixed: true"),
        ("Sumo_Params", {"min_rou_distance": 8000}, "min_rou_distance: 8000"),
        ("Sumo_Params", {"max_rou_distance": 0}, "max_rou_distance: 0"),
        (
            "Sumo_Params",
            {"max_rou_distance": 2e9},
            "max_rou_distance: 2000000000.0 is not allowed: a number above 0 and up to 1e9",
        ),
        (
            "Sumo_Params",
            {"max_rou_distance": 400},
            "min_rou_distance: 500 is not allowed: a number from 0 to below "
            "Sumo_Params.max_rou_distance, which is 400",
        ),
        (
            "Sumo_Params",
            {"car_type": {"passenger": 1, "bus": 1}},
            'car_type: {"passenger": 1, "bus": 1} is not allowed: a name; more than one: '
            "traffic.vehicle_type",
        ),
        ("Sumo_Params", {"car_group_num": 0}, "car_group_num: 0"),
        (
            "Sumo_Params",
            {"fixed_color": True, "normalize_color": [1, 2, 0]},
            "normalize_color: [1, 2, 0]",
        ),
        (
            "Sumo_Params",
            {"car_type": "buss"},
            "car_type: 'buss' is not allowed; did you mean 'bus'?",
        ),
        ("Done_Range", {"min_height": 60}, "min_height: 60"),
        (
            "Env_Params",
            {"foggy_use_default": False, "foggy_visibility_range_fixed": 0},
            "foggy_visibility_range_fixed: 0",
        ),
    ],
)
def test_the_key_to_blame_is_found_among_several(group, keys, path):
    with pytest.raises(ConfigError) as caught:
        from_original({group: keys})
    assert str(caught.value).startswith(f"{group}.{path}")
    assert "\n" not in str(caught.value)


def test_keys_without_effect_may_be_out_of_range_and_are_kept():
    config = from_original({"Drone_Random_Config": {"height_fixed": -1}})
    assert config.original == {"Drone_Random_Config.height_fixed": -1}
    assert config.model_copy(update={"original": {}}) == from_original({})


@pytest.mark.parametrize("name", FILES)
def test_what_is_written_back_loses_nothing(name, tmp_path):
    config = from_original(read(name))
    assert save_original(config, tmp_path / "env_config.json")
    save_settings(config, tmp_path / "config.json")
    native = load_settings(tmp_path / "config.json")
    assert native == config
    for written in (json.loads((tmp_path / "env_config.json").read_text()), to_original(native)):
        said, again = flat(read(name)), flat(written)
        assert {key: again[key] for key in said} == said


switches = [key for key, value in flat(read("shipped")).items() if isinstance(value, bool)]
drawn = [
    key
    for key, value in flat(read("shipped")).items()
    if key.startswith(("Drone_Random_Config", "Env_Params", "Other_Params"))
    and isinstance(value, int | float)
    and key not in switches
    and "start_time" not in key
]


@settings(max_examples=60)
@given(
    st.dictionaries(st.sampled_from(switches), st.booleans()),
    st.dictionaries(st.sampled_from(drawn), st.integers(1, 6) | st.floats(0.5, 1.5)),
)
def test_whatever_the_switches_nothing_is_lost(flags, numbers):
    said = flat(read("shipped")) | flags | numbers
    config = from_original(nested(said))
    again = EyasConfig.model_validate_json(config.model_dump_json())
    assert again == config
    assert {key: value for key, value in flat(to_original(again)).items() if key in said} == said


def test_a_switch_turned_on_later_finds_its_values():
    group = {"direction_random": False, "direction_random_max": 3.14, "direction_random_min": -3.14}
    written = to_original(from_original({"Drone_Random_Config": group}))
    written["Drone_Random_Config"]["direction_random"] = True
    assert from_original(written).start.direction == Uniform(uniform=(-3.14, 3.14))


def test_a_kept_value_never_overrides_a_setting():
    group = {"height_random": True, "height_random_max": 22, "height_fixed": 17}
    config = from_original({"Drone_Random_Config": group, "World_Path": "/home/me/lake-day.wbt"})
    changed = updated(config, {"start": {"height": 9.0}, "world": {"weather": "night"}})
    written = to_original(changed)
    assert written["Drone_Random_Config"]["height_fixed"] == 9.0
    assert written["World_Path"] == "worlds/lake-night.wbt"
    assert from_original(written).start.height == 9.0
    assert to_original(config)["World_Path"] == "/home/me/lake-day.wbt"


@pytest.mark.parametrize(
    ("original", "line"),
    [
        ({"Out_Video.fsp": 3}, "original.Out_Video.fsp: unknown key; did you mean 'Out_Video.fps'"),
        (
            {"Drone_Random_Config.height_fixed": "a"},
            "Drone_Random_Config.height_fixed: 'a' is not allowed: a number",
        ),
    ],
)
def test_kept_values_are_checked(original, line, tmp_path):
    path = tmp_path / "config.json"
    path.write_text(json.dumps({"original": original}))
    with pytest.raises(ConfigError) as caught:
        load_settings(path)
    assert str(caught.value).startswith(line)


@pytest.mark.parametrize(("frequency", "steps"), [(125.0, 4), (62.5, 8), (250, 2), (150.0, 3)])
def test_a_rate_may_have_a_fraction_as_in_the_original(frequency, steps):
    config = from_original({"Control_Frequence": frequency})
    assert physics_steps(config.control.frequency) == steps


@pytest.mark.parametrize(
    ("group", "pitch", "key"),
    [
        ({"view_pitch_fixed": 0}, 0.5, "fixed: 0 "),
        ({"view_pitch_fixed": -0.3}, 0.5, "fixed: -0.3 "),
        ({"view_pitch_fixed": 3.2}, 1.5, "fixed: 3.2 "),
        (
            {"view_pitch_random": True, "view_pitch_random_min": -1},
            Uniform(uniform=(0.5, 1.57)),
            "random_min: -1 ",
        ),
    ],
)
def test_a_pitch_that_the_gimbal_cannot_reach_is_limited_and_told(group, pitch, key, caplog):
    assert from_original({"Drone_Random_Config": group}).start.pitch == pitch
    (record,) = caplog.records
    assert record.getMessage().startswith(f"Drone_Random_Config.view_pitch_{key}")


def test_a_pitch_that_can_start_keeps_its_value(caplog):
    group = {"view_pitch_fixed": 0.3, "view_pitch_random_min": -1}
    assert from_original({"Drone_Random_Config": group}).start.pitch == 0.3
    assert not caplog.records


def test_an_unknown_target_is_told_with_the_nearest():
    with pytest.raises(UnknownNameError, match=r"^Tracking_Object: .* did you mean 'Pedestrian'"):
        from_original({"Tracking_Object": "Pedestrain"})


def test_fixed_luminosity_is_added_and_drawn_luminosity_replaces():
    fixed = from_original({"Env_Params": {"bgl_incremental": 0.5}}).light
    drawn = from_original({"Env_Params": {"background_luminosity_random": True}}).light
    assert (fixed.background, fixed.background_replaces) == (0.5, False)
    assert (drawn.background, drawn.background_replaces) == (Uniform(uniform=(0.0, 1.0)), True)


def test_random_fog_is_drawn_between_both_limits():
    keys = {"foggy_use_default": False, "foggy_visibility_range_random": True}
    assert from_original({"Env_Params": keys}).light.visibility == Uniform(uniform=(300.0, 1000.0))


@pytest.mark.parametrize(
    ("path", "place"),
    [
        ("/home/me/worlds/lake-night.wbt", ("lake", "night")),
        (r"C:\worlds\village-snow.wbt", ("village", "snow")),
        ("simpleway-grass_foggy.wbt", ("simpleway-grass", "foggy")),
        ("worlds/old-town-day.wbt", ("old-town", "day")),
    ],
)
def test_the_path_of_a_world_gives_map_and_weather(path, place):
    world = from_original({"World_Path": path}).world
    assert (world.map, world.weather) == place


def test_the_path_of_an_unknown_world_is_told_and_not_used(caplog):
    assert from_original({"World_Path": "la2.wbt"}).world == EyasConfig().world
    assert "la2.wbt" in caplog.text


def test_a_change_of_one_key_leaves_what_the_original_cannot_say():
    config = EyasConfig(start={"pitch": {"choice": [1.0, 1.2]}})
    assert with_original(config, {"Out_Video": {"fps": 9}}) == EyasConfig(
        start=config.start, video={"fps": 9}
    )
    drawn = with_original(config, {"Drone_Random_Config": {"view_pitch_random": True}})
    assert drawn.start.pitch == Uniform(uniform=(0.7, 1.57))


def test_notation_is_told_by_capitals():
    assert is_original({"Verbose": True})
    assert is_original({"Vrebose": True})
    assert not is_original({"verbose": True, "Video": {}})
    assert not is_original({})
