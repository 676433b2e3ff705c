"""Accelerometer and gyroscope, against a smoothed motion computed apart, at 500 Hz."""

import math

import numpy as np
import pytest

from eyas.engine.sensors.inertial import accelerometer, smoothing_share
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.task.packets import BASIC_FIELDS
from eyas.engine.trackers.config import TrackerConfig

STEP = 0.002
REVERSAL = [[40.0, 0.0, 0.0, 2.0]] * 500 + [[-40.0, 0.0, 0.0, -2.0]] * 500
VELOCITY, FELT, TURN, YAW = (
    BASIC_FIELDS.index(name)
    for name in ("velocity_x", "felt_acceleration_x", "angular_velocity_x", "yaw")
)


@pytest.fixture(scope="module", autouse=True)
def assets():
    return load_assets(SimConfig().world, SimConfig().traffic, 1)


def flown(time_constant, commands=REVERSAL):
    """Basic packets of a flight, the one after the reset first, shape (K, 22)."""
    config = SimConfig(tracker=TrackerConfig(inertial_time_constant=time_constant))
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    rows = [simulation.packets()[0][0]]
    for command in commands:
        simulation.advance(np.array([command]))
        rows.append(simulation.packets()[0][0])
    return np.array(rows)


def smoothed(values, time_constant):
    """Values behind two low-passes that begin at the first."""
    for _ in range(2):
        value, out = values[0], []
        for new in values:
            value = value + (new - value) * -math.expm1(-STEP / time_constant)
            out.append(value)
        values = np.array(out)
    return values


def test_a_reversed_command_reads_like_a_hard_manoeuvre():
    rows = flown(0.1)
    felt = np.linalg.norm(rows[:, FELT : FELT + 3], axis=1)
    assert 100.0 < felt.max() < 300.0
    # No jumps either: at most 12 m/s^2 from one reading to the next.
    assert np.abs(np.diff(rows[:, FELT : FELT + 3], axis=0)).max() < 20.0
    assert np.abs(np.diff(rows[:, TURN + 2])).max() < 0.05


def test_the_readings_are_those_of_the_smoothed_motion():
    rows = flown(0.1)
    velocity = smoothed(rows[:, VELOCITY : VELOCITY + 3], 0.1)
    yaw = smoothed(np.unwrap(rows[:, YAW]), 0.1)
    x, y, z = (np.diff(velocity, axis=0) / STEP).T
    cosine, sine = np.cos(yaw[1:]), np.sin(yaw[1:])
    felt = np.stack((cosine * x + sine * y, -sine * x + cosine * y, z + 9.81), axis=1)
    assert rows[1:, FELT : FELT + 3] == pytest.approx(felt, abs=1e-6)
    assert rows[1:, TURN + 2] == pytest.approx(np.diff(yaw) / STEP, abs=1e-6)
    assert not rows[:, TURN : TURN + 2].any()
    # Hovering at last, one reads gravity and nothing else.
    still = flown(0.1, REVERSAL + [[0.0] * 4] * 2000)[-1]
    assert still[FELT : FELT + 3] == pytest.approx([0.0, 0.0, 9.81], abs=1e-3)


def test_a_time_constant_of_zero_gives_the_differences_of_two_milliseconds():
    rows = flown(0.0, REVERSAL[::50])
    x, y, z = (np.diff(rows[:, VELOCITY : VELOCITY + 3], axis=0) / STEP).T
    cosine, sine = np.cos(rows[1:, YAW]), np.sin(rows[1:, YAW])
    felt = np.stack((cosine * x + sine * y, -sine * x + cosine * y, z + 9.81), axis=1)
    assert np.abs(felt).max() > 5000.0
    assert rows[1:, FELT : FELT + 3] == pytest.approx(felt, abs=1e-6)
    assert rows[1:, TURN + 2] == pytest.approx(np.diff(np.unwrap(rows[:, YAW])) / STEP, abs=1e-6)


def test_a_start_is_at_rest_whatever_was_before():
    config = SimConfig()
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    simulation.advance(np.array([[40.0, 3.0, 0.01, 2.0]]), 100)
    simulation.reset()
    row = simulation.packets()[0][0]
    assert row[FELT : FELT + 3] == pytest.approx([0.0, 0.0, 9.81], abs=1e-12)
    assert not row[TURN : TURN + 3].any()


def test_gravity_and_motion_are_felt_in_the_frame_of_the_smoothed_body():
    trackers = TrackerState.create(2)
    trackers.orientation[1] = math.cos(math.pi / 4), 0.0, 0.0, math.sin(math.pi / 4)  # north
    assert accelerometer(trackers, 1) == pytest.approx((0.0, 0.0, 9.81))
    trackers.smoothed_acceleration[1] = -2.0, 3.0, 1.0
    assert accelerometer(trackers, 1) == pytest.approx((3.0, 2.0, 10.81))
    trackers.smoothed_lag[1] = math.pi / 2  # the smoothed body still looks east
    assert accelerometer(trackers, 1) == pytest.approx((-2.0, 3.0, 10.81))


def test_shares_of_time_constants():
    assert smoothing_share(0.0) == 1.0
    assert smoothing_share(0.1) == pytest.approx(0.0198, abs=1e-4)
