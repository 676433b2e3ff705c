"""Direction of the target's motion."""

import math
from enum import IntEnum

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.frames import wrap_angle
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos

_TURNING = 1e-4  # Change of heading in 2 ms above which the target turns [rad]


class TargetDirection(IntEnum):
    """Direction of the target's motion; the original's `carDir`."""

    STOP = 0
    STRAIGHT = 1
    LEFT = 2
    RIGHT = 3


_STOP, _STRAIGHT = int(TargetDirection.STOP), int(TargetDirection.STRAIGHT)
_LEFT, _RIGHT = int(TargetDirection.LEFT), int(TargetDirection.RIGHT)


@kernel
def target_direction(dx: float, dy: float, yaw: float, last_yaw: float, slowest: float) -> int:
    """Return the `TargetDirection` of one 2 ms step.

    Left and right follow the true turn; the original ignores the sign of its rotation axis and so
    swaps them for half of all headings.

    Args:
        dx: Motion east [m].
        dy: Motion north [m].
        yaw: Heading [rad].
        last_yaw: Heading one step ago [rad].
        slowest: Speed below which it stands [m/s], see `eyas.engine.targets.kind.Kind`.
    """
    turn = wrap_angle(yaw - last_yaw)
    if turn > _TURNING:
        return _LEFT
    if turn < -_TURNING:
        return _RIGHT
    return _STOP if math.sqrt(dx * dx + dy * dy) < slowest * PHYSICS_STEP else _STRAIGHT


@kernel
def target_centre(
    x: float,  # Reference point of the target, east [m]
    y: float,  # Reference point of the target, north [m]
    yaw: float,  # Heading of the target [rad]
    # Distance of the point ahead of the reference point, see `eyas.engine.targets.kind.Kind` [m]
    ahead: float,
) -> tuple[float, float]:
    """Return the point that the reward uses, east and north [m]."""
    sine, cosine = sin_cos(yaw)
    return x + ahead * cosine, y + ahead * sine
