"""Times of the frames of a recording, of the ends of its episodes, and of its own end."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.settings.video import VideoConfig

_SLACK = 1e-6  # Largest rounding error of a time in seconds, in ticks
_NO_END = 2**62  # A tick that no recording reaches


class FrameGrid:
    """Frame k of an episode is at the tick nearest to the time of its first frame + k / fps.

    The original compares with the time of the last frame, which it does not set at the start of
    later episodes, so that their second frame follows 2 ms after the first. Here each episode has
    its own grid.
    """

    first_tick: int
    """First tick that may have a frame."""
    last_tick: int
    """Last tick that may have a frame."""

    def __init__(self, video: VideoConfig, count: int) -> None:
        self.first_tick = math.ceil(video.start_time * PHYSICS_RATE - _SLACK)
        end = video.start_time + video.total_time
        self.last_tick = math.floor(end * PHYSICS_RATE + _SLACK)
        if video.episode_frames is not None:
            self.last_tick = _NO_END
        self._warm_up_steps = video.warm_up_steps
        self._spacing = PHYSICS_RATE / video.fps
        self._origin = np.full(count, -1, np.int64)
        self._frames = np.zeros(count, np.int64)
        self._soonest = self.first_tick

    def restart(self, trackers: NDArray[np.bool_]) -> None:
        """Begin a new episode for the trackers of a mask, shape (N,)."""
        self._origin[trackers] = -1
        self._frames[trackers] = 0
        self._soonest = self.first_tick

    @property
    def frames(self) -> NDArray[np.int64]:
        """Frames of each tracker's episode up to now, shape (N,)."""
        return self._frames

    def due(
        self,
        tick: int,  # 2 ms steps since the start of the run
        step_count: NDArray[np.integer],  # 2 ms steps since each tracker's reset, shape (N,)
    ) -> NDArray[np.int32]:
        """Return the trackers that have a frame at this tick, and count these frames."""
        if not self._soonest <= tick <= self.last_tick:
            return np.zeros(0, np.int32)
        ready = step_count > self._warm_up_steps
        self._origin[ready & (self._origin < 0)] = tick
        due = ready & (tick == self._ticks())
        self._frames[due] += 1
        if (self._origin >= 0).all():  # else a tracker may become ready at any tick
            self._soonest = int(self._ticks().min())
        return np.flatnonzero(due).astype(np.int32)

    def _ticks(self) -> NDArray[np.int64]:
        """Return the tick of the next frame of each tracker, shape (N,)."""
        since = np.floor(self._frames * self._spacing + 0.5).astype(np.int64)
        ticks: NDArray[np.int64] = self._origin + since
        return ticks


class RecordingEnd:
    """Tells when episodes and the recording end, and how much of it is done."""

    def __init__(
        self,
        video: VideoConfig,  # The settings
        grid: FrameGrid,  # The frames
        steps: int,  # 2 ms steps after which an episode ends at the latest
        begin: int,  # Tick at which the recording begins
    ) -> None:
        self._grid, self._steps, self._begin = grid, steps, begin
        self._frames, self._episodes = video.episode_frames, video.episodes
        self._ended = np.zeros(video.channels, np.int64)

    def longest(self, tick: int) -> int:
        """Return the most steps of an episode that begins at a tick."""
        return max(min(self._steps, self._grid.last_tick - tick), 1)

    def of_episodes(self, done: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return whose episodes end now, shape (N,); `done`: whose end by themselves."""
        ended = done
        if self._frames is not None:
            ended = done | (self._grid.frames >= self._frames)
        self._ended += ended
        return ended

    def wanted(self, due: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return those trackers with a frame now that have not recorded all their episodes."""
        if self._frames is None:
            return due
        return due[self._ended[due] < self._episodes]

    def reached(self, tick: int) -> bool:
        """Return whether everything is recorded at a tick."""
        if self._frames is None:
            return tick >= self._grid.last_tick
        return bool((self._ended >= self._episodes).all())

    def share(self, tick: int) -> float:
        """Return how much is done at a tick, 0 to 1."""
        if self._frames is None:
            return (tick - self._begin) / (self._grid.last_tick - self._begin)
        done = np.minimum(self._ended + self._grid.frames / self._frames, self._episodes)
        return float(done.mean() / self._episodes)
