"""A tracker of one's own: a rover that drives straight ahead, with a camera fixed on its mast."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.terrain import Terrain
from eyas.engine.task.config import DoneConfig
from eyas.engine.task.done import DoneReason
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import kernel

MAST, HEIGHT, STEP = 2.5, 0.4, 0.002


class RoverMemory(NamedTuple):
    travelled: NDArray[np.float64]
    """Since the start [m], shape (N,)."""

    @classmethod
    def create(cls, count: int, terrain: Terrain) -> "RoverMemory":
        return cls(np.zeros(count))


@kernel(inline=True)
def start(trackers, memory, n, x, y, z, yaw, pitch):
    memory.travelled[n] = 0.0
    trackers.position[n, 0], trackers.position[n, 1], trackers.position[n, 2] = x, y, HEIGHT
    trackers.orientation[n, 0], trackers.orientation[n, 3] = math.cos(yaw / 2), math.sin(yaw / 2)
    trackers.euler[n, 2] = yaw
    for axis in range(3):
        trackers.velocity[n, axis] = 0.0
        trackers.commanded_position[n, axis] = trackers.position[n, axis]


@kernel(inline=True)
def advance(trackers, memory, n, command):
    speed = max(command[0], 0.0)
    yaw = trackers.euler[n, 2]
    memory.travelled[n] += speed * STEP
    trackers.velocity[n, 0], trackers.velocity[n, 1] = speed * math.cos(yaw), speed * math.sin(yaw)
    for axis in range(2):
        trackers.position[n, axis] += trackers.velocity[n, axis] * STEP
        trackers.commanded_position[n, axis] = trackers.position[n, axis]


@kernel(inline=True)
def carry(trackers, memory, n, x, y, z, yaw):
    start(trackers, memory, n, x, y, z, yaw, 0.0)


@kernel(inline=True)
def aim(trackers, memory, cameras, n):
    cosine, sine = math.cos(trackers.euler[n, 2]), math.sin(trackers.euler[n, 2])
    rotation = cameras.rotation[n]
    for axis in range(3):
        cameras.position[n, axis] = trackers.position[n, axis] + (MAST if axis == 2 else 0.0)
    rotation[0, 0], rotation[1, 0], rotation[2, 0] = cosine, sine, 0.0
    rotation[0, 1], rotation[1, 1], rotation[2, 1] = -sine, cosine, 0.0
    rotation[0, 2], rotation[1, 2], rotation[2, 2] = 0.0, 0.0, 1.0


ROVER = Tracker("rover", RoverMemory.create, start, advance, carry, aim)


@pytest.fixture
def rovers(config, assets):
    on_the_ground = DoneConfig(min_height=-1.0, no_reward_steps=10_000)
    settings = config.model_copy(update={"done": on_the_ground})
    simulation = Simulation(settings, assets, ROVER, each_alone(2))
    simulation.reset()
    return simulation


def test_a_rover_moves_only_ahead_and_on_the_ground(rovers):
    trackers, _, targets, episodes, _ = rovers.snapshot
    before = rovers.snapshot.copy()
    result = rovers.advance(np.array([[10.0, 5.0, 0.1, 1.0], [-9.0, 0.0, 0.0, 0.0]]), 250)
    moved = trackers.position - before.trackers.position
    yaw = trackers.euler[0, 2]
    assert moved[0] == pytest.approx([5.0 * math.cos(yaw), 5.0 * math.sin(yaw), 0.0])
    assert not moved[1].any()
    assert (trackers.position[:, 2] == HEIGHT).all()
    assert np.array_equal(trackers.euler, before.trackers.euler)
    assert rovers._stepper._memory.travelled == pytest.approx([5.0, 0.0])
    # All around it is as ever: traffic, time and packets.
    assert (episodes.tick == before.episodes.tick + 250).all()
    assert not np.array_equal(targets.position, before.targets.position)
    assert result.reason.tolist() == [DoneReason.NONE] * 2
    basic, _ = rovers.packets()
    assert np.array_equal(basic[:, 1:4], trackers.position)


def test_its_camera_stands_on_the_mast_and_sees_the_street(rovers):
    trackers, cameras, *_ = rovers.snapshot
    rovers.advance(np.full((2, 4), 3.0), 10)
    assert cameras.position - trackers.position == pytest.approx(np.tile([0, 0, MAST], (2, 1)))
    picture = Picture.create(2, 48, 64, depth=True)
    rovers.draw(np.arange(2, dtype=np.int32), picture)
    # The ground is at z = -0.1; the lowest row looks down on it at half the field of view.
    down = math.tan(0.7854 / 2) * 240 / 320 * (1 - 1 / 48)
    assert picture.depth[:, -1].max() <= (HEIGHT + MAST + 0.11) / down
    # Level, it does not look down at the ground: there is nothing to reward.
    assert rovers.snapshot.episodes.reward.tolist() == [0.0, 0.0]


def test_it_is_carried_by_its_own_kernel_and_starts_again(rovers):
    rovers.advance(np.full((2, 4), 3.0), 10)
    rovers.carry(5)
    trackers, _, targets, episodes, _ = rovers.snapshot
    offset = np.linalg.norm(trackers.position - targets.position, axis=1)[:]
    assert (offset < np.linalg.norm(episodes.start_offset[:, :3], axis=1)).all()  # on the ground
    assert rovers._stepper._memory.travelled.tolist() == [0.0, 0.0]
    rovers.advance(np.full((2, 4), 3.0), 10)
    rovers.reset(np.array([True, False]))
    assert rovers._stepper._memory.travelled == pytest.approx([0.0, 0.06])


def test_drones_fly_as_ever_beside_it(config, rovers):
    drone = build_simulation(config, each_alone(1))
    drone.reset()
    rovers.advance(np.full((2, 4), 3.0), 10)
    drone.advance(np.array([[10.0, 0.0, 0.0, 0.0]]), 250)
    assert drone.snapshot.trackers.position[0, 2] > 20.0
    # 2.81 steps late, by its low-pass; a rover answers at once.
    speed = np.linalg.norm(drone.snapshot.trackers.velocity[0])
    assert speed == pytest.approx(10.0, abs=1e-6)
