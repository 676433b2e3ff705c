"""The folder where compiled kernels are kept, among the files of `eyas.lanes.trusted`."""

import errno
import os
from functools import cache
from pathlib import Path

from eyas.lanes.identity import language_hash
from eyas.lanes.trusted import cache_folder, made_folder, secured, touch


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
