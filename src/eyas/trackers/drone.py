"""The supervised drone: a level body that follows its low-pass filtered commands exactly."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import wrap_angle
from eyas.core.jit import step_kernel
from eyas.state.snapshot import CameraState, TrackerState
from eyas.trackers.gimbal import advance_gimbal, camera_pose, reset_gimbal
from eyas.trackers.lowpass import low_pass, settle
from eyas.trackers.tracker import Tracker

__all__ = ["DRONE", "DroneMemory", "advance", "aim", "carry", "start"]


class DroneMemory(NamedTuple):
    """States of the low-pass filters of N drones."""

    forward: NDArray[np.float64]
    """Filter of the forward command, shape (N, 2)."""
    left: NDArray[np.float64]
    """Filter of the sideways command, shape (N, 2)."""
    yaw_rate: NDArray[np.float64]
    """Filter of the yaw rate command, shape (N, 2)."""
    gimbal: NDArray[np.float64]
    """Filters of the gimbal's roll, pitch and yaw, shape (N, 3, 2)."""

    @classmethod
    def create(cls, count: int) -> "DroneMemory":
        """Return the memory of drones at rest."""
        pair = (count, 2)
        return cls(np.zeros(pair), np.zeros(pair), np.zeros(pair), np.zeros((count, 3, 2)))


@step_kernel
def advance(
    trackers: TrackerState, memory: DroneMemory, n: int, command: NDArray[np.float64]
) -> None:
    """Move drone `n` by one physics step of 2 ms, see `Tracker.advance`.

    The commands are integrated to a pose (in the heading frame of the previous pose), and the body
    takes that pose in every step. The original intends the same, but a race condition makes it skip
    about half of the steps.
    """
    forward = low_pass(memory.forward[n], command[0])
    left = low_pass(memory.left[n], command[1])
    yaw_rate = low_pass(memory.yaw_rate[n], command[3])
    east, north = _heading(trackers.orientation[n])
    commanded = trackers.commanded_position[n]
    commanded[0] += (east * forward - north * left) * PHYSICS_STEP
    commanded[1] += (north * forward + east * left) * PHYSICS_STEP
    commanded[2] += command[2]
    trackers.commanded_yaw[n] += yaw_rate * PHYSICS_STEP
    _move_to(trackers, n, commanded[0], commanded[1], commanded[2])
    trackers.angular_velocity[n, 2] = yaw_rate
    _stand_level(trackers, n, wrap_angle(trackers.commanded_yaw[n]))
    advance_gimbal(trackers, memory.gimbal, n)


@step_kernel
def carry(
    trackers: TrackerState, memory: DroneMemory, n: int, x: float, y: float, z: float, yaw: float
) -> None:
    """Move a level drone to a pose within one physics step of 2 ms."""
    commanded = trackers.commanded_position[n]
    commanded[0], commanded[1], commanded[2] = x, y, z
    _move_to(trackers, n, x, y, z)
    trackers.angular_velocity[n, 2] = wrap_angle(yaw - trackers.euler[n, 2]) / PHYSICS_STEP
    trackers.commanded_yaw[n] = yaw
    _stand_level(trackers, n, yaw)
    advance_gimbal(trackers, memory.gimbal, n)


@step_kernel
def start(
    trackers: TrackerState,
    memory: DroneMemory,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Place drone `n` at rest with its gimbal at a commanded pitch, see `Tracker.start`."""
    settle(memory.forward[n], 0.0)
    settle(memory.left[n], 0.0)
    settle(memory.yaw_rate[n], 0.0)
    trackers.commanded_yaw[n] = yaw
    point = (x, y, z)
    for axis in range(3):
        trackers.position[n, axis] = point[axis]
        trackers.commanded_position[n, axis] = point[axis]
        trackers.velocity[n, axis] = 0.0
        trackers.acceleration[n, axis] = 0.0
        trackers.angular_velocity[n, axis] = 0.0
    _stand_level(trackers, n, wrap_angle(yaw))
    reset_gimbal(trackers, memory.gimbal, n, pitch, 0.0)


@step_kernel
def aim(trackers: TrackerState, memory: DroneMemory, cameras: CameraState, n: int) -> None:
    """Write the pose of the camera on the gimbal."""
    camera_pose(
        trackers.position[n],
        trackers.orientation[n],
        trackers.gimbal[n],
        cameras.position[n],
        cameras.rotation[n],
    )


@step_kernel
def _move_to(trackers: TrackerState, n: int, x: float, y: float, z: float) -> None:
    """Move within one physics step, and set the velocity and acceleration of that motion."""
    goal = (x, y, z)
    for axis in range(3):
        speed = (goal[axis] - trackers.position[n, axis]) / PHYSICS_STEP
        trackers.acceleration[n, axis] = (speed - trackers.velocity[n, axis]) / PHYSICS_STEP
        trackers.velocity[n, axis] = speed
        trackers.position[n, axis] = goal[axis]


@step_kernel
def _heading(orientation: NDArray[np.float64]) -> tuple[float, float]:
    """Return the horizontal direction of the body's x axis, a unit vector."""
    w, x, y, z = orientation[0], orientation[1], orientation[2], orientation[3]
    east, north = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    length = math.sqrt(east * east + north * north)
    return east / length, north / length


@step_kernel
def _stand_level(trackers: TrackerState, n: int, yaw: float) -> None:
    """Set the attitude of a level body; `yaw` must be wrapped [rad]."""
    euler, orientation = trackers.euler[n], trackers.orientation[n]
    euler[0], euler[1], euler[2] = 0.0, 0.0, yaw
    orientation[0], orientation[1], orientation[2] = math.cos(0.5 * yaw), 0.0, 0.0
    orientation[3] = math.sin(0.5 * yaw)


DRONE = Tracker("drone", DroneMemory.create, start, advance, carry, aim)
"""The supervised drone."""
