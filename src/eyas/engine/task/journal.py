"""The original's logs of what each client says and of each step (`Verbose`)."""

import logging
import math
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TextIO

from eyas.engine.core.files import refusals
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.task.step_line import EpisodeLines, step_line

_LOG = logging.getLogger("eyas")


class Journal:
    """`Agent<i>.log` of each tracker, begun anew, in which a line is there at once; and a line on
    the console for each episode.

    Args:
        folder: The folder of the logs, made if needed; None: only the console gets lines.
        trackers: Names of the trackers.
        numbers: Number of each, for its file; None: 0, 1, ...
        verbose: Whether anything is logged.

    Raises:
        OutputError: A log cannot be written.
    """

    def __init__(
        self,
        folder: Path | None,
        trackers: Sequence[str],
        numbers: Sequence[int] | None = None,
        *,
        verbose: bool,
    ) -> None:
        self._trackers = trackers
        self._folder = folder
        self._episodes = EpisodeLines(trackers) if verbose else None
        self._files: list[TextIO] = []
        self._stack = ExitStack()
        if verbose and folder is not None:
            with refusals(folder):
                folder.mkdir(parents=True, exist_ok=True)
                for number in numbers or range(len(trackers)):
                    file = (folder / f"Agent{number}.log").open("w", buffering=1)
                    self._files.append(self._stack.enter_context(file))

    def __enter__(self) -> "Journal":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def writes(self) -> bool:
        """Whether it has files."""
        return bool(self._files)

    def close(self) -> None:
        """Close the files; may be called again."""
        self._files.clear()
        self._stack.close()

    def hearer(self, number: int) -> Callable[[bytes], None]:
        """Return a function that logs a line of a client."""
        return lambda line: self._write(number, f"received {line!r}")

    def actions(self, commands: Sequence[Sequence[float]]) -> None:
        """Log what each tracker is told, in the original's words: forward, left, up, turn rate."""
        for number in range(len(self._files)):
            ahead, left, _, turn = commands[number]
            self._write(
                number,
                f"id: {self._trackers[number]} ACTIONS forward:{ahead:g} leftRight:{left:g} "
                f"turn:{math.degrees(turn):g}(deg/s)",
            )

    def step(self, snapshot: Snapshot) -> None:
        """Log a step of all trackers."""
        if self._episodes is not None:
            for line in self._episodes.after(snapshot):
                _LOG.info("%s", line)
        for number in range(len(self._files)):
            self._write(number, step_line(snapshot, number, self._trackers[number]))

    def _write(self, number: int, text: str) -> None:
        if not self._files:
            return
        try:
            self._files[number].write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} : {text}\n")
        except OSError as error:
            # A full disk must not end the training of all clients.
            _LOG.warning("%s: no longer logged: %s", self._folder, error.strerror)
            self._files.clear()
