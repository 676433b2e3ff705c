"""Record videos with labels: `channels` trackers follow their targets together in one world."""

import logging
import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from types import TracebackType

import numpy as np
from rich import progress as bar
from rich.console import Console
from rich.table import Table

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.core.files import atomic_path
from eyas.engine.core.folder_lock import folder_lock
from eyas.engine.exports.registry import chosen_writers
from eyas.engine.exports.writer import Summary, total
from eyas.engine.recordings.rerun import LiveView
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import originals_named, spoken
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import together
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.config import DoneConfig
from eyas.engine.task.step_line import EpisodeLines, step_line
from eyas.engine.terminal.ending import print_ending
from eyas.engine.terminal.helpers import Helpers
from eyas.engine.video.action import Mover, check_flight, mover_of
from eyas.engine.video.folder import VideoFolder, check_folder, open_folder
from eyas.engine.video.formats import with_writers, write_formats, writers_in
from eyas.engine.video.frame_grid import FrameGrid, RecordingEnd
from eyas.engine.video.recorder import ReachedShares, RecordedShare, Recorder, Share, missed
from eyas.lanes import thread_count

_LOG = logging.getLogger("eyas")
_NEVER = 1e6  # A limit that no tracker reaches


def run(
    config: EyasConfig,
    folder: Path,
    *,
    overwrite: bool = False,
    resume: bool = False,
    quiet: bool = False,
    workers: int = 1,
    live: LiveView | None = None,
) -> None:
    """Record episodes into `folder`, in the formats of `video.writers`.

    The same settings give the same bytes, also when the recording was interrupted and continued,
    and whatever the number of processes: each passes through all steps, but draws and writes some
    of the episodes only.

    Args:
        config: The settings.
        folder: The folder; holds `DRONE<i>/episode<j>/` afterwards.
        overwrite: Whether an existing recording is deleted.
        resume: Whether an existing recording is continued.
        quiet: Whether nothing is printed.
        workers: Number of processes.
        live: Shows the frames that this process draws.

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
        flown = _flown(config)
        sim = _built(flown)
    with closing(sim):
        with originals_named(config):
            _require_traffic(flown, sim.traffic.duration)
            sim.reset()  # raises if there are fewer targets than trackers
            mover = mover_of(flown, sim)
        with folder_lock(folder, "recording into it"):
            recording = open_folder(folder, config, overwrite=overwrite, resume=resume)
            shares = [Share(number, workers) for number in range(1, workers)]
            calls = [(_record_share, (config, folder, share)) for share in shares]
            helpers = Helpers(calls, max(1, thread_count() // workers))
            _record(sim, flown, mover, recording, helpers, quiet=quiet, live=live)
    write_formats(config.video.writers, folder, quiet=quiet)


_WORTH = 300  # Frames for which another process is worth its start, 1.7 s of CPU


def default_workers(config: EyasConfig) -> int:
    """Return the number of processes that record, unless the user chooses one: half the cores from
    four on, if there is so much to record; one with a policy, which would fly in each.
    """
    video, cores = config.video, thread_count()
    if cores < 4 or video.policy is not None:
        return 1
    episodes, frames = video.episodes, video.episodes * (video.episode_frames or 0)
    if video.episode_frames is None:
        episodes = math.ceil(video.total_time * PHYSICS_RATE / config.done.total_steps)
        frames = math.ceil(video.total_time * video.fps)
    most = min(episodes * video.channels, frames * video.channels // _WORTH)
    return max(1, min(cores // 2, most))


def _flown(config: EyasConfig) -> EyasConfig:
    """Return the settings by which trackers fly."""
    if config.original is None:
        return config
    return spoken("original").started(config, config.video.channels)


def _record_share(config: EyasConfig, folder: Path, share: Share) -> RecordedShare:
    """Record some episodes of a recording that another process has begun."""
    with originals_named(config):
        flown = _flown(config)
        sim = _built(flown)
        sim.reset()
        mover = mover_of(flown, sim)
    with closing(sim):
        recorder = Recorder(sim, flown, VideoFolder(folder, config), share)
        try:
            _run_episodes(sim, flown, (mover, recorder), lambda share, drawn: None, lambda _: None)
            recorder.end_all()
        except BaseException:
            recorder.stop()
            raise
        return recorder.recorded()


def _built(config: EyasConfig) -> Simulation:
    try:
        sim = build_simulation(recording_rules(config), together(config.video.channels))
    except ConfigError as error:
        frames = config.video.episode_frames
        if frames is None or not str(error).startswith("done.total_steps"):
            raise
        raise ConfigError(f"video.episode_frames: {frames} are too many: {error}") from None
    sim.view.pictures.prepare()  # so that further processes find in the cache what is drawn
    return sim


def _record(
    sim: Simulation,
    config: EyasConfig,
    mover: Mover,
    folder: VideoFolder,
    helpers: Helpers[RecordedShare],
    *,
    quiet: bool,
    live: LiveView | None,
) -> None:
    recorder = Recorder(sim, config, folder, Share(0, 1 + helpers.count), live)
    progress = RecordingProgress(quiet=quiet)

    def show(share: float, frames: int) -> None:
        helpers.check()
        progress.show(share, frames)

    try:
        with helpers:
            with progress, step_log(folder.path, folder.trackers, verbose=config.verbose) as log:
                _run_episodes(sim, config, (mover, recorder), show, log)
            recorder.end_all()
            for other in helpers.results():
                recorder.join(other)
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
    show: Callable[[float, int], None],  # Gets the share that is done, and the frames drawn
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
            show(end.share(tick), recorder.drawn)
        ended = end.of_episodes(episodes.done)
        if ended.any():
            recorder.end(ended)
            if end.reached(tick):
                break
            sim.reset(ended)
            grid.restart(ended)
            mover.begin(np.flatnonzero(ended), end.longest(tick))
    show(1.0, recorder.drawn)


@contextmanager
def step_log(
    folder: Path, trackers: Sequence[str], *, verbose: bool
) -> Iterator[Callable[[Snapshot], None]]:
    """Yield a function that logs a step of all trackers into `<tracker>.log`, one line each, and
    tells each episode that ends in a line on the console.

    A log is written as a whole: if the recording stops early there is none, and a continued
    recording, which passes through all steps again, makes it.

    Raises:
        OutputError: A log cannot be written.
    """
    with ExitStack() as stack:
        files = []
        for name in trackers if verbose else ():
            part = stack.enter_context(atomic_path(folder / f"{name}.log"))
            files.append(stack.enter_context(part.open("w")))

        episodes = EpisodeLines(trackers)

        def log(snapshot: Snapshot) -> None:
            for line in episodes.after(snapshot) if verbose else ():
                _LOG.info("%s", line)
            for tracker, file in enumerate(files):
                file.write(step_line(snapshot, tracker, trackers[tracker]) + "\n")

        yield log


class RecordingProgress:
    """A progress bar on stderr with frames per second; only on a terminal."""

    def __init__(self, *, quiet: bool) -> None:
        console = Console(stderr=True)
        self._bar = bar.Progress(
            bar.TextColumn("recording"),
            bar.BarColumn(),
            bar.TaskProgressColumn(),
            bar.TextColumn("{task.fields[frames]} frames, {task.fields[rate]:.0f}/s"),
            bar.TimeRemainingColumn(),
            console=console,
            disable=quiet or not console.is_terminal,
        )
        self._task = self._bar.add_task("", total=1.0, frames=0, rate=0.0)
        self._start = time.perf_counter()
        self.frames = 0

    def __enter__(self) -> "RecordingProgress":
        self._start = time.perf_counter()
        self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.stop()

    @property
    def rate(self) -> float:
        """Frames drawn per second of wall time [Hz]."""
        return self.frames / max(time.perf_counter() - self._start, 1e-9)

    def show(
        self,
        share: float,  # Share of the simulated time that is done, 0 to 1
        frames: int,  # Number of frames drawn
    ) -> None:
        """Show the progress."""
        self.frames = frames
        self._bar.update(self._task, completed=share, frames=frames, rate=self.rate)


def print_report(
    folder: VideoFolder,
    recorder: Recorder,
    progress: "RecordingProgress",
    video: VideoConfig,
    *,
    quiet: bool,
) -> None:
    """Print a row for each tracker, the folder of the recording, and asked shares that are missed.

    How targets are shown is told of the frames that were drawn now.
    """
    if quiet:
        return
    rate = progress.rate
    table = Table()
    table.add_column("tracker")
    titles = ("episodes", "frames", "mean reward", "in sight", "view/hidden/cut/small")
    for title in titles:
        table.add_column(title, justify="right")
    every = ReachedShares()
    for tracker, episodes, reached in zip(
        folder.trackers, recorder.episodes, recorder.reached, strict=True
    ):
        whole = total(summary for _, summary in episodes)
        shares = "/".join(f"{100.0 * share:.0f}" for share in reached.shares().values())
        reached_shares = f"{shares} %" if reached.frames else "-"
        table.add_row(
            tracker, str(len(episodes)), str(whole.frames), *_means(whole), reached_shares
        )
        every = every.plus(reached)
    console = Console()
    console.print(table)
    frames = total(summary for episodes in recorder.episodes for _, summary in episodes).frames
    for note in missed(every, video):
        console.print(note, highlight=False, markup=False, soft_wrap=True)
    line = f"{frames} frames in {folder.path} ({recorder.drawn} drawn now, {rate:.0f} a second)"
    print_ending(line, *_next(folder.path))


def _next(folder: Path) -> Iterator[tuple[str, tuple[str | Path, ...]]]:
    """Yield what a user may do next, if there is a film or a picture."""
    if any(any(folder.glob(f"*/*/*.{kind}")) for kind in ("webp", "mp4", "jpeg", "png")):
        yield "see it", ("eyas", "open", folder)


def _means(whole: Summary) -> tuple[str, str]:
    """Return the mean reward, and the share of frames in which the target is visible."""
    scores = whole.scores
    if scores is None or not scores.rewarded:
        return "-", "-"
    return f"{scores.reward / scores.rewarded:.3f}", f"{scores.sightings / whole.frames:.1%}"
