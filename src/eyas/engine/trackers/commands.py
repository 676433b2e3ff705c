"""How commands become a commanded pose: the same for all trackers that follow one."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.state.terrain import Terrain
from eyas.engine.trackers.lowpass import low_pass, settle
from eyas.lanes import kernel


class CommandFilters(NamedTuple):
    """States of the low-pass filters of the commands of N trackers."""

    forward: NDArray[np.float64]  # Filter of the forward command, shape (N, 2)
    left: NDArray[np.float64]  # Filter of the sideways command, shape (N, 2)
    yaw_rate: NDArray[np.float64]  # Filter of the yaw rate command, shape (N, 2)
    gimbal: NDArray[np.float64]  # Filters of the gimbal's roll, pitch and yaw, shape (N, 3, 2)

    @classmethod
    def create(cls, count: int, terrain: Terrain | None = None) -> "CommandFilters":
        """Return the filters of trackers at rest; a `Tracker.memory`, so it may get the ground."""
        pair = (count, 2)
        return cls(np.zeros(pair), np.zeros(pair), np.zeros(pair), np.zeros((count, 3, 2)))


@kernel(inline=True)
def follow_command(
    trackers: TrackerState, filters: CommandFilters, n: int, command: NDArray[np.float64]
) -> tuple[float, float, float]:
    """Move the commanded pose of tracker `n` by one physics step of 2 ms.

    Speeds and yaw rate pass a low-pass each; the step upwards does not. The commanded velocity is
    in the heading frame of the body's present attitude.

    Returns:
        The commanded velocity, east and north [m/s], and the commanded yaw rate [rad/s].
    """
    forward = low_pass(filters.forward[n], command[0])
    left = low_pass(filters.left[n], command[1])
    yaw_rate = low_pass(filters.yaw_rate[n], command[3])
    east, north = heading(trackers.orientation[n])
    along_east, along_north = east * forward - north * left, north * forward + east * left
    commanded = trackers.commanded_position[n]
    commanded[0] += along_east * PHYSICS_STEP
    commanded[1] += along_north * PHYSICS_STEP
    commanded[2] += command[2]
    trackers.commanded_yaw[n] += yaw_rate * PHYSICS_STEP
    return along_east, along_north, yaw_rate


@kernel(inline=True)
def forget_commands(filters: CommandFilters, n: int) -> None:
    """Set the filters of tracker `n` as if it had been told to hover for long."""
    settle(filters.forward[n], 0.0)
    settle(filters.left[n], 0.0)
    settle(filters.yaw_rate[n], 0.0)


@kernel(inline=True)
def heading(orientation: NDArray[np.float64]) -> tuple[float, float]:
    """Return the horizontal direction of the body's x axis, a unit vector."""
    w, x, y, z = orientation[0], orientation[1], orientation[2], orientation[3]
    east, north = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
    length = math.sqrt(east * east + north * north)
    return east / length, north / length
