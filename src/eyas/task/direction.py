"""Which way the target goes."""

import math
from enum import IntEnum

from eyas.core.frames import wrap_angle
from eyas.core.jit import kernel

__all__ = ["TargetDirection", "target_centre", "target_direction"]

_TURNING = 1e-4
"""Change of heading in 2 ms above which the target turns [rad]."""
_MOVING = 1e-3
"""Way in 2 ms from which on the target moves [m]."""


class TargetDirection(IntEnum):
    """Which way the target goes; the original's `carDir`."""

    STOP = 0
    STRAIGHT = 1
    LEFT = 2
    RIGHT = 3


_STOP, _STRAIGHT = int(TargetDirection.STOP), int(TargetDirection.STRAIGHT)
_LEFT, _RIGHT = int(TargetDirection.LEFT), int(TargetDirection.RIGHT)


@kernel
def target_direction(dx: float, dy: float, yaw: float, last_yaw: float) -> int:
    """Return the `TargetDirection` of one 2 ms step.

    By the true sense of the turn; the original drops the sign of its rotation axis and so swaps
    left and right for half of all headings.

    Args:
        dx: Way east [m].
        dy: Way north [m].
        yaw: Heading [rad].
        last_yaw: Heading a step ago [rad].
    """
    turn = wrap_angle(yaw - last_yaw)
    if turn > _TURNING:
        return _LEFT
    if turn < -_TURNING:
        return _RIGHT
    return _STOP if math.sqrt(dx * dx + dy * dy) < _MOVING else _STRAIGHT


@kernel
def target_centre(x: float, y: float, yaw: float, ahead: float) -> tuple[float, float]:
    """Return the point that the reward looks for, east and north [m].

    Args:
        x: Reference point of the target, east [m].
        y: Reference point of the target, north [m].
        yaw: Heading of the target [rad].
        ahead: How far the point lies ahead of it, see `eyas.targets.kind.Kind` [m].
    """
    return x + ahead * math.cos(yaw), y + ahead * math.sin(yaw)
