"""Progress of work that takes a while, on stderr."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich import progress as bar
from rich.console import Console
from rich.progress import Progress


@contextmanager
def sumo_progress() -> Iterator[Callable[[float], None]]:
    """Show the progress of SUMO, a share from 0 to 1."""
    with Progress(console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task("SUMO drives", total=1.0)
        yield lambda share: shown.update(task, completed=share)


@contextmanager
def frames_bar(doing: str, total: int, *, quiet: bool) -> Iterator[Callable[[int], None]]:
    """Show how many frames, or other things, are done, and the time left; only on a terminal."""
    console = Console(stderr=True)
    columns = (
        bar.TextColumn(doing),
        bar.BarColumn(),
        bar.MofNCompleteColumn(),
        bar.TimeRemainingColumn(),
    )
    hidden = quiet or not console.is_terminal
    with Progress(*columns, console=console, disable=hidden) as shown:
        task = shown.add_task("", total=total)
        yield lambda frames: shown.update(task, completed=frames)
