"""The folder where compiled kernels are kept, among files that are used as they are
(`eyas.lanes.trusted`).
"""

import errno
import os
from functools import cache
from pathlib import Path

from eyas.lanes.identity import language_hash
from eyas.lanes.trusted import (
    FOLDER_VARIABLE,
    OWNER,
    cache_folder,
    made_folder,
    not_kept,
    open_at_once,
    read_trusted,
    secured,
    touch,
    write_trusted,
)

__all__ = [
    "FOLDER_VARIABLE",
    "OWNER",
    "cache_folder",
    "kernel_folder",
    "made_folder",
    "not_kept",
    "open_at_once",
    "read_trusted",
    "refusal",
    "secured",
    "touch",
    "write_trusted",
]


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
