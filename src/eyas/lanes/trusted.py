"""The folder of the cache, and files in it that are used as they are: those that nobody but their
user, or root, can have written.
"""

import errno
import logging
import os
import secrets
import stat
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

import platformdirs

from eyas.lanes.container import Contents, packed, unpacked

OWNER = "eyas"
"""The program whose cache this is: the name of its folder, of its log, and in its variable."""

_LOG = logging.getLogger(OWNER)

FOLDER_VARIABLE = f"{OWNER.upper()}_CACHE_DIR"
"""Environment variable: the folder of the cache, instead of the user's default."""

_TOLD: set[Path] = set()  # Folders of which it is told that someone else may have written into them

_WARNED: list[object] = []  # Why something could not be kept: one reason of maybe many

_OTHERS = stat.S_IWGRP | stat.S_IWOTH

FOLDER_MODE, FILE_MODE = 0o755, 0o644
"""Of what the cache makes, less the user's mask: others may read it, as in the image of a container
that root has filled, and never write to it, whatever the mask."""


def unsafe(status: os.stat_result) -> str:
    """Return why a file or folder may hold what someone else has written; nothing if it may not."""
    if not hasattr(os, "geteuid"):  # Windows, where folders of users are their own
        return ""
    if status.st_uid not in (0, os.geteuid()):
        return "it belongs to another user, whose files are not used"
    if status.st_mode & _OTHERS:
        return "other users may write to it, and their files are not used"
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


class _UnsafeError(Exception):
    """Someone else may have written a file."""


def read_trusted(path: Path) -> Contents | None:
    """Return the content of a file that `write_trusted` has written.

    None if there is none, or it is damaged, or someone else than this user, or root, may have
    written it; but for the first, a warning is logged.
    """
    try:
        with open(path, "rb", opener=open_at_once) as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise ValueError("no ordinary file")
            if why := unsafe(status) or unsafe(path.parent.stat()):
                raise _UnsafeError(why)
            name, header = (found := unpacked(file.read())).header
        if name != path.name:
            raise ValueError("in the place of another file")
        return Contents(header, found.pieces)
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return None  # if it cannot be replaced either, that is told
    except _UnsafeError as error:
        if path.parent not in _TOLD:
            _TOLD.add(path.parent)
            _LOG.warning("%s: %s; so it is made anew", path, error)
        return None
    except (OSError, TypeError, ValueError):
        _LOG.warning("%s: damaged or unreadable, so it is made anew", path)
        return None


def write_trusted(path: Path, header: object, pieces: Iterable[bytes | memoryview]) -> None:
    """Write a file completely or not at all; not at all if the folder cannot be written to."""
    part = path.with_name(f"{path.name}.tmp.{secrets.token_hex(8)}")
    try:
        try:
            with open(part, "xb", opener=_opened) as file:
                file.writelines(packed([path.name, header], pieces))
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        not_kept(error)


def _opened(path: str, flags: int) -> int:
    """Open a new file to which others may not write."""
    return os.open(path, flags, FILE_MODE)


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


def not_kept(reason: object) -> None:
    """Warn that something made could not be kept; only once in a process."""
    if not _WARNED:
        _WARNED.append(reason)
        _LOG.warning(
            "%s: cannot write: %s; so every start makes and compiles again what is missing there "
            "(%s names another folder)",
            *(cache_folder(), getattr(reason, "strerror", None) or reason, FOLDER_VARIABLE),
        )
