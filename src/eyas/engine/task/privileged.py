"""The true motion of targets, seen from their trackers, which no sensor tells."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.snapshot import Snapshot
from eyas.lanes import compiled, kernel
from eyas.lanes.elementary import sin_cos

PRIVILEGED: Final = 16  # Numbers of each tracker


@kernel(inline=True)
def privileged_row(snapshot: Snapshot, n: int, row: NDArray[np.float32]) -> None:
    """Write the numbers of tracker `n`, see `fill_privileged`."""
    trackers, targets, episodes = snapshot.trackers, snapshot.targets, snapshot.episodes
    for axis in range(3):
        row[axis] = episodes.relative_position[n, axis]
        row[3 + axis] = episodes.relative_velocity[n, axis]
        row[6 + axis] = episodes.relative_acceleration[n, axis]
        row[12 + axis] = targets.size[n, axis]
    row[9], row[10] = sin_cos(targets.yaw[n] - trackers.euler[n, 2])
    row[11] = targets.speed[n]
    row[15] = trackers.gimbal[n, 1]


@compiled
def fill_privileged(snapshot: Snapshot, out: NDArray[np.float32]) -> None:
    """Write the true motion of the targets, seen from the trackers.

    The numbers: the target's centre in the body frame [m], its first [m/s] and second [m/s^2]
    change, 3 numbers each; sine and cosine of its heading relative to the body's; its speed [m/s];
    its length, width and height [m]; the pitch of the camera, positive down [rad].

    Args:
        snapshot: N trackers.
        out: Shape (N, 16).
    """
    for n in range(out.shape[0]):
        privileged_row(snapshot, n, out[n])
