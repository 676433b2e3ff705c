"""The flown drone: what its flights look like."""

import math

import numpy as np
import pytest

from eyas.engine.trackers.airframe import ORIGINAL
from eyas.engine.trackers.config import TrackerConfig

from ...kit.flight import FLOWN, Drones, held

LIMIT = math.pi / 5
AS_THERE = TrackerConfig(supervised=False, flight="original")


def test_it_hovers_without_drift_a_little_below_its_command():
    log = Drones().fly(held(steps=10_000))
    # The controller takes the drone to be 0.1 N lighter than it is, which 17 N/m make up for.
    sunk = (3.0069 * 9.81 - 3.0 * 9.8) / 17.0
    assert log.position[-1, 0] == pytest.approx([0.0, 0.0, 20.0 - sunk], abs=1e-9)
    assert np.abs(log.velocity[-1]).max() < 1e-9
    assert not log.euler.any()


def test_a_forward_command_tilts_it_ahead_and_brings_it_to_the_commanded_speed():
    log = Drones().fly(held(forward=5.0, steps=4000))
    assert log.velocity[-1, 0] == pytest.approx([5.0, 0.0, 0.0], abs=1e-2)
    assert 0.5 < log.euler[:500, 0, 1].max() < LIMIT + 0.06
    behind = log.commanded[:, 0, 0] - log.position[:, 0, 0]
    assert behind.max() == pytest.approx(2.71, abs=0.02)
    assert behind[-1] < 0.01
    # Tilted, it keeps its height within a hand.
    assert np.abs(log.position[:, 0, 2] - 20.0).max() < 0.1


def test_left_is_left_and_a_turn_is_counter_clockwise():
    log = Drones().fly(held(left=3.0, steps=3000))
    assert log.velocity[-1, 0] == pytest.approx([0.0, 3.0, 0.0], abs=2e-2)
    assert log.euler[:500, 0, 0].min() < -0.3
    turned = Drones().fly(held(yaw_rate=1.0, steps=1000))
    # Behind by the angle at which its torque, 2 sin(angle), balances the damping, 0.7 N m at
    # 1 rad/s, and by the filter's 2.81 steps, of which the motion in the last step takes one off.
    behind = math.asin(0.7 / 2.0) + 1.81 * 0.002
    assert turned.euler[-1, 0, 2] == pytest.approx(2.0 - behind, abs=5e-4)
    assert turned.rate[-1, 0] == pytest.approx([0.0, 0.0, 1.0], abs=1e-3)


def test_a_climb_lags_by_the_velocity_that_is_not_fed_forward():
    log = Drones().fly(held(up=0.002, steps=4000))
    assert log.velocity[-1, 0, 2] == pytest.approx(1.0, abs=1e-3)
    sunk = (3.0069 * 9.81 - 3.0 * 9.8) / 17.0
    behind = log.commanded[-1, 0, 2] - log.position[-1, 0, 2]
    assert behind == pytest.approx(10.0 * 1.0 / 17.0 + sunk - 0.002, abs=1e-5)


def test_however_large_the_command_it_accelerates_no_more_than_its_tilt_allows():
    log = Drones().fly(held(forward=40.0, steps=1000))
    speed = log.velocity[:, 0, 0]
    fastest = np.diff(speed).max() / 0.002
    assert fastest == pytest.approx(9.81 * math.tan(LIMIT), rel=0.12)
    assert log.euler[200:, 0, 1].max() < LIMIT + 0.06
    assert log.commanded[-1, 0, 0] - log.position[-1, 0, 0] > 50.0


def test_the_camera_looks_where_commanded_while_the_body_tilts():
    commands = np.concatenate([held(forward=8.0), held(left=8.0), held(forward=-8.0)])
    log = Drones(pitch=0.8).fly(commands)
    pitch = np.arcsin(-log.camera[:, 0, 2, 0])
    roll = np.arcsin(log.camera[:, 0, 2, 1])
    assert np.abs(log.euler[:, 0, :2]).max() > 0.5
    assert np.abs(pitch - 0.8).max() < 0.03
    assert np.abs(roll).max() < 0.03


def test_joints_stop_at_their_limit_and_hold_it():
    for config, most in ((FLOWN, 2.2), (AS_THERE, 1.5)):
        drones = Drones(config=config)
        drones.trackers.commanded_gimbal[0] = 3.0 if config is AS_THERE else 2.5, 0.0
        log = drones.fly(held(steps=500))
        assert log.gimbal[-1, 0] == pytest.approx([0.0, most, 0.0], abs=1e-3)


def off(log, pitch):
    """Angle between the camera and where it should look in each step [rad], shape (K,)."""
    heading = log.euler[:, 0, 2]
    axis = np.stack(
        [
            np.cos(heading) * math.cos(pitch),
            np.sin(heading) * math.cos(pitch),
            np.full(len(heading), -math.sin(pitch)),
        ],
        axis=-1,
    )
    return np.arccos(np.clip((log.camera[:, 0, :, 0] * axis).sum(axis=1), -1.0, 1.0))


WEAVING = np.concatenate(
    [held(8.0, 0.0, steps=600), held(-8.0, 0.0, steps=600), held(6.0, 4.0, 0.0, 1.0, steps=600)]
)
"""Hard acceleration and braking, turns, and both at once."""


@pytest.mark.parametrize("pitch", [0.5, 1.0, 1.37, 1.5])
def test_the_mended_camera_looks_where_commanded_at_any_pitch(pitch):
    log = Drones(pitch=pitch).fly(WEAVING)
    assert off(log, pitch).max() < 0.02
    roll = np.arcsin(np.clip(log.camera[:, 0, 2, 1], -1.0, 1.0))
    assert np.abs(roll).max() < 0.02
    assert np.abs(log.euler[:, 0, 1]).max() > 0.6


def test_the_original_s_joints_swing_round_near_the_vertical():
    log = Drones(config=AS_THERE, pitch=1.37).fly(WEAVING)
    assert 0.7 < off(log, 1.37).max() < 0.9
    assert np.abs(log.gimbal[:, 0]).max(axis=0) == pytest.approx([1.76, 1.5, 1.79], abs=0.05)
    log = Drones(config=AS_THERE, pitch=0.8).fly(WEAVING)
    assert off(log, 0.8).max() < 0.03


def test_each_drone_flies_as_if_alone_whatever_the_number():
    rng = np.random.default_rng(3)
    commands = np.repeat(rng.uniform([-20, -20, -0.01, -2], [20, 20, 0.01, 2], (5, 7, 4)), 60, 0)
    options = TrackerConfig(
        supervised=False,
        motor_time_constant=0.02,
        drag_area=0.05,
        ground_contact=True,
        wind={"speed": 5.0, "turbulence": 8.0},
    )
    for config in (FLOWN, options):
        together = Drones(7, config).fly(commands)
        for n in (0, 6):
            alone = Drones(1, config).fly(commands[:, n : n + 1])
            for many, one in zip(together, alone, strict=True):
                assert np.array_equal(many[:, n], one[:, 0])


def test_a_start_forgets_the_flight_before():
    drones = Drones(config=FLOWN.model_copy(update={"motor_time_constant": 0.05}))
    first = drones.fly(held(forward=9.0, yaw_rate=2.0, steps=300))
    drones.start(np.array([[0.0, 0.0, 20.0, 0.0, 1.0]]))
    again = drones.fly(held(forward=9.0, yaw_rate=2.0, steps=300))
    for before, now in zip(first, again, strict=True):
        assert np.array_equal(before, now)


def test_slow_rotors_follow_by_their_time_constant():
    frame = ORIGINAL._replace(motor_time_constant=0.05)
    drones = Drones(frame=frame)
    hover = math.sqrt(0.25 * 3.0069 * 9.81 / 2.55e-5)
    drones.trackers.commanded_position[0, 2] += 0.5
    log = drones.fly(held(steps=1))
    goal = math.sqrt(0.25 * (3.0 * 9.8 + 17.0 * 0.5) / 2.55e-5)
    assert log.rotor[0, 0] == pytest.approx(
        goal + (hover - goal) * math.exp(-0.002 / 0.05), rel=1e-12
    )


def test_without_wind_drag_slows_it_and_with_wind_it_leans_into_it():
    calm = Drones(config=TrackerConfig(supervised=False, drag_area=0.05))
    flight = calm.fly(held(forward=10.0, steps=4000))
    drag = 0.5 * 1.225 * 0.05 * 10.0**2
    assert flight.euler[-1, 0, 1] == pytest.approx(math.atan(drag / (3.0 * 9.8)), abs=0.01)
    windy = Drones(config=TrackerConfig(supervised=False, drag_area=0.05))
    windy.memory.wind.mean[0] = 10.0, 0.0
    hover = windy.fly(held(steps=4000))
    assert hover.euler[-1, 0, 1] == pytest.approx(-math.atan(drag / (3.0 * 9.8)), abs=0.01)
    assert hover.position[-1, 0, 0] == pytest.approx(drag / 8.0, abs=0.02)
