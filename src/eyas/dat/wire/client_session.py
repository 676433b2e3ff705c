"""Exchange of files with the client of one tracker."""

import logging
import os
import stat
import time
from collections import deque
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import NamedTuple

from eyas.dat.wire.exchange import HOVER, RARE, Action, Names, parse_action
from eyas.engine.core.errors import ActionError, OutputError
from eyas.engine.core.files import refusals, write_atomic

_LONGEST = 4096  # Largest action file that is read [bytes]

_UNFINISHED = 1.0  # Time after which a line without its end is taken as it is [s]

_AGAIN = 0.5  # Time after which a file that could not be written is tried again [s]

_LOG = logging.getLogger("eyas")

_LINKS = {"follow_symlinks": False} if os.access in os.supports_follow_symlinks else {}


class AnswerFile(NamedTuple):
    """One file of an answer."""

    path: Path
    content: Callable[[], bytes | None]  # Returns the content; None if it is not ready yet


class ClientSession:
    """The client of one tracker: takes its actions, and gives it answers file by file.

    Attributes:
        action: The action that waits to be carried out; None if the client has yet to send one.
        waiting: Time since which the client owes the next thing [s, monotonic].

    Args:
        heard: Called with each line that the client sends.
    """

    def __init__(self, names: Names, heard: Callable[[bytes], None]) -> None:
        self.names = names
        self.action: Action | None = None
        self.waiting = time.monotonic()
        self._heard = heard
        self._answer: deque[AnswerFile] = deque()
        self._shown = False
        self._refused: float | None = None
        self._unfinished: tuple[bytes, float] = (b"", 0.0)

    @property
    def owes(self) -> bool:
        """Whether the client has to do the next thing."""
        return self._shown or (self.action is None and not self._answer)

    def answer(self, parts: list[AnswerFile]) -> None:
        """Begin to give an answer; the action is done.

        Args:
            parts: Its files, in order; each is written when the one before has been deleted.
        """
        self.action = None
        self._answer.extend(parts)

    def withdraw(self) -> None:
        """Drop the rest of an answer, with its file that the client has not taken.

        Raises:
            OutputError: The file cannot be deleted.
        """
        if self._shown:
            part = self._answer[0].path
            _put_away(part)
        self._answer.clear()
        self._shown = False

    def poll(self) -> bool:
        """Go on by one file, if the client has; return whether anything happened.

        Raises:
            OutputError: The client's file cannot be deleted.
        """
        if self.action is not None:
            return False
        happened = self._give() if self._answer else self._take()
        if happened:
            self.waiting = time.monotonic()
        return happened

    def _give(self) -> bool:
        """Write the next file of the answer, after the client has deleted the last."""
        if self._shown:
            if _exists(self._answer[0].path):
                return time.monotonic() - self.waiting > RARE and self._drop_if_late()
            self._answer.popleft()
            self._shown = False
            if not self._answer:
                return True
        return self._show()

    def _show(self) -> bool:
        """Write a file if it is ready; a full disk is reported once, and waited for."""
        part, now = self._answer[0], time.monotonic()
        content = part.content()
        if content is None or (self._refused is not None and now - self._refused < _AGAIN):
            return False
        try:
            write_atomic(part.path, content)
        except OutputError as error:
            if self._refused is None:
                _LOG.warning("%s; trying again until it works", error)
            self._refused = now
            return False
        if self._refused is not None:
            _LOG.info("%s: written again", part.path)
        self._refused, self._shown = None, True
        return True

    def _drop_if_late(self) -> bool:
        """Drop the rest of an answer if an action comes before the client has taken it all.

        That is a new client in the place of one that has died, or one out of order.
        """
        part = self._answer[0].path
        if not _exists(self.names.action) or not _exists(part):
            return False
        _LOG.warning(
            "%s: a new action while %s was not taken: a new client, or one out of order; "
            "the rest of that answer is dropped",
            self.names.tracker,
            part.name,
        )
        self.withdraw()
        return True

    def _take(self) -> bool:
        """Read the client's action, and delete its file, which tells it to go on."""
        if not _exists(self.names.action):
            return False
        try:
            line = self._line()
            if line is None:
                return False
            self._heard(line)
            action = parse_action(line)
        except ActionError as error:
            _LOG.error("%s: %s; it hovers", self.names.tracker, error)
            action = HOVER
        _put_away(self.names.action)
        self._unfinished = (b"", 0.0)
        self.action = action
        return True

    def _line(self) -> bytes | None:
        """Return the first line of the action file; None while there is none."""
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        try:
            file = os.open(self.names.action, flags)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise ActionError(f"{self.names.action.name}: {error.strerror}") from None
        try:
            if not stat.S_ISREG(os.fstat(file).st_mode):
                raise ActionError(f"{self.names.action.name}: not an ordinary file")
            content = os.read(file, _LONGEST)
        finally:
            os.close(file)
        line, end, _ = content.partition(b"\n")
        if end or len(content) == _LONGEST or self._is_left(content):
            return line.rstrip(b"\r")
        return None

    def _is_left(self, content: bytes) -> bool:
        """Return whether a line without its end has not grown for a time."""
        now = time.monotonic()
        if content != self._unfinished[0]:
            self._unfinished = (content, now)
        return bool(content) and now - self._unfinished[1] > _UNFINISHED


def _put_away(path: Path) -> None:
    """Delete a file; a folder in its place is renamed, as nobody knows what is in it."""
    with refusals(path):
        if path.is_dir() and not path.is_symlink():
            names = (path.with_name(f"{path.name}.folder-{number}") for number in count(1))
            path.rename(next(name for name in names if not os.path.lexists(name)))
        else:
            path.unlink(missing_ok=True)


def _exists(path: Path) -> bool:
    """Return whether there is a file or a link; in a third of the time of `os.path.lexists` or of
    opening what is not there, which raise exceptions. A server mostly looks for nothing.
    """
    return os.access(path, os.F_OK, **_LINKS)
