"""Exact following: the body is carried along at a fixed offset from its target."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import wrap_angle
from eyas.core.jit import kernel
from eyas.trackers.columns import COMMANDED_YAW

__all__ = ["carry_drone", "offset_pose"]


@kernel
def offset_pose(
    target: NDArray[np.float64], target_yaw: float, offset: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Return x, y, z [m] and yaw [rad] of a body at an offset from a target.

    Args:
        target: Reference point of the target, world frame [m], shape (3,).
        target_yaw: Heading of the target [rad].
        offset: Forward, left, up in the body's heading frame [m], and its heading relative to the
            target's [rad], shape (4,).
    """
    yaw = target_yaw + offset[3]
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x = target[0] + cosine * offset[0] - sine * offset[1]
    y = target[1] + sine * offset[0] + cosine * offset[1]
    return x, y, target[2] + offset[2], wrap_angle(yaw)


@kernel
def carry_drone(
    pose: tuple[float, float, float, float],
    memory: NDArray[np.float64],
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    orientation: NDArray[np.float64],
    euler: NDArray[np.float64],
    angular_velocity: NDArray[np.float64],
    commanded_position: NDArray[np.float64],
) -> None:
    """Put one level drone at a pose, one physics step of 2 ms after the pose it has.

    Args:
        pose: From `offset_pose`.
        memory: Columns of `eyas.trackers.columns`; the commanded yaw is set.
        position: World frame [m], shape (3,).
        velocity: Difference of the last two positions over 2 ms [m/s], shape (3,).
        acceleration: Difference of the last two velocities over 2 ms [m/s^2], shape (3,).
        orientation: Body to world, shape (4,).
        euler: Roll, pitch, yaw [rad], shape (3,).
        angular_velocity: Body frame [rad/s], shape (3,).
        commanded_position: The same as the position afterwards [m], shape (3,).
    """
    for axis in range(3):
        speed = (pose[axis] - position[axis]) / PHYSICS_STEP
        acceleration[axis] = (speed - velocity[axis]) / PHYSICS_STEP
        velocity[axis] = speed
        position[axis] = pose[axis]
        commanded_position[axis] = pose[axis]
    yaw = pose[3]
    angular_velocity[2] = wrap_angle(yaw - euler[2]) / PHYSICS_STEP
    memory[COMMANDED_YAW] = yaw
    euler[2] = yaw
    orientation[0], orientation[3] = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
