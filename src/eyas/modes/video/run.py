"""Record videos with labels: `channels` trackers follow their targets together in one world."""

import math
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_RATE
from eyas.core.errors import ConfigError, OutputError
from eyas.core.folder_lock import folder_lock
from eyas.exports.registry import chosen_writers
from eyas.modes.video.action import mover_of
from eyas.modes.video.config import VideoConfig
from eyas.modes.video.folder import VideoFolder, check_folder, open_folder
from eyas.modes.video.formats import write_formats, writers_in
from eyas.modes.video.recorder import Recorder
from eyas.modes.video.report import RecordingProgress, print_report, step_log
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.messages import originals_named
from eyas.sim.build import build_simulation
from eyas.sim.simulation import Simulation
from eyas.sim.worlds import together
from eyas.state.snapshot import Snapshot
from eyas.task.config import DoneConfig

__all__ = ["FrameGrid", "run"]

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


_NEVER = 1e6
"""A limit that no tracker reaches."""


def run(
    config: EyasConfig,
    folder: Path,
    *,
    overwrite: bool = False,
    resume: bool = False,
    quiet: bool = False,
) -> None:
    """Record episodes into `folder`, in the formats of `video.writers`.

    The same settings give the same bytes, also when the recording was interrupted and continued.

    Args:
        config: The settings.
        folder: The folder; holds `DRONE<i>/episode<j>/` afterwards.
        overwrite: Whether an existing recording is deleted.
        resume: Whether an existing recording is continued.
        quiet: Whether nothing is printed.

    Raises:
        EyasError: Something cannot be built, read or written, or another process records into
            the folder.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    config = with_lidar(config)
    # Building may take a minute, so writers and folder are checked first. The folder is changed
    # only after building, so that a failed build neither makes nor deletes one.
    with originals_named(config):
        chosen_writers(writers_in(config.video.writers))
        check_folder(folder, config, overwrite=overwrite, resume=resume)
        sim = build_simulation(recording_rules(config), together(config.video.channels))
    with closing(sim):
        with originals_named(config):
            _require_traffic(config, sim.traffic.duration)
            sim.reset()  # raises if there are fewer targets than trackers
        with folder_lock(folder, "recording into it"):
            recording = open_folder(folder, config, overwrite=overwrite, resume=resume)
            _record(sim, config, recording, quiet=quiet)
    write_formats(config.video.writers, folder, quiet=quiet)


def _record(sim: Simulation, config: EyasConfig, folder: VideoFolder, *, quiet: bool) -> None:
    recorder = Recorder(sim, config, folder)
    progress = RecordingProgress(quiet=quiet)
    try:
        with progress, step_log(folder.path, folder.trackers, verbose=config.verbose) as log:
            _run_episodes(sim, config, recorder, progress, log)
        recorder.finish()
    except BaseException as error:
        recorder.stop()
        if isinstance(error, KeyboardInterrupt):
            error.add_note(f"every file in {folder.path} is whole; continue with --resume")
        if isinstance(error, OutputError):
            raise OutputError(f"{error}; continue with --resume") from error
        raise
    print_report(folder, recorder, progress, quiet=quiet)


def with_lidar(config: EyasConfig) -> EyasConfig:
    """Return settings that write the lidar's file, too, if it is on and no writers are chosen."""
    video = config.video
    if not config.lidar.enabled or video.writers != type(video)().writers:
        return config
    writers = (*video.writers, "lidar")
    return config.model_copy(update={"video": video.model_copy(update={"writers": writers})})


def recording_rules(config: EyasConfig) -> EyasConfig:
    """Return the settings with the end conditions of the original's video mode.

    Only a lost target, the step limit and NaN end an episode; the limits of height, distance,
    speed and tilt, and missing reward, do not.
    """
    done = DoneConfig(
        max_height=_NEVER,
        min_height=-_NEVER,
        velocity=_NEVER,
        yaw_rate=_NEVER,
        roll=_NEVER,
        pitch=_NEVER,
        distance_error=_NEVER,
        total_steps=config.done.total_steps,
        grace_steps=config.done.grace_steps,
        no_reward_steps=2**31 - 1,
    )
    return config.model_copy(update={"done": done})


def _require_traffic(config: EyasConfig, known: float) -> None:
    """Refuse a recording that ends after the traffic, at a time [s], or before it begins."""
    end = config.video.start_time + config.video.total_time
    if end > known:
        raise ConfigError(
            f"video.total_time: {config.video.total_time:g} s after {config.video.start_time:g} s"
            f" is longer than the traffic's recording; allowed: up to"
            f" {known - config.video.start_time:g} s, or a longer traffic.recording (eyas traffic"
            " record --duration)"
        )
    begin = (config.start.warm_up_steps + config.video.warm_up_steps) / PHYSICS_RATE
    if end <= begin:
        raise ConfigError(
            f"video.total_time: {config.video.total_time:g} s after {config.video.start_time:g} s "
            f"ends before the trackers start and warm up; allowed: end later than {begin:g} s"
        )


def _run_episodes(
    sim: Simulation,
    config: EyasConfig,
    recorder: Recorder,
    progress: RecordingProgress,
    log: Callable[[Snapshot], None],
) -> None:
    count = config.video.channels
    grid, mover = FrameGrid(config.video, count), mover_of(config, count)
    episodes = sim.snapshot.episodes
    tick = begin = int(episodes.tick[0])
    while tick < grid.last_tick:
        mover.move(sim)
        log(sim.snapshot)
        tick += 1
        due = grid.due(tick, episodes.step_count)
        if due.size:
            recorder.take(due, mover)
            progress.show((tick - begin) / (grid.last_tick - begin), recorder.drawn)
        ended = episodes.done
        if ended.any():
            recorder.end(ended)
            sim.reset(ended)
            grid.restart(ended)
    progress.show(1.0, recorder.drawn)
