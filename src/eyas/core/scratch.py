"""Temporary folders; those that killed processes have left are removed by the next one."""

import os
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

__all__ = ["scratch"]

_PREFIX, _OWNER = "eyas-scratch-", "in-use"
"""Begin of the names of these folders; the file in each that its process has locked."""

_YOUNG = 60.0
"""Age up to which a folder is left alone: its process may be about to lock it [s]."""


@contextmanager
def scratch() -> Iterator[Path]:
    """Make a temporary folder, and remove it at the end.

    The system releases the lock of a process that ends for any reason, so what nobody has locked is
    of a process that was killed.

    Raises:
        OSError: The folder cannot be made.
    """
    _remove_left_ones(Path(tempfile.gettempdir()))
    with tempfile.TemporaryDirectory(prefix=_PREFIX, ignore_cleanup_errors=True) as name:
        with open(Path(name, _OWNER), "x") as file:
            if fcntl is not None:
                with suppress(OSError):  # without locks here, nothing is ever taken for left
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield Path(name)


def _remove_left_ones(place: Path) -> None:
    """Remove the folders of this user's processes that were killed."""
    if fcntl is None:
        return
    for folder in place.glob(f"{_PREFIX}*"):
        with suppress(OSError):  # others may remove it as well
            status = folder.lstat()
            young = time.time() - status.st_mtime < _YOUNG
            if not young and stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid():
                with open(folder / _OWNER) as file:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    shutil.rmtree(folder)
