"""Errors of the sensors: their statistics, rates, delays and drop-outs."""

import math

import numpy as np
import pytest

from eyas.engine.sensors.config import CameraErrors, ReadingConfig, SensorsConfig
from eyas.engine.sensors.grain import Grain
from eyas.engine.sensors.readings import Readings, must_read
from eyas.engine.sensors.table import fitted_sensors
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.packet_rows import SENSOR_COUNT

POSITION, VELOCITY, FELT, TURN, QUATERNION, EULER = (
    slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12), slice(12, 16), slice(16, 19),
)  # fmt: skip
FIELDS = ("gps_position", "gps_velocity", "accelerometer", "gyroscope", "imu")


class Flight:
    """Trackers whose readings are taken step by step while x grows by 1 m in each."""

    def __init__(self, count=1, seed=0, **errors):
        self.snapshot = Snapshot.create(count)
        fitted, active = fitted_sensors(SensorsConfig(**errors)), np.ones(count, np.bool_)
        self.readings = Readings(fitted, self.snapshot, Terrain.flat(0.0), active)
        for tracker in range(count):
            self.readings.begin(tracker, np.random.default_rng((seed, tracker)))
        self.readings.advance()

    def step(self):
        self.snapshot.episodes.step_count[:] += 1
        self.snapshot.trackers.position[:, 0] += 1.0
        self.readings.advance()
        return self.readings.told.copy()

    def fly(self, steps):
        """Readings after the reset and after each step, shape (steps + 1, N, columns)."""
        return np.array([self.readings.told.copy(), *(self.step() for _ in range(steps))])


def test_without_errors_the_truth_is_read():
    def read(**errors):
        return must_read(fitted_sensors(SensorsConfig(**errors)))

    assert not read()
    assert not read(camera=CameraErrors(noise=3.0))
    assert all(read(**{field: ReadingConfig(noise=1.0)}) for field in FIELDS)
    rows = Flight().fly(20)[:, 0]
    assert rows[:, 0].tolist() == list(range(21))
    assert rows[:, 8] == pytest.approx(9.81)
    assert (rows[:, 12] == 1.0).all()


@pytest.mark.parametrize(
    ("field", "columns"), list(zip(FIELDS, (POSITION, VELOCITY, FELT, TURN, EULER), strict=True))
)
def test_noise_is_normal_of_its_deviation_and_in_its_columns_only(field, columns):
    clean, noisy = (
        Flight(20, **{field: ReadingConfig(noise=deviation)}).fly(150) for deviation in (0.0, 0.02)
    )
    error = noisy - clean
    others = np.ones(SENSOR_COUNT, np.bool_)
    others[columns] = False
    if field == "imu":
        others[QUATERNION] = False
    assert not error[..., others].any()
    error = error[..., columns].reshape(-1, 3)  # about 3,000 readings of 3 numbers
    deviation = 0.02 / math.sqrt(error.size)
    assert abs(error.mean()) < 4 * deviation
    assert error.std() == pytest.approx(0.02, rel=0.04)
    assert np.mean(np.abs(error) < 0.02) == pytest.approx(0.6827, abs=0.025)
    # Numbers, readings and trackers have independent noise.
    table = (noisy - clean)[..., columns]
    pairs = [(table[..., 0], table[..., 1]), (table[:-1], table[1:]), (table[:, :-1], table[:, 1:])]
    for a, b in pairs:
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.06


def test_a_quaternion_says_what_the_euler_angles_say():
    rows = Flight(4, imu=ReadingConfig(noise=0.3)).fly(20).reshape(-1, SENSOR_COUNT)
    w, x, y, z = rows[:, QUATERNION].T
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(2 * (w * y - z * x))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    assert np.stack([roll, pitch, yaw], axis=1) == pytest.approx(rows[:, EULER])


def test_a_bias_lasts_for_the_episode_and_is_drawn_for_each():
    flight = Flight(300, gyroscope=ReadingConfig(bias=0.05))
    rows = flight.fly(10)[..., TURN]
    assert (rows == rows[0]).all()
    assert rows[0].std() == pytest.approx(0.05, rel=0.1)
    assert abs(rows[0].mean()) < 4 * 0.05 / math.sqrt(900)
    for tracker in range(300):
        flight.readings.begin(tracker, np.random.default_rng((1, tracker)))
    flight.snapshot.episodes.step_count[:] = 0
    flight.readings.advance()
    assert (flight.readings.told.copy()[:, TURN] != rows[0]).all()


def test_a_slow_sensor_tells_its_last_reading_in_between():
    rows = Flight(gps_position=ReadingConfig(rate=100.0)).fly(23)[:, 0, 0]
    assert rows.tolist() == [step // 5 * 5 for step in range(24)]


def test_a_late_sensor_tells_what_was():
    rows = Flight(gps_position=ReadingConfig(delay_steps=7)).fly(20)[:, 0, 0]
    assert rows.tolist() == [max(step - 7, 0) for step in range(21)]
    rows = Flight(gps_position=ReadingConfig(delay_steps=7, rate=100.0)).fly(20)[:, 0, 0]
    assert rows.tolist() == [max(step - 7, 0) // 5 * 5 for step in range(21)]


def test_a_missing_reading_is_replaced_by_the_last():
    rows = Flight(50, gps_position=ReadingConfig(drop_out=0.25)).fly(200)[..., 0]
    fresh = rows == np.arange(201)[:, None]
    assert fresh[0].all()
    assert 1 - fresh[1:].mean() == pytest.approx(0.25, abs=0.02)
    held = ~fresh[1:]
    assert (rows[1:][held] == rows[:-1][held]).all()


def test_sensors_do_not_share_random_numbers():
    alone = Flight(gyroscope=ReadingConfig(noise=0.1)).fly(20)[..., TURN]
    beside = Flight(
        gyroscope=ReadingConfig(noise=0.1),
        accelerometer=ReadingConfig(noise=2.0, bias=1.0, drop_out=0.5),
    ).fly(20)[..., TURN]
    np.testing.assert_array_equal(alone, beside)


def test_grain_has_its_deviation_and_each_step_its_own():
    grain = Grain(CameraErrors(noise=6.0), 2)
    for tracker in range(2):
        grain.begin(tracker, np.random.default_rng(tracker))
    step = np.array([5, 5])

    def drawn():
        rgb = np.full((2, 64, 64, 3), 128, np.uint8)
        grain.add(rgb, np.arange(2), step)
        return rgb.astype(int) - 128

    first = drawn()
    assert first.std() == pytest.approx(6.0, rel=0.02)
    assert abs(first.mean()) < 0.2
    np.testing.assert_array_equal(first, drawn())
    assert (first[0] != first[1]).mean() > 0.8
    step += 1
    assert abs(np.corrcoef(first.ravel(), drawn().ravel())[0, 1]) < 0.03
    dark = np.zeros((1, 8, 8, 3), np.uint8)
    grain.add(dark, np.array([0]), step)
    assert dark.max() < 40  # cut off at black, not around to white


def test_the_cameras_bias_is_drawn_for_each_channel_and_episode():
    assert Grain.of(CameraErrors(rate=30.0), 1) is None
    grain = Grain.of(CameraErrors(bias=10.0), 200)
    for tracker in range(200):
        grain.begin(tracker, np.random.default_rng(tracker))
    rgb = np.full((200, 6, 4, 3), 128, np.uint8)
    grain.add(rgb, np.arange(200), np.zeros(200, np.int64))
    error = rgb.astype(int) - 128
    assert (error == error[:, :1, :1]).all()
    assert error[:, 0, 0].std() == pytest.approx(10.0, rel=0.1)
    assert abs(np.corrcoef(error[:, 0, 0, 0], error[:, 0, 0, 1])[0, 1]) < 0.25


def test_a_heading_stays_within_half_a_turn_whatever_its_noise():
    flight = Flight(200, imu=ReadingConfig(noise=0.3))
    flight.snapshot.trackers.euler[:, 2] = 3.1
    yaw = flight.fly(5)[1:, :, EULER.start + 2]
    assert np.abs(yaw).max() <= math.pi
    assert (yaw < 0).any()


def test_sensors_do_not_miss_their_readings_together():
    flight = Flight(20, gps_position=ReadingConfig(drop_out=0.5), imu=ReadingConfig(drop_out=0.5))
    rows = [flight.readings.told.copy()]
    for step in range(200):
        flight.snapshot.trackers.euler[:, 0] = 1e-3 * (step + 1)
        rows.append(flight.step())
    place, roll = (np.diff([row[:, column] for row in rows], axis=0) for column in (0, EULER.start))
    assert abs(np.corrcoef((place > 0).ravel(), (roll > 0).ravel())[0, 1]) < 0.1
