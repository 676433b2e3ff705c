"""The folder where compiled code is kept, and whose files are run: those that nobody but
their user, or root, can have written.
"""

import errno
import logging
import os
import stat
from contextlib import suppress
from functools import cache
from pathlib import Path

import platformdirs

from eyas.lanes.identity import language_hash

__all__ = [
    "FILE_MODE",
    "FOLDER_VARIABLE",
    "OWNER",
    "cache_folder",
    "kernel_folder",
    "made_folder",
    "not_kept",
    "open_at_once",
    "refusal",
    "secured",
    "touch",
    "unsafe",
]

OWNER = "eyas"
"""The program whose cache this is: the name of its folder, of its log, and in its variable."""

_LOG = logging.getLogger(OWNER)

FOLDER_VARIABLE = f"{OWNER.upper()}_CACHE_DIR"
"""Environment variable: the folder of the cache, instead of the user's default."""

_WARNED: list[object] = []
"""Why something could not be kept: one reason of maybe many."""

_OTHERS = stat.S_IWGRP | stat.S_IWOTH

FOLDER_MODE, FILE_MODE = 0o755, 0o644
"""Of what the cache makes, less the user's mask: others may read it, as in the image of a container
that root has filled, and never write to it, whatever the mask."""


def unsafe(status: os.stat_result) -> str:
    """Return why a file or folder may hold what someone else has written; nothing if it may not."""
    if not hasattr(os, "geteuid"):  # Windows, where folders of users are their own
        return ""
    if status.st_uid not in (0, os.geteuid()):
        return "it belongs to another user, whose machine code is not run"
    if status.st_mode & _OTHERS:
        return "other users may write to it, and their machine code is not run"
    return ""


def secured(folder: Path) -> str:
    """Take the right to write to a folder of one's own from others; return why it is unsafe still.

    Raises:
        OSError: There is no such folder.
    """
    status = folder.stat()
    if hasattr(os, "geteuid") and status.st_uid == os.geteuid() and status.st_mode & _OTHERS:
        with suppress(OSError):
            folder.chmod(stat.S_IMODE(status.st_mode) & ~_OTHERS)
            status = folder.stat()
    return unsafe(status)


def made_folder(folder: Path) -> None:
    """Make a folder of the cache, and those above it that are missing.

    Raises:
        OSError: It cannot be made.
    """
    if folder.is_dir():
        return
    if folder.exists():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))
    made_folder(folder.parent)
    folder.mkdir(FOLDER_MODE, exist_ok=True)


def open_at_once(path: str, flags: int) -> int:
    """Open a file for `open`, without waiting for the writer of a pipe."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def touch(path: Path) -> None:
    """Set the last use of a file or folder to now, if it can be written to."""
    with suppress(OSError):
        os.utime(path)


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    named = os.environ.get(FOLDER_VARIABLE)
    try:
        return Path(named or platformdirs.user_cache_dir(OWNER)).expanduser().absolute()
    except RuntimeError:  # the user has no home
        return Path(os.devnull, OWNER)  # where nothing can be kept


def kernel_folder() -> Path:
    """Return the folder of compiled kernels: numba's, if its variable names one, or that of this
    version of their language in the cache.
    """
    named = os.environ.get("NUMBA_CACHE_DIR")
    return Path(named) if named else cache_folder() / "kernels" / language_hash()


def refusal() -> str:
    """Return why compiled kernels are not kept on disk; nothing if they are."""
    return _refusal(kernel_folder())


@cache
def _refusal(folder: Path) -> str:
    try:
        made_folder(folder)
        touch(folder)
        if why := secured(folder):
            return why
    except OSError as error:
        return error.strerror or str(error)
    return "" if os.access(folder, os.W_OK) else os.strerror(errno.EACCES)


def not_kept(reason: object) -> None:
    """Warn that something made could not be kept; only once in a process."""
    if not _WARNED:
        _WARNED.append(reason)
        _LOG.warning(
            "%s: cannot write: %s; so every start makes and compiles again what is missing there "
            "(%s names another folder)",
            *(cache_folder(), getattr(reason, "strerror", None) or reason, FOLDER_VARIABLE),
        )
