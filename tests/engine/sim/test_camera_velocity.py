"""Velocities of cameras: the change of their poses, and nothing where nothing needs them."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig, MountConfig
from eyas.engine.camera.shutter import ShutterConfig
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.task.config import StartConfig

FLIGHT = np.array([[6.0, -2.0, 0.002, 1.5], [0.0, 0.0, 0.0, -2.0]])


def flown(**camera):
    camera = CameraConfig(width=84, height=84, **camera)
    simulation = build_simulation(SimConfig(camera=camera), each_alone(2))
    simulation.reset()
    return simulation


@pytest.mark.slow
@pytest.mark.parametrize("mount", [None, MountConfig(x=0.1, pitch=0.9)])
def test_poses_change_by_the_velocities(mount):
    simulation = flown(shutter=ShutterConfig(blur=True), mount=mount)
    simulation.advance(FLIGHT, 200)
    cameras = simulation.snapshot.cameras
    before = cameras.position.copy(), cameras.rotation.copy()
    simulation.advance(FLIGHT, 1)
    velocity, turning = cameras.velocity, cameras.angular_velocity
    np.testing.assert_allclose(velocity, (cameras.position - before[0]) / PHYSICS_STEP, atol=1e-9)
    for n in range(2):
        moved = before[1][n] + PHYSICS_STEP * np.cross(turning[n], before[1][n], axis=0)
        np.testing.assert_allclose(moved, cameras.rotation[n], atol=1e-5)
    assert turning[:, 2] == pytest.approx([1.5, -2.0], rel=0.05)


def test_an_episode_begins_with_the_velocity_of_its_body():
    config = SimConfig(
        camera=CameraConfig(shutter=ShutterConfig(blur=True)), start=StartConfig(velocity="target")
    )
    simulation = build_simulation(config, each_alone(2))
    simulation.reset()
    simulation.advance(FLIGHT, 20)
    simulation.reset()
    cameras = simulation.snapshot.cameras
    np.testing.assert_array_equal(cameras.velocity, simulation.snapshot.trackers.velocity)
    np.testing.assert_array_equal(cameras.angular_velocity, 0.0)


def test_they_are_not_kept_up_where_nothing_needs_them():
    simulation = flown()
    simulation.advance(FLIGHT, 20)
    assert not simulation.snapshot.cameras.velocity.any()
    assert not simulation.snapshot.cameras.angular_velocity.any()
