"""The car: an ideal robot on the ground, on hills too."""

import math

import numpy as np
import pytest

from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.car import CAR, advance, aim, carry, start
from eyas.lanes import compiled


@compiled
def _driven(trackers, memory, cameras, poses, commands, pose):
    for n in range(poses.shape[0]):
        start(trackers, memory, n, poses[n, 0], poses[n, 1], poses[n, 2], poses[n, 3], poses[n, 4])
        for k in range(commands.shape[0]):
            advance(trackers, memory, n, commands[k])
        if pose.shape[0] > 0:
            carry(trackers, memory, n, pose[0], pose[1], pose[2], pose[3])
        aim(trackers, memory, cameras, n)


def driven(start, commands=(), terrain=None, pose=()):
    """State and cameras of a car after commands, shape (K, 4), from x, y, z, yaw, pitch."""
    trackers, cameras = TrackerState.create(1), CameraState.create(1)
    memory = CAR.memory(1, terrain or Terrain.flat(-0.1))
    numbers = [np.array([start]), np.reshape(commands, (-1, 4)).astype(float), np.array(pose)]
    _driven(trackers, memory, cameras, *numbers)
    return trackers, cameras


def hill():
    """Rises by 0.2 per metre towards the east."""
    return Terrain(-0.1, np.tile(np.arange(41, dtype=np.float32), (2, 1)), -100.0, -100.0, 5.0)


def test_it_obeys_exactly_and_keeps_its_height():
    trackers, _ = driven((1.0, 2.0, 0.5, 0.0, 0.3), np.tile([10.0, 0.0, 0.0, 0.0], (500, 1)))
    # The filter delays by 2.81 steps.
    assert trackers.position[0] == pytest.approx([1.0 + 0.02 * (500 - 2.81), 2.0, 0.5], abs=1e-4)
    assert trackers.velocity[0] == pytest.approx([10.0, 0.0, 0.0])


def test_its_camera_is_at_its_origin_and_looks_up_to_minus_one():
    yaw = 0.7
    for asked, held in ((-3.0, -1.0), (-0.8, -0.8), (0.2, 0.2), (1.6, 1.5)):
        trackers, cameras = driven((1.0, 2.0, 0.5, yaw, asked))
        assert cameras.position[0].tolist() == trackers.position[0].tolist() == [1.0, 2.0, 0.5]
        ahead = [math.cos(yaw) * math.cos(held), math.sin(yaw) * math.cos(held), -math.sin(held)]
        assert cameras.rotation[0, :, 0] == pytest.approx(ahead)
        assert cameras.rotation[0, 2, 1] == pytest.approx(0.0)


def test_on_a_hill_it_keeps_its_height_over_the_ground():
    trackers, _ = driven(
        (0.0, 0.0, 20.4, 0.0, 0.3), np.tile([10.0, 0.0, 0.0, 0.0], (500, 1)), hill()
    )
    x, _, z = trackers.position[0]
    assert x > 9.0
    assert z - 20.4 == pytest.approx(0.2 * x, abs=1e-5)
    assert trackers.velocity[0] == pytest.approx([10.0, 0.0, 2.0], abs=1e-5)
    assert not trackers.euler[0].any()


def test_a_command_upwards_lifts_it_and_the_ground_holds_it():
    up, down = np.tile([0.0, 0.0, 0.01, 0.0], (100, 1)), np.tile([0.0, 0.0, -0.02, 0.0], (100, 1))
    assert driven((0.0, 0.0, 0.5, 0.0, 0.3), up)[0].position[0, 2] == pytest.approx(1.5)
    assert driven((0.0, 0.0, 0.5, 0.0, 0.3), down)[0].position[0, 2] == -0.1
    assert driven((0.0, 0.0, -9.0, 0.0, 0.3))[0].position[0, 2] == -0.1


def test_it_is_carried_to_a_pose_but_not_below_the_ground():
    trackers, _ = driven((0.0, 0.0, 0.5, 0.0, -0.4), pose=(5.0, 0.0, 40.0, 0.3))
    assert trackers.position[0].tolist() == [5.0, 0.0, 40.0]
    assert trackers.gimbal[0] == pytest.approx([0.0, -0.4, 0.0])
    trackers, _ = driven((0.0, 0.0, 20.4, 0.0, 0.3), terrain=hill(), pose=(5.0, 0.0, 0.0, 0.3))
    assert trackers.position[0, 2] == pytest.approx(20.9)
