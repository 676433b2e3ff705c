"""What a recording tells: progress on stderr, a table at the end, the log of every step."""

import logging
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from types import TracebackType

from rich import progress as bar
from rich.console import Console
from rich.table import Table

from eyas.engine.core.files import atomic_path
from eyas.engine.exports.writer import Summary, total
from eyas.engine.settings.video import VideoConfig
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.step_line import EpisodeLines, step_line
from eyas.engine.video.folder import VideoFolder
from eyas.engine.video.reached import ReachedShares, missed
from eyas.engine.video.recorder import Recorder

__all__ = ["RecordingProgress", "print_report", "step_log"]

_LOG = logging.getLogger("eyas")


@contextmanager
def step_log(
    folder: Path, trackers: Sequence[str], *, verbose: bool
) -> Iterator[Callable[[Snapshot], None]]:
    """Yield a function that logs a step of all trackers into `<tracker>.log`, one line each, and
    tells each episode that ends in a line on the console.

    A log is written as a whole: if the recording stops early there is none, and a continued
    recording, which passes through all steps again, makes it.

    Args:
        folder: The folder of the recording.
        trackers: Names of the trackers.
        verbose: Whether anything is logged.

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
    """A progress bar on stderr with frames per second; only on a terminal.

    Args:
        quiet: Whether nothing is shown anywhere.
    """

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

    def show(self, share: float, frames: int) -> None:
        """Show the progress.

        Args:
            share: Share of the simulated time that is done, 0 to 1.
            frames: Number of frames drawn.
        """
        self.frames = frames
        self._bar.update(self._task, completed=share, frames=frames, rate=self.rate)


def print_report(
    folder: VideoFolder,
    recorder: Recorder,
    progress: RecordingProgress,
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
        told = f"{shares} %" if reached.frames else "-"
        table.add_row(tracker, str(len(episodes)), str(whole.frames), *_means(whole), told)
        every = every.plus(reached)
    console = Console()
    console.print(table)
    frames = total(summary for episodes in recorder.episodes for _, summary in episodes).frames
    line = f"{frames} frames in {folder.path} ({recorder.drawn} drawn now, {rate:.0f} a second)"
    for text in (line, *missed(every, video)):
        console.print(text, highlight=False, markup=False, soft_wrap=True)


def _means(whole: Summary) -> tuple[str, str]:
    """Return the mean reward, and the share of frames in which the target is visible."""
    scores = whole.scores
    if scores is None or not scores.rewarded:
        return "-", "-"
    return f"{scores.reward / scores.rewarded:.3f}", f"{scores.sightings / whole.frames:.1%}"
