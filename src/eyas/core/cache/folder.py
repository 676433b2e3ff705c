"""The folder of the cache: its location, size limit and layout.

    <folder>/<kind>/eyas-<key>.npy             arrays, see `eyas.core.cache.array_file`
    <folder>/traffic/<map>-<seed>-<key>.npz    recordings of traffic
    <folder>/definitions/eyas-<key>.json       what source files say, see `eyas.core.program`
    <folder>/kernels/<key>/                    compiled kernels, see `eyas.lanes.machine_code`

The modification time of an entry is the time of its last use.
"""

import logging
import os
import re
from enum import StrEnum
from pathlib import Path

import platformdirs

from eyas.core.errors import ConfigError

__all__ = [
    "FOLDER_VARIABLE",
    "LIMIT_VARIABLE",
    "Kind",
    "cache_folder",
    "cache_limit",
    "not_kept",
    "touch",
]

_LOG = logging.getLogger("eyas")

_WARNED: list[object] = []
"""Why something could not be kept: one reason of maybe many."""

FOLDER_VARIABLE = "EYAS_CACHE_DIR"
"""Environment variable: the folder of the cache, instead of the user's default."""

LIMIT_VARIABLE = "EYAS_CACHE_LIMIT"
"""Environment variable: largest size of the cache."""

_DEFAULT_LIMIT = 2 << 30

_UNITS = {"": 0, "K": 10, "M": 20, "G": 30, "T": 40}


class Kind(StrEnum):
    """Kinds of entries; the value is the name of the folder in the cache."""

    SCENE = "scene"
    TEXTURES = "textures"
    PARTS = "parts"
    GEOMETRY = "geometry"
    SOLIDS = "solids"
    SKY = "sky"
    SHADOWS = "shadows"
    AMBIENT = "ambient"
    TRAFFIC = "traffic"
    MOTION = "motion"
    OCCLUSION = "occlusion"
    DEFINITIONS = "definitions"
    KERNELS = "kernels"


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    named = os.environ.get(FOLDER_VARIABLE)
    try:
        return Path(named or platformdirs.user_cache_dir("eyas")).expanduser().absolute()
    except RuntimeError:  # the user has no home
        return Path(os.devnull, "eyas")  # where nothing can be kept


def cache_limit() -> int:
    """Return the largest size of the cache [bytes].

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    text = os.environ.get(LIMIT_VARIABLE)
    if not text:
        return _DEFAULT_LIMIT
    size = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?\s*", text, re.IGNORECASE)
    if size is None:
        raise ConfigError(
            f"{LIMIT_VARIABLE}: {text!r} is not allowed; allowed: bytes, or a number with "
            "K, M, G or T, for example 500M"
        )
    return int(float(size[1]) * (1 << _UNITS[size[2].upper()]))


def not_kept(reason: object) -> None:
    """Warn that something made could not be kept; only once in a process."""
    if not _WARNED:
        _WARNED.append(reason)
        _LOG.warning(
            "%s: cannot write: %s; so every start makes and compiles again what is missing there "
            "(%s names another folder)",
            *(cache_folder(), getattr(reason, "strerror", None) or reason, FOLDER_VARIABLE),
        )


def touch(path: Path) -> None:
    """Set the last use of an entry to now, if the cache can be written to."""
    try:
        os.utime(path)
    except OSError:
        pass
