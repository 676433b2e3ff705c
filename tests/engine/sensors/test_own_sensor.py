"""A sensor of a user's own, in one file that Eyas does not know, wherever sensors are shown."""

import copy
import math
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

import eyas
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.exports.episode_files import SensorWriter
from eyas.engine.exports.label import LabelWriter
from eyas.engine.sensors.config import SensorsConfig
from eyas.engine.sensors.table import SENSORS, further_sensors
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.schema import config_schema
from eyas.engine.task.packets import BASIC_FIELDS
from eyas.robotics.mavlink.readings import FIELD, PRESSURE, equipped, part_of

EXAMPLES = Path(__file__).parents[3] / "examples"
PATH = "own_sensor:MAGNETOMETER"
MAGNET = 0.25
FURTHER = [{"sensor": PATH, "settings": {"magnet": MAGNET}}, "barometer"]


@pytest.fixture(autouse=True)
def magnetometer(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    monkeypatch.setattr(SENSORS, "_loaded", {})
    import own_sensor

    yield own_sensor.MAGNETOMETER
    del sys.modules["own_sensor"]


def turned_back(yaw):
    """The field in the frame of a level body, with the magnet on its left."""
    east, north, up = 0.0106, 0.2145, -0.4297
    c, s = np.cos(yaw), np.sin(yaw)
    return np.stack([c * east + s * north, c * north - s * east + MAGNET, up + 0.0 * yaw], -1)


def test_the_example_runs(capsys):
    import own_sensor

    own_sensor.main()
    said = capsys.readouterr().out
    assert "observed [" in said
    assert "in info [" in said


def test_it_is_in_info_and_a_part_of_observations():
    config = {"sensors": {"further": FURTHER}}
    parts = ["sensors", "magnetometer", "gyroscope", "barometer"]
    env = eyas.make_vec("citystreet-day", 3, config=config, observation={"parts": parts})
    env.reset(seed=0)
    for _ in range(3):
        seen, *_, info = env.step(np.array([0, 4, 5]))
    assert env.observation_space.contains(seen)
    field = turned_back(info["euler"][:, 2])
    assert info["field"] == pytest.approx(field)
    assert seen["magnetometer"] == pytest.approx(field, rel=1e-6)
    assert np.array_equal(seen["gyroscope"], info["angular_velocity"].astype(np.float32))
    assert np.array_equal(seen["barometer"], info["pressure"].astype(np.float32))
    sensors = env.single_observation_space["sensors"]
    assert sensors.shape == (19,)
    assert env.single_observation_space["barometer"].shape == (1,)


def test_copies_of_environments_remember_late_readings():
    late = {"sensor": PATH, "delay_steps": 40, "rate": 10.0, "noise": 0.1, "drop_out": 0.3}
    env = eyas.make(
        "citystreet-day",
        config={"sensors": {"further": [late]}},
        observation={"parts": ["magnetometer"]},
    )
    env.reset(seed=0)
    for _ in range(30):
        env.step(4)
    twin = copy.deepcopy(env)
    seen = [[each.step(4)[0].tolist() for _ in range(20)] for each in (env, twin)]
    assert seen[0] == seen[1]
    assert len({tuple(reading) for reading in seen[0]}) > 1


def test_it_changes_nothing_else():
    plain, beside = (
        eyas.make_vec("citystreet-day", 2, config=config, observation={"parts": ["sensors"]})
        for config in (None, {"sensors": {"further": FURTHER}})
    )
    for env in (plain, beside):
        env.reset(seed=3)
    for _ in range(5):
        one, two = (env.step(np.array([0, 4])) for env in (plain, beside))
        assert one[0].tobytes() == two[0].tobytes()
        assert one[1].tobytes() == two[1].tobytes()
        assert set(two[-1]) - set(one[-1]) == {"field", "_field", "pressure", "_pressure"}


def test_parts_that_no_sensor_has_are_refused():
    observation = {"parts": ["image", "magnetometer"]}
    with pytest.raises(UnknownNameError, match="did you mean 'magnetometer'"):
        eyas.make("citystreet-day", observation={"parts": ["magnetometre"]},
                  config={"sensors": {"further": [PATH]}})  # fmt: skip
    with pytest.raises(UnknownNameError, match=r"parts: 'magnetometer' is not allowed"):
        eyas.make("citystreet-day", observation=observation)


def test_a_reading_named_as_something_in_info_is_refused(magnetometer, monkeypatch):
    from dataclasses import replace

    monkeypatch.setattr(SENSORS, "_table", dict(SENSORS._table))
    SENSORS.register("seeded", replace(magnetometer, parts={"seed": ("a", "b", "c")}))
    env = eyas.make("citystreet-day", config={"sensors": {"further": ["seeded"]}})
    with pytest.raises(ConfigError, match=r"sensors\.further: 'seed' is not allowed as the name"):
        env.reset(seed=0)


def test_recordings_have_its_readings(tmp_path):
    pytest.importorskip("rosbags")
    folder = tmp_path / "run"
    writers = ["labels", "sensors", "rosbag"]
    config = {
        "sensors": {"further": FURTHER},
        "camera": {"width": 64, "height": 48},
        "video": {"total_time": 0.2, "writers": writers},
    }
    eyas.record(config, out=folder)
    episode = eyas.load(folder)[0]
    rows = np.genfromtxt(episode.folder / SensorWriter.table, delimiter=",", names=True)
    fields = ("field_forward", "field_left", "field_up")
    assert rows.dtype.names == ("frame", "step", *BASIC_FIELDS[1:-2], *fields, "pressure")
    told = np.stack([rows[name] for name in fields], axis=-1)
    assert len(told) == len(episode) > 3
    assert told == pytest.approx(turned_back(rows["yaw"]), abs=1e-6)
    for label, row in zip(episode.labels, told, strict=True):
        assert set(label["signals"]) == {"field", "pressure"}
        assert label["signals"]["field"] == pytest.approx(row, abs=1e-6)
    assert LabelWriter.read(LabelWriter, episode.folder).frames == len(episode)
    messages = bag_of(episode.folder / "rosbag", ("/magnetometer", "/barometer"))
    for message, row in zip(messages["/magnetometer"], told, strict=True):
        field = message.magnetic_field
        assert np.array([field.x, field.y, field.z]) == pytest.approx(1e-4 * row)
    pressures = [message.fluid_pressure for message in messages["/barometer"]]
    assert pressures == pytest.approx(100.0 * rows["pressure"])


def bag_of(folder, topics):
    from rosbags.highlevel import AnyReader

    from eyas.robotics.ros.types import message_types

    found = {topic: [] for topic in topics}
    with AnyReader([folder], default_typestore=message_types("this test")) as reader:
        for connection, _, raw in reader.messages():
            if connection.topic in found:
                found[connection.topic].append(reader.deserialize(raw, connection.msgtype))
    return found


def test_mavlink_takes_it_for_its_compass():
    config = updated(EyasConfig(), {"sensors": {"further": [PATH]}})
    assert part_of(config.sensors, FIELD) == "field"
    assert part_of(config.sensors, PRESSURE) is None
    fitted = further_sensors(equipped(config, config.mavlink).sensors)
    assert [each.sensor.name for each in fitted] == ["magnetometer", "barometer"]
    assert fitted[1].settings == (config.mavlink.altitude,)
    assert all(each.errors.noise == 0.0 for each in fitted)


def test_autopilots_get_no_sensor_that_is_exact():
    given = {"sensors": {"gyroscope": {"noise": 0.5}, "further": [{"sensor": PATH, "noise": 0.7}]}}
    config = updated(EyasConfig(), given)
    sensors = equipped(config, config.mavlink, noisy=True).sensors
    assert sensors.gyroscope.noise == 0.5
    assert sensors.accelerometer.noise == SENSORS.get("accelerometer").noise
    assert sensors.gps_position.noise == 0.0
    noises = [each.errors.noise for each in further_sensors(sensors)]
    assert noises == [0.7, SENSORS.get("barometer").noise]


def test_a_package_adds_it_by_an_entry_point(monkeypatch, magnetometer):
    point = EntryPoint("magnetometer", PATH, "eyas.sensors")
    monkeypatch.setitem(vars(SENSORS), "_points", (point,))
    assert SENSORS.names()[-1] == "magnetometer"
    (fitted,) = further_sensors(SensorsConfig(further=["magnetometer"]))
    assert fitted.sensor is magnetometer


def test_a_file_of_settings_names_it_only_if_it_is_trusted(tmp_path):
    file = tmp_path / "eyas.json"
    file.write_text(f'{{"sensors": {{"further": ["{PATH}"]}}}}')
    with pytest.raises(ConfigError, match=rf"would run code: '{PATH}' \(sensors\.further\.0\.sens"):
        load_settings(file)
    assert load_settings(file, trust=True).sensors.further[0].sensor == PATH


def test_editors_take_names_and_objects():
    validate = pytest.importorskip("jsonschema").validate
    validate({"sensors": {"further": FURTHER}}, config_schema())
    with pytest.raises(Exception, match="3 is not valid"):
        validate({"sensors": {"further": [3]}}, config_schema())


def test_its_numbers_are_finite_and_its_noise_is_its_own():
    noisy = [{"sensor": PATH, "noise": 0.01}]
    config = {"sensors": {"further": noisy}}
    env = eyas.make("citystreet-day", config=config, observation={"parts": ["magnetometer"]})
    env.reset(seed=0)
    read = np.array([env.step(6)[0] for _ in range(100)])
    assert np.isfinite(read).all()
    still = read - read.mean(axis=0)
    assert still.std() == pytest.approx(0.01, rel=0.25)
    assert math.isclose(read[:, 2].mean(), -0.4297, abs_tol=0.005)
