"""How oracles bring the middle of the picture over a point: by seven actions, or by velocities."""

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.tracker.steering import turned
from eyas.engine.policies.steering import towards
from eyas.engine.settings.env import ActionKind, EnvConfig
from eyas.engine.state.snapshot import Snapshot

Floats = NDArray[np.float64]

_RATE = 1.0
"""Share of the error that a velocity makes up for in a second. In 24 flights of `flown` each, with
seeds from 60,000,000 on, 1 and 2 lost nothing, 4 lost .02 of the time."""


def actions_of_oracles(asked: object) -> str:
    """Return the actions of an oracle: velocities if they are asked for, else the seven."""
    return ActionKind.VELOCITY.value if asked == ActionKind.VELOCITY else ActionKind.DISCRETE.value


def flown_over(
    state: Snapshot,
    places: Floats,  # The points, east and north [m], shape (N, 2)
    velocities: Floats,  # How they move [m/s], shape (N, 2)
    levels: Floats,  # Their heights [m] and vertical speeds [m/s], shape (N, 2)
    env: EnvConfig,
) -> NDArray[np.int64] | Floats:
    """Return the actions that bring drones over points that move.

    Seven actions jump by their whole speed, which a drone on a flight controller cannot follow: it
    swings, and is lost. Velocities are those of the points, and steer where the drone is told to
    be, not where it is: else what it cannot follow at once would be asked for twice. Over a target
    that flies, they keep the height above it at which the episode began.

    Returns:
        Numbers of actions, shape (N,), or velocities, shape (N, 4).
    """
    trackers, yaw = state.trackers, state.trackers.euler[:, 2]
    error = places - state.episodes.view_centre[:, :2]
    if env.actions is not ActionKind.VELOCITY:
        return towards(turned(error, -yaw), env)
    error = error - (trackers.commanded_position - trackers.position)[:, :2]
    wanted = turned(velocities + _RATE * error, -yaw)
    height = levels[:, 0] + state.episodes.start_offset[:, 2]
    climb = levels[:, 1] + _RATE * (height - trackers.commanded_position[:, 2])
    up = np.where(state.targets.flies, climb, 0.0)
    return np.column_stack((wanted, up, np.zeros_like(up)))
