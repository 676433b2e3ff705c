"""The supervised drone: a level body that follows its low-pass filtered commands exactly."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import wrap_angle
from eyas.engine.state.snapshot import CameraState, TrackerState
from eyas.engine.trackers.commands import CommandFilters, follow_command, forget_commands
from eyas.engine.trackers.gimbal import advance_gimbal, camera_pose, reset_gimbal
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos


@kernel(inline=True)
def advance(
    trackers: TrackerState, filters: CommandFilters, n: int, command: NDArray[np.float64]
) -> None:
    """Move drone `n` by one physics step of 2 ms, see `Tracker.advance`.

    The commands are integrated to a pose (in the heading frame of the previous pose), and the body
    takes that pose in every step. The original intends the same, but a race condition makes it skip
    about half of the steps.
    """
    _, _, yaw_rate = follow_command(trackers, filters, n, command)
    obey(trackers, n, yaw_rate)
    advance_gimbal(trackers, filters.gimbal, n)


@kernel(inline=True)
def obey(trackers: TrackerState, n: int, yaw_rate: float) -> None:
    """Put a level body at its commanded pose within one physics step; `yaw_rate` led there."""
    commanded = trackers.commanded_position[n]
    _move_to(trackers, n, commanded[0], commanded[1], commanded[2])
    trackers.angular_velocity[n, 2] = yaw_rate
    _stand_level(trackers, n, wrap_angle(trackers.commanded_yaw[n]))


@kernel(inline=True)
def carry(
    trackers: TrackerState,
    filters: CommandFilters,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
) -> None:
    """Move a level drone to a pose within one physics step of 2 ms."""
    move_level(trackers, n, x, y, z, yaw)
    advance_gimbal(trackers, filters.gimbal, n)


@kernel(inline=True)
def move_level(trackers: TrackerState, n: int, x: float, y: float, z: float, yaw: float) -> None:
    """Move a level body to a pose within one physics step of 2 ms, as if it had been commanded."""
    commanded = trackers.commanded_position[n]
    commanded[0], commanded[1], commanded[2] = x, y, z
    _move_to(trackers, n, x, y, z)
    trackers.angular_velocity[n, 2] = wrap_angle(yaw - trackers.euler[n, 2]) / PHYSICS_STEP
    trackers.commanded_yaw[n] = yaw
    _stand_level(trackers, n, yaw)


@kernel(inline=True)
def start(
    trackers: TrackerState,
    filters: CommandFilters,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
    pitch: float,
) -> None:
    """Place drone `n` at rest with its gimbal at a commanded pitch, see `Tracker.start`."""
    place(trackers, filters, n, x, y, z, yaw)
    reset_gimbal(trackers, filters.gimbal, n, pitch, 0.0)


@kernel(inline=True)
def place(
    trackers: TrackerState,
    filters: CommandFilters,
    n: int,
    x: float,
    y: float,
    z: float,
    yaw: float,
) -> None:
    """Place a level body at rest, without commands."""
    forget_commands(filters, n)
    trackers.commanded_yaw[n] = yaw
    point = (x, y, z)
    for axis in range(3):
        trackers.position[n, axis] = point[axis]
        trackers.commanded_position[n, axis] = point[axis]
        trackers.velocity[n, axis] = 0.0
        trackers.acceleration[n, axis] = 0.0
        trackers.angular_velocity[n, axis] = 0.0
    _stand_level(trackers, n, wrap_angle(yaw))


@kernel(inline=True)
def aim(trackers: TrackerState, filters: CommandFilters, cameras: CameraState, n: int) -> None:
    """Write the pose of the camera on the gimbal."""
    camera_pose(
        trackers.position[n],
        trackers.orientation[n],
        trackers.gimbal[n],
        cameras.position[n],
        cameras.rotation[n],
    )


@kernel(inline=True)
def _move_to(trackers: TrackerState, n: int, x: float, y: float, z: float) -> None:
    """Move within one physics step, and set the velocity and acceleration of that motion."""
    goal = (x, y, z)
    for axis in range(3):
        speed = (goal[axis] - trackers.position[n, axis]) / PHYSICS_STEP
        trackers.acceleration[n, axis] = (speed - trackers.velocity[n, axis]) / PHYSICS_STEP
        trackers.velocity[n, axis] = speed
        trackers.position[n, axis] = goal[axis]


@kernel(inline=True)
def _stand_level(trackers: TrackerState, n: int, yaw: float) -> None:
    """Set the attitude of a level body; `yaw` must be wrapped [rad]."""
    euler, orientation = trackers.euler[n], trackers.orientation[n]
    euler[0], euler[1], euler[2] = 0.0, 0.0, yaw
    orientation[1], orientation[2] = 0.0, 0.0
    orientation[3], orientation[0] = sin_cos(0.5 * yaw)


DRONE = Tracker("drone", CommandFilters.create, start, advance, carry, aim)  # The supervised drone
