"""What one tracker sees of its target in one physics step: reward, direction, relative motion."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.core.frames import rotate_back
from eyas.core.jit import kernel
from eyas.task.columns import (
    DIRECTION,
    LAST_TARGET,
    LAST_TARGET_YAW,
    MEMORY_COLUMNS,
    RELATIVE_ACCELERATION,
    RELATIVE_POSITION,
    RELATIVE_VELOCITY,
    REWARD,
    SAMPLES,
    START_DIRECTION,
    VIEW_CENTRE,
)
from eyas.task.direction import target_direction
from eyas.task.reward import axis_depth, reward_value, view_centre, view_share
from eyas.task.rules import Rules

__all__ = ["observe", "start_episode"]


@kernel
def start_episode(direction: float, memory: NDArray[np.float64]) -> None:
    """Forget the episode before; `observe` then gives what the first observation says.

    Args:
        direction: Heading at the start relative to the target's [rad].
        memory: Row of the task's memory; set.
    """
    for column in range(MEMORY_COLUMNS):
        memory[column] = 0.0
    memory[START_DIRECTION] = direction


@kernel
def observe(
    rules: Rules,
    camera_position: NDArray[np.float64],
    camera_rotation: NDArray[np.float64],
    position: NDArray[np.float64],
    orientation: NDArray[np.float64],
    target_position: NDArray[np.float64],
    target_yaw: float,
    target_centre: NDArray[np.float64],
    memory: NDArray[np.float64],
) -> None:
    """Compute what is seen of the target; once at a reset and once in each physics step after.

    Args:
        rules: Which reward.
        camera_position: Optical centre, world frame [m], shape (3,).
        camera_rotation: Camera to world, shape (3, 3).
        position: Of the tracker's body, world frame [m], shape (3,).
        orientation: Of the tracker's body, shape (4,).
        target_position: Reference point of the target [m], shape (3,).
        target_yaw: Heading of the target [rad].
        target_centre: The point that the reward looks for [m], shape (3,).
        memory: Row of the task's memory; changes.
    """
    x, y = target_centre[0], target_centre[1]
    depth = axis_depth(camera_position, camera_rotation, rules.ground)
    middle_x, middle_y = view_centre(camera_position, camera_rotation, depth)
    share = view_share(camera_position, camera_rotation, depth, x, y, rules)
    distance = math.sqrt((x - middle_x) ** 2 + (y - middle_y) ** 2)
    memory[REWARD] = reward_value(share, distance, depth, rules)
    memory[VIEW_CENTRE], memory[VIEW_CENTRE + 1] = middle_x, middle_y
    _follow_target(target_position[0], target_position[1], target_yaw, memory)
    _follow_relative(position, orientation, target_centre, memory)
    memory[SAMPLES] = min(memory[SAMPLES] + 1.0, 3.0)


@kernel
def _follow_target(x: float, y: float, yaw: float, memory: NDArray[np.float64]) -> None:
    if memory[SAMPLES] > 0.0:
        dx, dy = x - memory[LAST_TARGET], y - memory[LAST_TARGET + 1]
        memory[DIRECTION] = target_direction(dx, dy, yaw, memory[LAST_TARGET_YAW])
    memory[LAST_TARGET], memory[LAST_TARGET + 1] = x, y
    memory[LAST_TARGET_YAW] = yaw


@kernel
def _follow_relative(
    position: NDArray[np.float64],
    orientation: NDArray[np.float64],
    target_centre: NDArray[np.float64],
    memory: NDArray[np.float64],
) -> None:
    """Differentiate the target's place in the turning body frame.

    Velocity is 0 until there are two positions, acceleration until there are two velocities. (The
    original divides its first sample by the absolute time.)
    """
    place = rotate_back(
        orientation,
        target_centre[0] - position[0],
        target_centre[1] - position[1],
        target_centre[2] - position[2],
    )
    for axis in range(3):
        if memory[SAMPLES] > 0.0:
            speed = (place[axis] - memory[RELATIVE_POSITION + axis]) / PHYSICS_STEP
            if memory[SAMPLES] > 1.0:
                change = speed - memory[RELATIVE_VELOCITY + axis]
                memory[RELATIVE_ACCELERATION + axis] = change / PHYSICS_STEP
            memory[RELATIVE_VELOCITY + axis] = speed
        memory[RELATIVE_POSITION + axis] = place[axis]
