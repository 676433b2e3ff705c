"""The table of sensors: what holds for each, built in or a user's own."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.sensors.compass import COMPASS
from eyas.engine.sensors.config import FurtherSensorConfig, ReadingConfig, SensorsConfig
from eyas.engine.sensors.inertial import GRAVITY
from eyas.engine.sensors.original import IMU, ORIGINAL
from eyas.engine.sensors.readings import Readings
from eyas.engine.sensors.table import SENSORS, fitted_sensors, further_sensors
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.packets import BASIC_FIELDS
from eyas.lanes import kernel

NAMES = SENSORS.names()
NOISE, STEPS, COUNT = 0.02, 120, 12


def config_of(name, others=(), **errors):
    """Settings of trackers with a sensor, whose errors these are, and others."""
    further = [FurtherSensorConfig(sensor=other) for other in others]
    if name in {sensor.name for sensor in ORIGINAL}:
        return SensorsConfig(**{name: ReadingConfig(**errors)}, further=further)
    return SensorsConfig(further=[*further, FurtherSensorConfig(sensor=name, **errors)])


def move(snapshot, trackers, step):
    """Put trackers where each is in a step, whoever else is there."""
    state = snapshot.trackers
    snapshot.episodes.step_count[:] = step
    for n, tracker in enumerate(trackers):
        rng = np.random.default_rng((tracker, step))
        state.position[n] = rng.uniform(-100.0, 100.0, 3)
        state.velocity[n] = rng.normal(0.0, 5.0, 3)
        roll, pitch, yaw = state.euler[n] = rng.uniform(-1.0, 1.0, 3)
        x, y, z = (
            np.array([math.cos(0.5 * angle), *(math.sin(0.5 * angle) * np.eye(3)[axis])])
            for axis, angle in enumerate((roll, pitch, yaw))
        )
        state.orientation[n] = product(product(z, y), x)
        state.smoothed[n, 1, 3:] = rng.normal(0.0, 1.0, 3)


def product(p, q):
    (w, *a), (v, *b) = p, q
    a, b = np.array(a), np.array(b)
    return np.array([w * v - a @ b, *(w * b + v * a + np.cross(a, b))])


def matrix(q):
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


TRUTH = {
    "gps_position": lambda state, n: state.position[n],
    "gps_velocity": lambda state, n: state.velocity[n],
    "accelerometer": lambda state, n: matrix(state.orientation[n]).T @ [0.0, 0.0, GRAVITY],
    "gyroscope": lambda state, n: state.smoothed[n, 1, 3:],
    "imu": lambda state, n: [*state.orientation[n], *state.euler[n]],
    "compass": lambda state, n: matrix(state.orientation[n]).T @ [0.0106, 0.2145, -0.4297],
    "barometer": lambda state, n: [1013.25 * (1 - 2.25577e-5 * state.position[n, 2]) ** 5.25588],
}
"""What each reads without errors, by the textbook."""

DERIVED = {"imu": 4}
"""How many of its first numbers follow from the others, errors included."""


def fly(config, trackers=range(COUNT), steps=STEPS, seed=0):
    """Return what all sensors read after a reset and each step, shape (steps + 1, N, columns)."""
    snapshot, count = Snapshot.create(len(trackers)), len(trackers)
    readings = Readings(
        fitted_sensors(config), snapshot, Terrain.flat(0.0), np.ones(count, np.bool_)
    )
    for n, tracker in enumerate(trackers):
        readings.begin(n, np.random.default_rng((seed, tracker)))
    rows = []
    for step in range(steps + 1):
        move(snapshot, trackers, step)
        readings.advance()
        rows.append(readings.told.copy())
    return np.array(rows)


def columns_of(config, name):
    (fitted,) = (each for each in fitted_sensors(config) if each.sensor.name == name)
    return fitted.columns


def readings_of(name, **errors):
    """Return what a sensor with these errors reads, shape (steps + 1, N, width)."""
    config = config_of(name, **errors)
    return fly(config)[..., columns_of(config, name)]


@pytest.fixture(scope="module")
def exact():
    """What each sensor reads without errors."""
    return {name: readings_of(name) for name in NAMES}


def test_the_original_packet_is_one_selection_of_the_table():
    assert tuple(NAMES[:5]) == tuple(sensor.name for sensor in ORIGINAL)
    columns = [column for each in fitted_sensors(SensorsConfig()) for column in each.sensor.columns]
    assert tuple(columns) == BASIC_FIELDS[1:-2]
    assert further_sensors(config_of("imu")) == ()


@pytest.mark.parametrize("name", NAMES)
def test_a_sensor_reads_numbers_with_names_and_a_unit(name, exact):
    sensor = SENSORS.get(name)
    assert sensor.name == name
    assert sensor.unit
    assert sensor.noise > 0.0
    assert exact[name].shape == (STEPS + 1, COUNT, sensor.width)
    others = {column for each in NAMES if each != name for column in SENSORS.get(each).columns}
    assert not others & set(sensor.columns)
    assert list(sensor.slices(3).values())[-1].stop == 3 + sensor.width


@pytest.mark.parametrize("name", NAMES)
def test_without_errors_it_reads_the_truth(name, exact):
    snapshot = Snapshot.create(COUNT)
    for step in (0, 7, STEPS):
        move(snapshot, range(COUNT), step)
        true = [TRUTH[name](snapshot.trackers, n) for n in range(COUNT)]
        assert exact[name][step] == pytest.approx(np.array(true), rel=1e-5, abs=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_it_reads_the_same_whoever_flies_beside(name):
    errors = {"noise": NOISE, "bias": 0.1, "delay_steps": 3, "drop_out": 0.2, "rate": 250.0}
    config = config_of(name, **errors)
    together = fly(config, steps=30)
    for tracker in (0, 5):
        alone = fly(config, trackers=[tracker], steps=30)
        assert alone[:, 0].tobytes() == together[:, tracker].tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_its_noise_is_normal_of_its_deviation_and_nobody_elses(name, exact):
    config = config_of(name, noise=NOISE)
    rows, plain = fly(config), fly(config_of(name))
    columns = columns_of(config, name)
    others = np.ones(rows.shape[-1], np.bool_)
    others[columns] = False
    assert rows[..., others].tobytes() == plain[..., others].tobytes()
    error = (rows[..., columns] - exact[name])[..., DERIVED.get(name, 0) :]
    assert abs(error.mean()) < 4 * NOISE / math.sqrt(error.size)
    assert error.std() == pytest.approx(NOISE, rel=0.06)
    assert np.mean(np.abs(error) < NOISE) == pytest.approx(0.6827, abs=0.04)
    for a, b in [(error[:-1], error[1:]), (error[:, :-1], error[:, 1:])]:
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.1
    if error.shape[-1] > 1:
        assert abs(np.corrcoef(error[..., 0].ravel(), error[..., 1].ravel())[0, 1]) < 0.1


@pytest.mark.parametrize("name", NAMES)
def test_its_bias_lasts_for_the_episode(name, exact):
    error = (readings_of(name, bias=0.05) - exact[name])[..., DERIVED.get(name, 0) :]
    assert np.abs(error - error[0]).max() < 1e-9
    assert np.unique(error[0].round(9)).size == error[0].size
    assert error[0].std() == pytest.approx(0.05, rel=0.6)  # of 12 to 36 numbers


@pytest.mark.parametrize("name", NAMES)
def test_it_is_late_slow_and_misses_readings(name, exact):
    true, steps = exact[name], np.arange(STEPS + 1)
    late = readings_of(name, delay_steps=7)
    assert late.tobytes() == true[np.maximum(steps - 7, 0)].tobytes()
    slow = readings_of(name, rate=100.0)
    assert slow.tobytes() == true[steps // 5 * 5].tobytes()
    missing = readings_of(name, drop_out=0.25)
    fresh = (missing == true).all(-1)
    assert fresh[0].all()
    assert 1.0 - fresh[1:].mean() == pytest.approx(0.25, abs=0.05)
    kept = ~fresh[1:]
    assert (missing[1:][kept] == missing[:-1][kept]).all()


@pytest.mark.parametrize("name", NAMES)
def test_its_random_numbers_do_not_depend_on_what_else_there_is(name):
    others = [other for other in ("barometer", "compass") if other != name]
    errors = {"noise": 1.0, "bias": 1.0, "drop_out": 0.5}
    alone, beside = config_of(name, **errors), config_of(name, others, **errors)
    rows = [fly(each, steps=10)[..., columns_of(each, name)] for each in (alone, beside)]
    assert rows[0].tobytes() == rows[1].tobytes()


def test_further_sensors_do_not_share_random_numbers():
    given = [{"sensor": name, "noise": 1.0} for name in ("compass", "barometer")]
    config = SensorsConfig(further=given, gps_position=ReadingConfig(noise=1.0))
    noise = fly(config) - fly(SensorsConfig(further=("compass", "barometer")))
    first = [each.first for each in fitted_sensors(config)]
    for a, b in ((first[0], first[5]), (first[0], first[6]), (first[5], first[6])):
        assert abs(np.corrcoef(noise[..., a].ravel(), noise[..., b].ravel())[0, 1]) < 0.1


def test_a_sensors_own_settings_are_read():
    high = SensorsConfig(further=[{"sensor": "barometer", "settings": {"altitude": 1000.0}}])
    assert fly(high, [0], 0)[0, 0, -1] == pytest.approx(fly_low() - 112.0, abs=4.0)
    assert further_sensors(high)[0].settings == (1000.0,)


def fly_low():
    return fly(SensorsConfig(further=["barometer"]), [0], 0)[0, 0, -1]


@pytest.mark.parametrize(
    ("further", "line"),
    [
        (["compas"], r"sensors\.further: 'compas' is not allowed; did you mean 'compass'"),
        (["math:pi"], r"sensors\.further: 'math:pi' is a float, not a Sensor"),
        (["compass", "compass"], r"sensors\.further\.1: trackers have a sensor 'compass' already"),
        (["imu"], r"sensors\.further\.0: trackers have a sensor 'imu' already"),
        (
            [{"sensor": "compass", "settings": {"nort": 1.0}}],
            r"sensors\.further\.0\.settings: 'nort' is not allowed; did you mean 'north'",
        ),
    ],
)
def test_what_cannot_be_fitted_is_told_in_a_line(further, line):
    with pytest.raises((ConfigError, UnknownNameError), match=line):
        fitted_sensors(SensorsConfig(further=further))


def test_a_wrong_error_of_a_further_sensor_is_told_with_its_path():
    with pytest.raises(ConfigError, match=r"further\.0\.nose: unknown key; did you mean 'noise'"):
        SensorsConfig(further=[{"sensor": "compass", "nose": 1.0}])
    with pytest.raises(ConfigError, match=r"further\.0: 3 is not allowed: an object with rate"):
        SensorsConfig(further=[3])


def test_readings_of_the_same_name_are_refused(monkeypatch):
    monkeypatch.setattr(SENSORS, "_table", dict(SENSORS._table))
    SENSORS.register("second", replace(COMPASS, name="second"))
    with pytest.raises(ConfigError, match="'magnetic_field' of the sensor 'second' is the name of"):
        fitted_sensors(SensorsConfig(further=["compass", "second"]))


@kernel
def keep_three(snapshot, n, reading):
    pass


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"name": "My Sensor"}, "'My Sensor' is not a name; allowed: a small letter"),
        ({"parts": {"field": ("a", "a")}}, "parts: .* is not allowed: at least one number, each"),
        ({"parts": {}}, "parts: {} is not allowed: at least one number"),
        ({"read": IMU.read.py_func}, "read and settle must be kernels, .*: it is none"),
        ({"settle": keep_three}, "kernels, functions of snapshot, terrain, n, settings, reading"),
    ],
)
def test_what_is_no_sensor_is_refused(changes, line):
    with pytest.raises(ConfigError, match=line):
        replace(COMPASS, **changes)
