"""Commands that turn the camera, for trackers of any kind that carry it on a gimbal."""

from collections.abc import Callable
from dataclasses import fields
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.snapshot import TrackerState
from eyas.engine.trackers.drone import advance
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import kernel, specialised

WIDTH = 4  # Numbers of a command that only flies, see `Tracker.advance`.
WITH_GIMBAL = 8
"""Numbers of one that also turns the camera: behind the four come the pitch and the yaw to turn to
[rad], and the largest rates of pitch and yaw [rad/s], which are not negative."""


@kernel(inline=True)
def turn_gimbal(
    trackers: TrackerState,  # Its commanded angles are updated
    n: int,  # Index of the tracker
    command: NDArray[np.float64],  # Shape (8,), see `WITH_GIMBAL`
) -> None:
    """Move the commanded angles of gimbal `n` by one physics step of 2 ms."""
    commanded = trackers.commanded_gimbal[n]
    for axis in range(2):
        most = command[6 + axis] * PHYSICS_STEP
        commanded[axis] += min(max(command[4 + axis] - commanded[axis], -most), most)


@kernel(inline=True)
def advance_and_turn(
    trackers: TrackerState,
    memory: Any,  # noqa: ANN401  # of any kind of tracker
    n: int,
    command: NDArray[np.float64],
) -> None:
    """Turn the camera, and move the tracker: a `Tracker.advance`."""
    turn_gimbal(trackers, n, command)
    advance(trackers, memory, n, command)


def with_gimbal(tracker: Tracker) -> Tracker:
    """Return a tracker whose commands have eight numbers, see `WITH_GIMBAL`."""
    # Not by `dataclasses.replace`: a class of a user's own may be made of other arguments.
    own = {field.name: getattr(tracker, field.name) for field in fields(Tracker)}
    return Tracker(**own | {"advance": _turning(tracker.advance)})


@lru_cache(maxsize=16)
def _turning(own: Callable[..., Any]) -> Callable[..., Any]:
    turning: Callable[..., Any] = kernel(inline=True)(specialised(advance_and_turn, advance=own))
    return turning
