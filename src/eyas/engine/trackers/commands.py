"""How commands become a commanded pose: the same for all trackers that follow one."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.lowpass import low_pass, settle
from eyas.lanes import kernel

__all__ = ["follow_command", "forget_commands", "heading"]


@kernel(inline=True)
def follow_command(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # a record with the filters `forward`, `left`, `yaw_rate`
    n: int,
    command: NDArray[np.float64],
) -> tuple[float, float, float]:
    """Move the commanded pose of tracker `n` by one physics step of 2 ms.

    Speeds and yaw rate pass a low-pass each; the step upwards does not. The commanded velocity is
    in the heading frame of the body's present attitude.

    Returns:
        The commanded velocity, east and north [m/s], and the commanded yaw rate [rad/s].
    """
    forward = low_pass(memory.forward[n], command[0])
    left = low_pass(memory.left[n], command[1])
    yaw_rate = low_pass(memory.yaw_rate[n], command[3])
    east, north = heading(trackers.orientation[n])
    along_east, along_north = east * forward - north * left, north * forward + east * left
    commanded = trackers.commanded_position[n]
    commanded[0] += along_east * PHYSICS_STEP
    commanded[1] += along_north * PHYSICS_STEP
    commanded[2] += command[2]
    trackers.commanded_yaw[n] += yaw_rate * PHYSICS_STEP
    return along_east, along_north, yaw_rate


@kernel(inline=True)
def forget_commands(memory: Any, n: int) -> None:  # noqa: ANN401  # as above
    """Set the filters of tracker `n` as if it had been told to hover for long."""
    settle(memory.forward[n], 0.0)
    settle(memory.left[n], 0.0)
    settle(memory.yaw_rate[n], 0.0)


@kernel(inline=True)
def heading(orientation: NDArray[np.float64]) -> tuple[float, float]:
    """Return the horizontal direction of the body's x axis, a unit vector."""
    w, x, y, z = orientation[0], orientation[1], orientation[2], orientation[3]
    east, north = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    length = math.sqrt(east * east + north * north)
    return east / length, north / length
