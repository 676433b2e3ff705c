"""Messages of a recording: progress on stderr, a table at the end."""

import time
from types import TracebackType

from rich import progress as bar
from rich.console import Console
from rich.table import Table

from eyas.exports.summary import Summary, total
from eyas.modes.video.folder import VideoFolder
from eyas.modes.video.recorder import Recorder

__all__ = ["Progress", "print_report"]


class Progress:
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

    def __enter__(self) -> "Progress":
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
    folder: VideoFolder, recorder: Recorder, progress: Progress, *, quiet: bool
) -> None:
    """Print a row for each tracker, and the folder of the recording."""
    if quiet:
        return
    rate = progress.rate
    table = Table()
    table.add_column("tracker")
    for title in ("episodes", "frames", "mean reward", "in sight"):
        table.add_column(title, justify="right")
    for tracker, episodes in zip(folder.trackers, recorder.episodes, strict=True):
        whole = total(summary for _, summary in episodes)
        table.add_row(tracker, str(len(episodes)), str(whole.frames), *_means(whole))
    console = Console()
    console.print(table)
    frames = total(summary for episodes in recorder.episodes for _, summary in episodes).frames
    line = f"{frames} frames in {folder.path} ({recorder.drawn} drawn now, {rate:.0f} a second)"
    console.print(line, highlight=False, markup=False, soft_wrap=True)


def _means(whole: Summary) -> tuple[str, str]:
    """Return the mean reward, and the share of frames in which the target is visible."""
    scores = whole.scores
    if scores is None or not scores.rewarded:
        return "-", "-"
    return f"{scores.reward / scores.rewarded:.3f}", f"{scores.sightings / whole.frames:.1%}"
