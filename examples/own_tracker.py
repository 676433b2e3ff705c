"""A tracker of your own: `python examples/own_tracker.py`.

A small aeroplane, which cannot hover: it turns by banking, and its camera is fixed to it. In a file
of settings, on the command line and in recordings it is named by the path of its class: `eyas video
--set tracker.kind=own_tracker:Aeroplane --set video.flight=random` (with this folder on
PYTHONPATH).
"""

import math
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

import eyas  # noqa: F401  # registers the environments
from eyas import (
    PHYSICS_STEP,
    CameraState,
    Terrain,
    Tracker,
    TrackerConfig,
    TrackerState,
    kernel,
    rotate,
)

CRUISE, SLOWEST, FASTEST = 16.0, 12.0, 24.0
"""Speeds through the air [m/s]."""

STEEPEST, ROLLING = 0.8, 2.0
"""Largest bank [rad], and how fast it changes [rad/s]."""

GRAVITY = 9.81


class Memory(NamedTuple):
    """What N aeroplanes remember; any record of arrays with a leading axis N."""

    speed: NDArray[np.float64]
    """[m/s], shape (N,)."""
    pitch: NDArray[np.float64]
    """Pitch of the camera below the nose [rad], shape (N,)."""

    @classmethod
    def create(cls, count: int, terrain: Terrain) -> "Memory":
        """Return the memory of aeroplanes on the ground."""
        return cls(np.zeros(count), np.zeros(count))


# The kernels: plain functions of numbers and arrays, compiled by Eyas. They work on tracker `n`.


@kernel(inline=True)
def start(
    trackers: TrackerState,
    memory: Memory,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Begin an episode: in the air, level, at cruising speed."""
    memory.speed[n], memory.pitch[n] = CRUISE, pitch
    trackers.position[n, 0], trackers.position[n, 1], trackers.position[n, 2] = x, y, z
    trackers.velocity[n, 0] = CRUISE * math.cos(yaw)
    trackers.velocity[n, 1] = CRUISE * math.sin(yaw)
    trackers.velocity[n, 2] = 0.0
    for axis in range(3):
        trackers.commanded_position[n, axis] = trackers.position[n, axis]
        trackers.acceleration[n, axis] = 0.0
        trackers.angular_velocity[n, axis] = 0.0
    trackers.euler[n, 0], trackers.euler[n, 1], trackers.euler[n, 2] = 0.0, 0.0, yaw
    point_nose(trackers, n)


@kernel(inline=True)
def advance(trackers: TrackerState, memory: Memory, n: int, command: NDArray[np.float64]) -> None:
    """Fly for 2 ms: `command` is forward, left [m/s], up [m per 2 ms], turn rate [rad/s]."""
    speed = min(max(command[0], SLOWEST), FASTEST)
    memory.speed[n] += (speed - memory.speed[n]) * PHYSICS_STEP / 1.5
    # To turn, it banks; a coordinated turn has the rate g tan(bank) / speed.
    bank = -math.atan(command[3] * memory.speed[n] / GRAVITY)
    bank = min(max(bank, -STEEPEST), STEEPEST)
    most = ROLLING * PHYSICS_STEP
    euler, velocity = trackers.euler[n], trackers.velocity[n]
    change = min(max(bank - euler[0], -most), most)
    turn = -GRAVITY * math.tan(euler[0]) / memory.speed[n]
    euler[0] += change
    euler[2] += turn * PHYSICS_STEP
    euler[2] -= 2.0 * math.pi * math.floor((euler[2] + math.pi) / (2.0 * math.pi))
    trackers.angular_velocity[n, 0] = change / PHYSICS_STEP
    trackers.angular_velocity[n, 2] = turn * math.cos(euler[0])
    climb = min(max(command[2] / PHYSICS_STEP, -3.0), 3.0)
    goal = (memory.speed[n] * math.cos(euler[2]), memory.speed[n] * math.sin(euler[2]), climb)
    for axis in range(3):
        trackers.acceleration[n, axis] = (goal[axis] - velocity[axis]) / PHYSICS_STEP
        velocity[axis] = goal[axis]
        trackers.position[n, axis] += velocity[axis] * PHYSICS_STEP
        trackers.commanded_position[n, axis] = trackers.position[n, axis]
    point_nose(trackers, n)


@kernel(inline=True)
def carry(
    trackers: TrackerState, memory: Memory, n: int, x: float, y: float, z: float, yaw: float
) -> None:
    """Be put somewhere within 2 ms, as in recordings without actions."""
    start(trackers, memory, n, x, y, z, yaw, memory.pitch[n])


@kernel(inline=True)
def aim(trackers: TrackerState, memory: Memory, cameras: CameraState, n: int) -> None:
    """Write the camera's place and its axes, forward, left and up: it banks with the body."""
    sine, cosine = math.sin(memory.pitch[n]), math.cos(memory.pitch[n])
    for axis in range(3):
        cameras.position[n, axis] = trackers.position[n, axis]
    axes = cameras.rotation[n]
    axes[0, 0], axes[1, 0], axes[2, 0] = rotate(trackers.orientation[n], cosine, 0.0, -sine)
    axes[0, 1], axes[1, 1], axes[2, 1] = rotate(trackers.orientation[n], 0.0, 1.0, 0.0)
    axes[0, 2], axes[1, 2], axes[2, 2] = rotate(trackers.orientation[n], sine, 0.0, cosine)


@kernel(inline=True)
def point_nose(trackers: TrackerState, n: int) -> None:
    """Set the attitude of a body that heads and banks."""
    half_bank, half_yaw = 0.5 * trackers.euler[n, 0], 0.5 * trackers.euler[n, 2]
    attitude = trackers.orientation[n]
    attitude[0] = math.cos(half_yaw) * math.cos(half_bank)
    attitude[1] = math.cos(half_yaw) * math.sin(half_bank)
    attitude[2] = math.sin(half_yaw) * math.sin(half_bank)
    attitude[3] = math.sin(half_yaw) * math.cos(half_bank)


class Aeroplane(Tracker):
    """What the settings name: called with them, it gives the kernels."""

    def __init__(self, config: TrackerConfig) -> None:
        super().__init__(
            "aeroplane", Memory.create, start, advance, carry, aim, jumps=False, visible=False
        )


def main() -> None:
    """Fly a curve, and print the bank and the heading on the way."""
    env: gymnasium.Env[Any, Any] = gymnasium.make(
        "eyas/citystreet-day-v0",
        config={"tracker": {"kind": f"{__name__}:Aeroplane"}, "done": {"no_reward_steps": 10_000}},
        actions="velocity",
    )
    env.reset(seed=0)
    for step in range(150):
        *_, info = env.step(np.array([18.0, 0.0, 0.0, 0.3], np.float32))
        if step % 30 == 29:
            print("bank, pitch, heading:", info["euler"].round(2), "at", info["position"].round(1))


if __name__ == "__main__":
    main()
