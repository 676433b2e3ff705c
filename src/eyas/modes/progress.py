"""Progress of work that takes a while, on stderr."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress

__all__ = ["sumo_progress"]


@contextmanager
def sumo_progress() -> Iterator[Callable[[float], None]]:
    """Show the progress of SUMO, a share from 0 to 1."""
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("SUMO drives", total=1.0)
        yield lambda share: bar.update(task, completed=share)
