"""The log of every step, for debugging; the original's `Verbose`."""

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from eyas.core.files import atomic_path
from eyas.state.snapshot import Snapshot
from eyas.task.step_line import EpisodeLines, step_line

_LOG = logging.getLogger("eyas")

__all__ = ["STEP_LOGS", "step_log"]

STEP_LOGS = ("DRONE{:d}.log", "CAR{:d}.log")
"""Names of the logs in the folder of a recording, outside of the trackers' folders."""


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
