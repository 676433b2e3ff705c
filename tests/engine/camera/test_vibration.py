"""Vibration: its spectrum, and that it is in pictures and labels, but not in what flies."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.vibration import Vibration, VibrationConfig
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.sensors.config import SensorsConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import Snapshot

FLIGHT = np.array([[4.0, 0.0, 0.0, 0.0]])


def angles_over(seconds: float, config: VibrationConfig, count: int) -> np.ndarray:
    """Yaw of N shaken cameras that look east, in each physics step, shape (steps, N)."""
    vibration = Vibration.of(config, count)
    for n in range(count):
        vibration.sample(n, EpisodeKey(5, n, 0))
    state = Snapshot.create(count)
    shown = vibration.shaken(state)
    found = []
    for _ in range(round(seconds / PHYSICS_STEP)):
        state.episodes.tick[:] += 1
        vibration.move()
        found.append(shown.cameras.rotation[:, 1, 0].copy())
    return np.array(found)


def test_the_angle_has_the_deviation_and_the_band_that_are_asked_for():
    config = VibrationConfig(angle=0.001, lowest=10.0, highest=40.0, decline=1.0)
    found = angles_over(4.0, config, 200)
    assert found.std() == pytest.approx(0.001, rel=0.05)
    power = (np.abs(np.fft.rfft(found, axis=0)) ** 2).sum(axis=1)
    frequency = np.fft.rfftfreq(len(found), PHYSICS_STEP)
    inside = (frequency > 9.0) & (frequency < 41.0)
    assert power[inside].sum() > 0.99 * power.sum()
    low, high = (frequency > 10) & (frequency < 20), (frequency > 20) & (frequency < 40)
    # Equal parts of the logarithm have as many sinusoids, and twice the frequency half the angle.
    assert power[low].sum() / power[high].sum() == pytest.approx(4.0, rel=0.2)


def simulation_of(angle: float, **settings):
    camera = CameraConfig(width=84, height=84, vibration=VibrationConfig(angle=angle))
    simulation = build_simulation(SimConfig(camera=camera, **settings), each_alone(1))
    simulation.reset()
    return simulation


def drawn(simulation):
    picture = Picture.create(1, 84, 84)
    simulation.view.draw(np.zeros(1, np.int32), picture)
    return picture.rgb


def test_pictures_and_their_poses_shake_and_packets_and_rewards_do_not():
    still, shaken = simulation_of(0.0), simulation_of(0.01)
    for _ in range(5):
        results = [one.advance(FLIGHT, 20) for one in (still, shaken)]
        np.testing.assert_array_equal(results[0].reward, results[1].reward)
        for own, other in zip(still.packets(), shaken.packets(), strict=True):
            np.testing.assert_array_equal(own, other)
    assert (drawn(still) != drawn(shaken)).any()
    own, other = still.view.state.shown.cameras, shaken.view.state.shown.cameras
    np.testing.assert_array_equal(own.position, other.position)
    turned = own.rotation[0].T @ other.rotation[0]
    assert 0.001 < np.arccos((np.trace(turned) - 1) / 2) < 0.06
    np.testing.assert_allclose(other.rotation[0].T @ other.rotation[0], np.eye(3), atol=1e-12)
    steady = shaken.view.state.steady.cameras
    np.testing.assert_array_equal(steady.rotation, own.rotation)


def test_late_pictures_shake_as_at_their_instant():
    late = simulation_of(0.01, sensors=SensorsConfig(camera={"delay_steps": 20}))
    on_time = simulation_of(0.01)
    for simulation, steps in ((late, 120), (on_time, 100)):
        simulation.advance(FLIGHT, steps)
    shown, now = late.view.state.shown.cameras, on_time.view.state.shown.cameras
    np.testing.assert_array_equal(shown.rotation, now.rotation)
    np.testing.assert_array_equal(drawn(late), drawn(on_time))
