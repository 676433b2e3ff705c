"""Keeps servers going: a message that cannot be handled is a line in the log."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager

from eyas.engine.core.errors import one_line

_LOG = logging.getLogger("eyas")
_BETWEEN = 1.0  # Shortest time between two lines, so that a sender cannot fill the log [s]


class FaultLog:
    """Reports messages that cannot be handled, at most one a second."""

    def __init__(self) -> None:
        self._reported, self._silent = -_BETWEEN, 0

    @contextmanager
    def guard(
        self,
        what: str,  # The message that it handles, such as `COMMAND_LONG of 255/190`
    ) -> Iterator[None]:
        """Run a block; whatever error it raises becomes a line."""
        try:
            yield
        except Exception as error:  # what is wrong with a message is not known before
            now = time.monotonic()
            if now - self._reported < _BETWEEN:
                self._silent += 1
                return
            others = f" (and {self._silent} others)" if self._silent else ""
            self._reported, self._silent = now, 0
            line = one_line(f"{what} ignored{others}: {type(error).__name__}: {error}")
            _LOG.warning("%s", line)
