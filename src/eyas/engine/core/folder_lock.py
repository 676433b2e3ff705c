"""The lock by which only one process at a time works in a folder.

Not by the package `filelock`, which would take the place of `_lock` and `_is_at` only: it does not
tell which process holds a lock, which is what the user wants to know.
"""

import errno
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TextIO

from eyas.engine.core.errors import OutputError
from eyas.engine.core.files import refusals

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

LOCK = ".lock"
"""File that exists while a process works in a folder; it holds the id of that process."""

_LOG = logging.getLogger("eyas")


@contextmanager
def folder_lock(
    folder: Path,  # The folder
    doing: str,  # What the process does in it, for messages, such as `recording into it`
) -> Iterator[None]:
    """Lock a folder for this process; the folder is made if it does not exist.

    The system releases the lock when the process ends for any reason, so the file of a killed
    process blocks no other. Without file locks (on Windows and on some network file systems), a
    warning is logged instead.

    Raises:
        OutputError: Another process holds the lock, or writing failed.
    """
    path = folder / LOCK
    with refusals(path):
        folder.mkdir(parents=True, exist_ok=True)
        file = _locked(path, doing)
    with file:
        try:
            yield
        finally:
            # Before unlocking: afterwards another process may have locked the file.
            with suppress(PermissionError):  # Windows cannot delete an open file
                path.unlink(missing_ok=True)


def _locked(path: Path, doing: str) -> TextIO:
    while True:
        file = path.open("a+")
        try:
            _lock(file)
        except BlockingIOError:
            file.seek(0)
            owner = file.read() or "that just began"
            file.close()
            raise OutputError(
                f"{path.parent}: process {owner} is {doing};"
                " wait for it to end, or name another folder"
            ) from None
        except OSError as error:
            _LOG.warning(
                "%s: no file locks here; make sure that no other process is %s: %s",
                path,
                doing,
                error.strerror,
            )
            return file
        if _is_at(file, path):
            file.truncate(0)
            file.write(str(os.getpid()))
            file.flush()
            return file
        file.close()  # its owner has deleted it since it was opened


def _lock(file: TextIO) -> None:
    """Lock a file; `BlockingIOError`: another process has, `OSError`: there are no locks here."""
    if fcntl is None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _is_at(file: TextIO, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except FileNotFoundError:
        return False
