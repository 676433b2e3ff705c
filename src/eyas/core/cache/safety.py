"""Whose files are loaded as code: those that nobody but their user, or root, can have written."""

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path

__all__ = ["FILE_MODE", "made_folder", "secured", "unsafe"]

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
