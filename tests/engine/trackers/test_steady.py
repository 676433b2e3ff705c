"""A flown drone that begins at a velocity: in steady flight, so that nothing jumps."""

import math

import numpy as np
import pytest

from eyas.engine.trackers.airframe import ORIGINAL
from eyas.engine.trackers.config import TrackerConfig

from ...kit.flight import FLOWN, Drones, held

POSES = np.array([[0.0, 0.0, 20.0, 0.4, 1.0], [5.0, 0.0, 30.0, -2.5, 0.7]])
VELOCITIES = np.array([[9.0, -4.0], [0.0, 13.0]])


def launched(config=FLOWN, wind=(0.0, 0.0), frame=None):
    drones = Drones(2, config, frame)
    drones.start(POSES)
    drones.memory.wind.mean[:] = wind
    drones.launch(VELOCITIES)
    return drones


def straight_on(drones, steps):
    """Commands that ask for the velocity that each has, in the heading of its body."""
    w, x, y, z = drones.trackers.orientation.T
    east, north = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z)
    east, north = np.array([east, north]) / np.hypot(east, north)
    commands = np.zeros((steps, 2, 4))
    commands[..., 0] = east * VELOCITIES[:, 0] + north * VELOCITIES[:, 1]
    commands[..., 1] = east * VELOCITIES[:, 1] - north * VELOCITIES[:, 0]
    return commands


@pytest.mark.parametrize(
    ("options", "wind"),
    [
        ({}, (0.0, 0.0)),
        ({"motor_time_constant": 0.05}, (0.0, 0.0)),
        ({"drag_area": 0.05, "motor_time_constant": 0.05}, (0.0, 0.0)),
        ({"drag_area": 0.05}, (-3.0, 6.0)),
        ({"drag_area": 0.12}, (8.0, 2.0)),
    ],
)
def test_who_asks_for_the_velocity_that_it_has_changes_nothing(options, wind):
    drones = launched(TrackerConfig(supervised=False, **options), wind)
    first = [drones.trackers.euler.copy(), drones.memory.rotor.copy(), drones.trackers.gimbal]
    first[2] = first[2].copy()
    start = drones.trackers.position.copy()
    # Longer, the controller lets roundings grow: a steep tilt turns the heading of its commands.
    log = drones.fly(straight_on(drones, 150))
    assert np.ptp(log.rotor, axis=0).max() < 1e-6
    for logged, begun in zip((log.euler, log.rotor, log.gimbal), first, strict=True):
        assert np.abs(logged - begun).max() < 1e-7
    assert np.abs(log.velocity[..., :2] - VELOCITIES).max() < 1e-9
    assert np.abs(log.velocity[..., 2]).max() < 1e-9
    travelled = np.arange(1, 151)[:, None, None] * 0.002 * VELOCITIES
    assert np.abs(log.position[..., :2] - start[:, :2] - travelled).max() < 1e-8
    assert np.abs(log.rate).max() < 1e-9


def test_without_drag_it_begins_level_and_with_drag_it_leans_into_it():
    level = launched().trackers
    assert not level.euler[:, :2].any()
    assert level.euler[:, 2] == pytest.approx(POSES[:, 3], abs=1e-15)
    leaning = launched(TrackerConfig(supervised=False, drag_area=0.05)).trackers
    speed = np.hypot(*VELOCITIES.T)
    drag = 0.5 * 1.225 * 0.05 * speed**2
    upright = np.cos(leaning.euler[:, 0]) * np.cos(leaning.euler[:, 1])
    assert np.tan(np.arccos(upright)) == pytest.approx(drag / (3.0069 * 9.81), rel=1e-9)
    # With the wind, at its own velocity, the air is still.
    calm = Drones(config=TrackerConfig(supervised=False, drag_area=0.05))
    calm.memory.wind.mean[:] = 7.0, 0.0
    calm.launch([[7.0, 0.0]])
    assert not calm.trackers.euler.any()


def test_the_camera_looks_where_commanded_from_the_first_instant():
    drones = launched(TrackerConfig(supervised=False, drag_area=0.3))
    assert np.abs(drones.trackers.euler[:, :2]).max() > 0.2
    log = drones.fly(straight_on(drones, 1))
    assert np.arcsin(-log.camera[0, :, 2, 0]) == pytest.approx(POSES[:, 4], abs=1e-6)
    assert log.camera[0, :, 2, 1] == pytest.approx([0.0, 0.0], abs=1e-6)


def test_a_wind_that_no_tilt_withstands_blows_it_back_at_its_limit():
    drones = launched(TrackerConfig(supervised=False, drag_area=3.0))
    log = drones.fly(straight_on(drones, 1))
    tilt = np.arccos(np.cos(drones.trackers.euler[:, 0]) * np.cos(drones.trackers.euler[:, 1]))
    assert tilt == pytest.approx(math.pi / 5, abs=1e-3)
    assert (np.hypot(*log.velocity[0, :, :2].T) < np.hypot(*VELOCITIES.T)).all()


def test_a_hover_brakes_it_with_no_more_than_its_tilt_allows():
    drones = launched()
    log = drones.fly(held(steps=3000))
    speed = np.hypot(log.velocity[..., 0], log.velocity[..., 1])
    assert np.diff(speed, axis=0).min() / 0.002 > -1.15 * 9.81 * math.tan(math.pi / 5)
    assert speed[-1].max() < 0.5


def test_a_launch_forgets_the_flight_before():
    drones = launched(FLOWN, frame=ORIGINAL._replace(motor_time_constant=0.05))
    first = drones.fly(held(forward=9.0, yaw_rate=2.0, steps=300))
    drones.start(POSES)
    drones.launch(VELOCITIES)
    again = drones.fly(held(forward=9.0, yaw_rate=2.0, steps=300))
    for before, now in zip(first, again, strict=True):
        assert np.array_equal(before, now)
