"""Temporary folders; those that killed processes have left are removed at the next start."""

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

_PREFIX, _OWNER = "eyas-scratch-", "in-use"
"""Begin of the names of these folders; the file in each that its process has locked."""

_YOUNG = 60.0
"""Age up to which the folder of a process that lives is left alone, as it may lock it next [s]."""


@contextmanager
def scratch() -> Iterator[Path]:
    """Make a temporary folder, and remove it at the end.

    The system releases the lock of a process that ends for any reason, so what nobody has locked is
    of a process that was killed.

    Raises:
        OSError: The folder cannot be made.
    """
    remove_left_scratch()
    own = f"{_PREFIX}{os.getpid()}-"
    with tempfile.TemporaryDirectory(prefix=own, ignore_cleanup_errors=True) as name:
        with open(Path(name, _OWNER), "x") as file:
            if fcntl is not None:
                with suppress(OSError):  # without locks here, nothing is ever taken for left
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield Path(name)


def remove_left_scratch() -> None:
    """Remove the folders of this user's processes that were killed."""
    if fcntl is None:
        return
    with suppress(OSError):  # there is no folder for temporary files
        for folder in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
            with suppress(OSError):  # others may remove it as well
                _remove_if_left(folder)


def _remove_if_left(folder: Path) -> None:
    status, dead = folder.lstat(), _is_dead(folder.name)
    young = time.time() - status.st_mtime < _YOUNG
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.geteuid() or (young and not dead):
        return
    if dead and not (folder / _OWNER).exists():  # killed before it could lock it
        shutil.rmtree(folder)
        return
    with open(folder / _OWNER) as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder)


def _is_dead(name: str) -> bool:
    """Return whether the process that a folder is named after has ended."""
    number = name.removeprefix(_PREFIX).partition("-")[0]
    if not number.isdecimal() or len(number) > 9:
        return False
    try:
        os.kill(int(number), 0)
    except OSError as error:  # it may be another user's
        return isinstance(error, ProcessLookupError)
    return False
