"""When and why an episode ends."""

import math
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import kernel
from eyas.task.columns import (
    BREACH,
    LOST,
    NO_REWARD_COUNT,
    NOT_A_NUMBER,
    REASON,
    REWARD,
    STEP_COUNT,
)
from eyas.task.rules import Rules

__all__ = ["DoneReason", "broken_limit", "is_crash", "judge"]


class DoneReason(IntEnum):
    """Why an episode has ended."""

    NONE = 0
    HEIGHT = 1
    DISTANCE = 2
    VELOCITY = 3
    YAW_RATE = 4
    TILT = 5
    TARGET_LOST = 6
    NO_REWARD = 7
    STEP_LIMIT = 8
    NOT_A_NUMBER = 9

    @property
    def sentence(self) -> str:
        """For a person."""
        return _SENTENCES[self]

    @property
    def original(self) -> str:
        """What the original prints as its `doneState`; it has words for limits of the body only."""
        return _ORIGINALS.get(self, "none")


_SENTENCES = {
    DoneReason.NONE: "The episode goes on.",
    DoneReason.HEIGHT: "The tracker is too low or too high.",
    DoneReason.DISTANCE: "The tracker is too far from where its commands should have brought it.",
    DoneReason.VELOCITY: "The tracker is too fast.",
    DoneReason.YAW_RATE: "The tracker turns too fast.",
    DoneReason.TILT: "The tracker tilts too far.",
    DoneReason.TARGET_LOST: "The target has left the world.",
    DoneReason.NO_REWARD: "There was no reward for too long.",
    DoneReason.STEP_LIMIT: "The episode has reached its number of steps.",
    DoneReason.NOT_A_NUMBER: "A value of the state is not a finite number.",
}
_ORIGINALS = {
    DoneReason.HEIGHT: "height",
    DoneReason.DISTANCE: "distance",
    DoneReason.VELOCITY: "velocity",
    DoneReason.YAW_RATE: "yaw velocity",
    DoneReason.TILT: "pitch or yaw angle",
}

_NONE, _HEIGHT, _DISTANCE, _VELOCITY, _YAW_RATE, _TILT = range(6)
_TARGET_LOST, _NO_REWARD, _STEP_LIMIT, _NOT_A_NUMBER = range(6, 10)


@kernel
def broken_limit(
    height: float,
    error: float,
    speed: float,
    yaw_rate: float,
    roll: float,
    pitch: float,
    rules: Rules,
) -> int:
    """Return the `DoneReason` of the first limit that the body breaks, or `NONE`.

    It takes numbers, because handing rows to a kernel that numba does not inline counts their
    references, which made `judge` take 200 ns instead of 4.

    Args:
        height: z of the body [m].
        error: Horizontal distance between commanded and true position [m].
        speed: Horizontal [m/s].
        yaw_rate: [rad/s]
        roll: [rad]
        pitch: [rad]
        rules: The limits.
    """
    if height < rules.min_height or height > rules.max_height:
        return _HEIGHT
    if error > rules.distance_error:
        return _DISTANCE
    if speed >= rules.velocity:
        return _VELOCITY
    if abs(yaw_rate) > rules.yaw_rate:
        return _YAW_RATE
    if abs(roll) > rules.roll or abs(pitch) > rules.pitch:
        return _TILT
    return _NONE


@kernel
def judge(
    rules: Rules,
    lost: bool,
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    angular_velocity: NDArray[np.float64],
    euler: NDArray[np.float64],
    commanded_position: NDArray[np.float64],
    target_centre: NDArray[np.float64],
    memory: NDArray[np.float64],
) -> int:
    """Count one physics step, and return the `DoneReason`; after `observe`.

    The order is the original's: limits of the body, lost target, no reward, number of steps, all
    masked while the episode is young; not-a-number never is. Two things are mended: a lost target
    stays lost (the original says so for one step of 2 ms, which clients miss), and a limit that
    is kept again is forgotten.

    Args:
        rules: The limits.
        lost: Whether the target has left the world.
        position: World frame [m], shape (3,).
        velocity: World frame [m/s], shape (3,).
        angular_velocity: Body frame [rad/s], shape (3,).
        euler: Roll, pitch, yaw [rad], shape (3,).
        commanded_position: World frame [m], shape (3,).
        target_centre: The point that the reward looks for [m], shape (3,).
        memory: Row of the task's memory; changes.
    """
    error_x = commanded_position[0] - position[0]
    error_y = commanded_position[1] - position[1]
    error = math.sqrt(error_x * error_x + error_y * error_y)
    speed = math.sqrt(velocity[0] * velocity[0] + velocity[1] * velocity[1])
    breach = broken_limit(position[2], error, speed, angular_velocity[2], euler[0], euler[1], rules)
    # A sum is finite if its terms are; finite terms add up to infinity only near 1e308.
    total = memory[REWARD] + euler[0] + euler[1] + euler[2] + angular_velocity[2]
    for axis in range(3):
        total += position[axis] + velocity[axis] + target_centre[axis]
    memory[STEP_COUNT] += 1.0
    memory[BREACH] = breach
    if lost:
        memory[LOST] = 1.0
    if memory[REWARD] > rules.cut_off:
        memory[NO_REWARD_COUNT] = 0.0
    else:
        memory[NO_REWARD_COUNT] += 1.0
    if not math.isfinite(total):
        memory[NOT_A_NUMBER] = 1.0
    reason = _reason(breach, rules, memory)
    memory[REASON] = reason
    return reason


@kernel
def _reason(breach: int, rules: Rules, memory: NDArray[np.float64]) -> int:
    if memory[NOT_A_NUMBER] > 0.0:
        return _NOT_A_NUMBER
    if memory[STEP_COUNT] < rules.grace_steps:
        return _NONE
    if breach != _NONE:
        return breach
    if memory[LOST] > 0.0:
        return _TARGET_LOST
    if memory[NO_REWARD_COUNT] > rules.no_reward_steps:
        return _NO_REWARD
    if memory[STEP_COUNT] >= rules.total_steps:
        return _STEP_LIMIT
    return _NONE


@kernel
def is_crash(breach: float) -> bool:
    """Return whether a broken limit is what the original calls a crash."""
    return breach == _DISTANCE or breach == _YAW_RATE
