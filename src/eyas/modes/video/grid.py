"""The 2 ms ticks of a recording that have a frame."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_RATE
from eyas.modes.video.config import VideoConfig

__all__ = ["FrameGrid"]

_SLACK = 1e-6
"""Largest rounding error of a time in seconds, in ticks."""


class FrameGrid:
    """Frame k of an episode is at the tick nearest to the time of its first frame + k / fps.

    The original compares with the time of the last frame, which it does not set at the start of
    later episodes, so that their second frame follows 2 ms after the first. Here each episode has
    its own grid.

    Args:
        video: When to record.
        count: Number of trackers.
    """

    first_tick: int
    """First tick that may have a frame."""
    last_tick: int
    """Last tick that may have a frame."""

    def __init__(self, video: VideoConfig, count: int) -> None:
        self.first_tick = math.ceil(video.start_time * PHYSICS_RATE - _SLACK)
        end = video.start_time + video.total_time
        self.last_tick = math.floor(end * PHYSICS_RATE + _SLACK)
        self._warm_up_steps = video.warm_up_steps
        self._spacing = PHYSICS_RATE / video.fps
        self._origin = np.full(count, -1, np.int64)
        self._frames = np.zeros(count, np.int64)

    def restart(self, trackers: NDArray[np.bool_]) -> None:
        """Begin a new episode for the trackers of a mask, shape (N,)."""
        self._origin[trackers] = -1
        self._frames[trackers] = 0

    def due(self, tick: int, step_count: NDArray[np.integer]) -> NDArray[np.int32]:
        """Return the trackers that have a frame at this tick, and count these frames.

        Args:
            tick: 2 ms steps since the start of the run.
            step_count: 2 ms steps since each tracker's reset, shape (N,).
        """
        if not self.first_tick <= tick <= self.last_tick:
            return np.zeros(0, np.int32)
        ready = step_count > self._warm_up_steps
        self._origin[ready & (self._origin < 0)] = tick
        nearest = np.floor(self._frames * self._spacing + 0.5).astype(np.int64)
        due = ready & (tick == self._origin + nearest)
        self._frames[due] += 1
        return np.flatnonzero(due).astype(np.int32)
