"""Record videos with labels: `channels` trackers follow their targets together in one world."""

import math
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import numpy as np

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.core.folder_lock import folder_lock
from eyas.engine.exports.registry import chosen_writers
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named, spoken
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import together
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import DoneConfig
from eyas.engine.video.action import Mover, check_flight, mover_of
from eyas.engine.video.default_writers import with_writers
from eyas.engine.video.folder import VideoFolder, check_folder, open_folder
from eyas.engine.video.formats import write_formats, writers_in
from eyas.engine.video.frame_grid import FrameGrid, RecordingEnd
from eyas.engine.video.recorder import Recorder
from eyas.engine.video.report import RecordingProgress, print_report, step_log

__all__ = ["run"]

_NEVER = 1e6  # A limit that no tracker reaches


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
    config = with_writers(config, quiet=quiet)
    # Building may take a minute, so writers and folder are checked first. The folder is changed
    # only after building, so that a failed build neither makes nor deletes one.
    with originals_named(config):
        chosen_writers(writers_in(config.video.writers))
        check_flight(config)
        check_folder(folder, config, overwrite=overwrite, resume=resume)
        flown = config
        if config.original is not None:
            flown = spoken("original").started(config, config.video.channels)
        sim = _built(flown)
    with closing(sim):
        with originals_named(config):
            _require_traffic(flown, sim.traffic.duration)
            sim.reset()  # raises if there are fewer targets than trackers
            mover = mover_of(flown, sim)
        with folder_lock(folder, "recording into it"):
            recording = open_folder(folder, config, overwrite=overwrite, resume=resume)
            _record(sim, flown, mover, recording, quiet=quiet)
    write_formats(config.video.writers, folder, quiet=quiet)


def _built(config: EyasConfig) -> Simulation:
    try:
        return build_simulation(recording_rules(config), together(config.video.channels))
    except ConfigError as error:
        frames = config.video.episode_frames
        if frames is None or not str(error).startswith("done.total_steps"):
            raise
        raise ConfigError(f"video.episode_frames: {frames} are too many: {error}") from None


def _record(
    sim: Simulation, config: EyasConfig, mover: Mover, folder: VideoFolder, *, quiet: bool
) -> None:
    recorder = Recorder(sim, config, folder)
    progress = RecordingProgress(quiet=quiet)
    try:
        with progress, step_log(folder.path, folder.trackers, verbose=config.verbose) as log:
            _run_episodes(sim, config, (mover, recorder), progress, log)
        recorder.finish()
    except BaseException as error:
        recorder.stop()
        if isinstance(error, KeyboardInterrupt):
            error.add_note(f"every file in {folder.path} is whole; continue with --resume")
        if isinstance(error, OutputError):
            raise OutputError(f"{error}; continue with --resume") from error
        raise
    print_report(folder, recorder, progress, config.video, quiet=quiet)


def recording_rules(config: EyasConfig) -> EyasConfig:
    """Return the settings with the end conditions of the original's video mode.

    Only a target that leaves the world, the step limit and NaN end an episode; the limits of
    height, distance, speed and tilt, and missing reward, do not: a target that is lost from the
    picture may be found again. Of episodes with a number of frames, the step limit is where the
    last one is for sure.
    """
    done = DoneConfig(
        max_height=_NEVER,
        min_height=-_NEVER,
        velocity=_NEVER,
        yaw_rate=_NEVER,
        roll=_NEVER,
        pitch=_NEVER,
        distance_error=_NEVER,
        total_steps=_episode_steps(config) or config.done.total_steps,
        grace_steps=config.done.grace_steps,
        no_reward_steps=2**31 - 1,
    )
    return config.model_copy(update={"done": done})


def _episode_steps(config: EyasConfig) -> int | None:
    """Return the 2 ms steps that suffice for the frames of each episode; None: no such number.

    The first episodes begin before `video.start_time`.
    """
    video = config.video
    if video.episode_frames is None:
        return None
    before = math.ceil(video.start_time * PHYSICS_RATE) - config.start.warm_up_steps
    frames = math.ceil(video.episode_frames * PHYSICS_RATE / video.fps)
    return max(before, video.warm_up_steps) + frames + 2


def _require_traffic(config: EyasConfig, known: float) -> None:
    """Refuse a recording that ends after the traffic, at a time [s], or before it begins."""
    video = config.video
    steps = _episode_steps(config)
    if steps is not None:
        longest = config.start.warm_up_steps / PHYSICS_RATE + video.episodes * steps / PHYSICS_RATE
        if longest > known:
            raise ConfigError(
                f"video.episode_frames: {video.episode_frames} in each of {video.episodes} episodes"
                f" (video.episodes) take {longest:g} s, longer than the traffic's recording; "
                f"allowed: up to {known:g} s, or a longer traffic.recording (eyas traffic record "
                "--duration)"
            )
        return
    end = video.start_time + video.total_time
    if end > known:
        raise ConfigError(
            f"video.total_time: {video.total_time:g} s after {video.start_time:g} s"
            f" is longer than the traffic's recording; allowed: up to"
            f" {known - video.start_time:g} s, or a longer traffic.recording (eyas traffic"
            " record --duration)"
        )
    begin = (config.start.warm_up_steps + video.warm_up_steps) / PHYSICS_RATE
    if end <= begin:
        raise ConfigError(
            f"video.total_time: {video.total_time:g} s after {video.start_time:g} s "
            f"ends before the trackers start and warm up; allowed: end later than {begin:g} s"
        )


def _run_episodes(
    sim: Simulation,
    config: EyasConfig,
    recording: tuple[Mover, Recorder],
    progress: RecordingProgress,
    log: Callable[[Snapshot], None],
) -> None:
    count = config.video.channels
    mover, recorder = recording
    grid = FrameGrid(config.video, count)
    episodes = sim.snapshot.episodes
    tick = int(episodes.tick[0])
    end = RecordingEnd(config.video, grid, recording_rules(config).done.total_steps, tick)
    mover.begin(np.arange(count), end.longest(tick))
    while not end.reached(tick):
        mover.move()
        log(sim.snapshot)
        tick += 1
        due = end.wanted(grid.due(tick, episodes.step_count))
        if due.size:
            recorder.take(due, mover.action)
            progress.show(end.share(tick), recorder.drawn)
        ended = end.of_episodes(episodes.done)
        if ended.any():
            recorder.end(ended)
            if end.reached(tick):
                break
            sim.reset(ended)
            grid.restart(ended)
            mover.begin(np.flatnonzero(ended), end.longest(tick))
    progress.show(1.0, recorder.drawn)
