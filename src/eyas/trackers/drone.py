"""The supervised drone: a level body that obeys its commands exactly, but for their low-pass."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import rotate_back, wrap_angle
from eyas.core.jit import kernel
from eyas.trackers.columns import (
    COMMANDED_YAW,
    FORWARD_FILTER,
    LATERAL_FILTER,
    YAW_RATE_FILTER,
)
from eyas.trackers.lowpass import low_pass, settle

__all__ = ["GRAVITY", "accelerometer", "advance_drone", "reset_drone"]

GRAVITY = 9.81
"""[m/s^2]"""


@kernel
def advance_drone(
    action: NDArray[np.float64],
    memory: NDArray[np.float64],
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    orientation: NDArray[np.float64],
    euler: NDArray[np.float64],
    angular_velocity: NDArray[np.float64],
    commanded_position: NDArray[np.float64],
) -> None:
    """Move one drone by one physics step of 2 ms.

    The commands add up to a pose (in the heading frame of the pose before), and the body takes
    that pose in every step. The original meant to, but skipped about half of the steps in a race.
    All but the action are rows of the tracker's state and change.

    Args:
        action: Forward [m/s], left [m/s], up [m per 2 ms], yaw rate [rad/s], shape (4,).
        memory: Columns of `eyas.trackers.columns`.
        position: World frame [m], shape (3,).
        velocity: Difference of the last two positions over 2 ms [m/s], shape (3,).
        acceleration: Difference of the last two velocities over 2 ms [m/s^2], shape (3,).
        orientation: Body to world, shape (4,).
        euler: Roll, pitch, yaw [rad], shape (3,).
        angular_velocity: Body frame [rad/s], shape (3,).
        commanded_position: What the commands add up to [m], shape (3,).
    """
    forward = low_pass(memory, FORWARD_FILTER, action[0])
    left = low_pass(memory, LATERAL_FILTER, action[1])
    yaw_rate = low_pass(memory, YAW_RATE_FILTER, action[3])
    east, north = _heading(orientation)
    commanded_position[0] += (east * forward - north * left) * PHYSICS_STEP
    commanded_position[1] += (north * forward + east * left) * PHYSICS_STEP
    commanded_position[2] += action[2]
    memory[COMMANDED_YAW] += yaw_rate * PHYSICS_STEP
    for axis in range(3):
        speed = (commanded_position[axis] - position[axis]) / PHYSICS_STEP
        acceleration[axis] = (speed - velocity[axis]) / PHYSICS_STEP
        velocity[axis] = speed
        position[axis] = commanded_position[axis]
    angular_velocity[2] = yaw_rate
    _stand_level(memory[COMMANDED_YAW], orientation, euler)


@kernel
def reset_drone(
    x: float,
    y: float,
    z: float,
    yaw: float,
    memory: NDArray[np.float64],
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    orientation: NDArray[np.float64],
    euler: NDArray[np.float64],
    angular_velocity: NDArray[np.float64],
    commanded_position: NDArray[np.float64],
) -> None:
    """Place one drone at rest; rows as in `advance_drone`.

    Args:
        x: East [m].
        y: North [m].
        z: Up [m].
        yaw: Heading [rad].
        memory: The filters of the commands and the commanded yaw change; the gimbal's stay.
        position: Set.
        velocity: Set to zero.
        acceleration: Set to zero.
        orientation: Set.
        euler: Set.
        angular_velocity: Set to zero.
        commanded_position: Set.
    """
    settle(memory, FORWARD_FILTER, 0.0)
    settle(memory, LATERAL_FILTER, 0.0)
    settle(memory, YAW_RATE_FILTER, 0.0)
    memory[COMMANDED_YAW] = yaw
    position[0], position[1], position[2] = x, y, z
    for axis in range(3):
        commanded_position[axis] = position[axis]
        velocity[axis] = 0.0
        acceleration[axis] = 0.0
        angular_velocity[axis] = 0.0
    _stand_level(yaw, orientation, euler)


@kernel
def accelerometer(
    acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Return what an accelerometer in the body feels, body frame [m/s^2]: +9.81 up at rest.

    The true motion is felt. The original reads a physics body that falls and is caught between
    its teleports, so its readings have nothing to do with the motion that is seen.
    """
    return rotate_back(orientation, acceleration[0], acceleration[1], acceleration[2] + GRAVITY)


@kernel
def _heading(orientation: NDArray[np.float64]) -> tuple[float, float]:
    """Return the horizontal direction of the body's x axis, of length 1."""
    w, x, y, z = orientation[0], orientation[1], orientation[2], orientation[3]
    east, north = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    length = math.sqrt(east * east + north * north)
    return east / length, north / length


@kernel
def _stand_level(yaw: float, orientation: NDArray[np.float64], euler: NDArray[np.float64]) -> None:
    wrapped = wrap_angle(yaw)
    euler[0], euler[1], euler[2] = 0.0, 0.0, wrapped
    orientation[0], orientation[1], orientation[2] = math.cos(0.5 * wrapped), 0.0, 0.0
    orientation[3] = math.sin(0.5 * wrapped)
