"""Fill the rows of the two packets. Their columns are named in `eyas.task.packets`.

Nothing is cut to six digits, as the original's text streams do.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core.frames import wrap_angle
from eyas.core.jit import kernel
from eyas.core.pinhole import focal_length
from eyas.sensors.config import CameraConfig
from eyas.task.columns import (
    BREACH,
    DIRECTION,
    REASON,
    RELATIVE_POSITION,
    REWARD,
    START_DIRECTION,
    STEP_COUNT,
    VIEW_CENTRE,
)
from eyas.task.done import is_crash
from eyas.trackers.columns import GIMBAL_PITCH
from eyas.trackers.drone import accelerometer

__all__ = ["BASIC_COLUMNS", "REWARD_COLUMNS", "fill_basic", "fill_reward", "reward_rows"]

BASIC_COLUMNS = 22
REWARD_COLUMNS = 60

_CAMERA_POSE, _TARGET_POSE = 7, 23
_VIEW_CENTRE, _TARGET_CENTRE, _CAMERA_POSITION = 39, 42, 45
_RELATIVE = 49


def reward_rows(count: int, camera: CameraConfig) -> NDArray[np.float64]:
    """Return reward packets, shape (count, 60), in which all is set that never changes."""
    rows = np.zeros((count, REWARD_COLUMNS))
    rows[:, 0], rows[:, 1] = camera.width, camera.height
    rows[:, 2] = camera.field_of_view
    rows[:, 3] = focal_length(camera.width, camera.field_of_view)
    rows[:, _CAMERA_POSE + 15] = rows[:, _TARGET_POSE + 15] = 1.0
    rows[:, _TARGET_POSE + 10] = 1.0
    return rows


@kernel
def fill_basic(
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    orientation: NDArray[np.float64],
    euler: NDArray[np.float64],
    angular_velocity: NDArray[np.float64],
    memory: NDArray[np.float64],
    row: NDArray[np.float64],
) -> None:
    """Fill one basic packet.

    Args:
        position: Of the body, world frame [m], shape (3,).
        velocity: World frame [m/s], shape (3,).
        acceleration: World frame [m/s^2], shape (3,).
        orientation: Body to world, shape (4,).
        euler: Roll, pitch, yaw [rad], shape (3,).
        angular_velocity: Body frame [rad/s], shape (3,).
        memory: Row of the task's memory.
        row: Set, shape (22,).
    """
    row[0] = memory[STEP_COUNT]
    row[7], row[8], row[9] = accelerometer(acceleration, orientation)
    for axis in range(3):
        row[1 + axis] = position[axis]
        row[4 + axis] = velocity[axis]
        row[10 + axis] = angular_velocity[axis]
        row[17 + axis] = euler[axis]
    for part in range(4):
        row[13 + part] = orientation[part]
    row[20] = memory[REWARD]
    row[21] = 1.0 if memory[REASON] > 0.0 else 0.0


@kernel
def fill_reward(
    ground: float,
    tracker_memory: NDArray[np.float64],
    commanded_position: NDArray[np.float64],
    euler: NDArray[np.float64],
    camera_position: NDArray[np.float64],
    camera_rotation: NDArray[np.float64],
    target_yaw: float,
    target_centre: NDArray[np.float64],
    memory: NDArray[np.float64],
    row: NDArray[np.float64],
) -> None:
    """Fill what changes in one reward packet.

    Poses and points are in the land frame, the world lifted so that the floor is z = 0, but for
    the view centre, which is in the world frame: that is how the original has it.

    Args:
        ground: z of the floor [m].
        tracker_memory: Row of the tracker's memory.
        commanded_position: Of the tracker's body, world frame [m], shape (3,).
        euler: Roll, pitch, yaw of the body [rad], shape (3,).
        camera_position: Optical centre, world frame [m], shape (3,).
        camera_rotation: Camera to world, shape (3, 3).
        target_yaw: Heading of the target [rad].
        target_centre: The point that the reward looks for, world frame [m], shape (3,).
        memory: Row of the task's memory.
        row: From `reward_rows`, shape (60,); set.
    """
    row[4] = tracker_memory[GIMBAL_PITCH]
    row[5] = commanded_position[2]
    row[6] = memory[START_DIRECTION]
    cosine, sine = np.cos(target_yaw), np.sin(target_yaw)
    row[_TARGET_POSE], row[_TARGET_POSE + 1] = cosine, -sine
    row[_TARGET_POSE + 4], row[_TARGET_POSE + 5] = sine, cosine
    for axis in range(3):
        lift = -ground if axis == 2 else 0.0
        for column in range(3):
            row[_CAMERA_POSE + 4 * axis + column] = camera_rotation[axis, column]
        row[_CAMERA_POSE + 4 * axis + 3] = camera_position[axis] + lift
        row[_TARGET_POSE + 4 * axis + 3] = target_centre[axis] + lift
        row[_TARGET_CENTRE + axis] = target_centre[axis] + lift
        row[_CAMERA_POSITION + axis] = camera_position[axis] + lift
    row[_VIEW_CENTRE], row[_VIEW_CENTRE + 1] = memory[VIEW_CENTRE], memory[VIEW_CENTRE + 1]
    row[_VIEW_CENTRE + 2] = ground
    row[48] = wrap_angle(target_yaw - euler[2])
    # Position, velocity and acceleration lie side by side, in the memory as in the packet.
    for column in range(9):
        row[_RELATIVE + column] = memory[RELATIVE_POSITION + column]
    row[58] = 1.0 if is_crash(memory[BREACH]) else 0.0
    row[59] = memory[DIRECTION]
