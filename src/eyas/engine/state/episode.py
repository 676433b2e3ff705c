"""The state of the episodes, a part of `Snapshot`."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class EpisodeState(NamedTuple):
    """The episodes of N trackers: state and results of the task."""

    number: Integers  # Number of the episode, from 0; -1 before the first reset, shape (N,)
    tick: Integers  # Time in the traffic, in physics steps of 2 ms, shape (N,)
    step_count: Integers  # Physics steps since the reset, shape (N,)
    no_reward_count: Integers  # Physics steps since the last reward, shape (N,)
    reward: Floats  # The built-in reward of this instant, shape (N,)
    reason: Integers  # `eyas.engine.task.done.DoneReason`, 0 while the episode goes on, shape (N,).
    breach: Integers
    """`DoneReason` of the limit that the body violates now, whether or not it ends the episode,
    shape (N,)."""
    not_a_number: NDArray[np.bool_]  # Whether a value was not a finite number, shape (N,)
    crash: NDArray[np.bool_]
    """Whether the tracker has crashed, as `done.crash` means it, shape (N,)."""
    contact: Floats
    """Place of the last contact of the body, world frame [m]; zeros if nowhere since the reset,
    shape (N, 3)."""
    contact_object: Integers
    """Object id of what it has touched there, as in `Picture.object_id`; -1 if nothing,
    shape (N,)."""
    direction: Integers  # `eyas.engine.task.direction.TargetDirection`, shape (N,).
    observations: Integers
    """Observations of the target since the reset, counted up to 3, shape (N,)."""
    start_offset: Floats
    """Start relative to the target: forward, left, up [m], heading [rad], shape (N, 4)."""
    offset: Floats  # Horizontal distance of the target from the view centre [m], shape (N,)
    proportion: Floats
    """1 in the middle of the rewarded part of the picture, 0 at its edge and outside, see
    `eyas.engine.task.reward.view_share`, shape (N,)."""
    view_centre: Floats
    """Ground point that the camera looks at, or the point below it [m], shape (N, 3)."""
    last_target: Floats  # Target one step ago: east, north [m] and heading [rad], shape (N, 3)
    first_position: Floats
    """`relative_position` when the target was first observed [m], shape (N, 3)."""
    relative_position: Floats  # The target's centre in the tracker's body frame [m], shape (N, 3)
    relative_velocity: Floats  # Change of `relative_position` [m/s], shape (N, 3)
    relative_acceleration: Floats  # Change of `relative_velocity` [m/s^2], shape (N, 3)

    @classmethod
    def create(cls, count: int) -> "EpisodeState":
        """Return episodes before the first reset."""
        vector = (count, 3)
        return cls(
            number=np.full(count, -1, np.int64),
            tick=np.zeros(count, np.int64),
            step_count=np.zeros(count, np.int64),
            no_reward_count=np.zeros(count, np.int64),
            reward=np.zeros(count),
            reason=np.zeros(count, np.int64),
            breach=np.zeros(count, np.int64),
            not_a_number=np.zeros(count, np.bool_),
            crash=np.zeros(count, np.bool_),
            contact=np.zeros(vector),
            contact_object=np.full(count, -1, np.int64),
            direction=np.zeros(count, np.int64),
            observations=np.zeros(count, np.int64),
            start_offset=np.zeros((count, 4)),
            offset=np.zeros(count),
            proportion=np.zeros(count),
            view_centre=np.zeros(vector),
            last_target=np.zeros(vector),
            first_position=np.zeros(vector),
            relative_position=np.zeros(vector),
            relative_velocity=np.zeros(vector),
            relative_acceleration=np.zeros(vector),
        )

    @property
    def done(self) -> NDArray[np.bool_]:
        """Whether each episode has ended, shape (N,)."""
        return self.reason > 0
