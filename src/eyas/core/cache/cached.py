"""Values that take long to compute and are always the same, kept from run to run."""

import logging
import time
from collections.abc import Callable
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar

import numpy as np

from eyas.core.cache.array_file import Content, array_file, map_arrays
from eyas.core.cache.entries import write_entry
from eyas.core.cache.flat import flatten, restore
from eyas.core.cache.folder import Kind, cache_folder, cache_limit, not_kept, touch

__all__ = ["cached"]

Thing = TypeVar("Thing")

_LOG = logging.getLogger("eyas")

_ROOT = Path(__file__).parents[2]

_MATHEMATICS = ("lanes/elementary", "core/exact.py")
"""Makers of whatever is kept: on their last bits everything depends."""

_LONG = 1.0
"""Values that took longer than this to make are reported in the log [s]."""


def cached(
    kind: Kind,
    makers: tuple[str, ...],
    inputs: tuple[object, ...],
    make: Callable[[], Thing],
    *,
    of: type[Thing],
    folder: Path | None = None,
) -> Thing:
    """Return a value from the cache; make it anew if its makers' sources or its inputs changed.

    Args:
        kind: Kind of the value.
        makers: Packages of Eyas, and files in them, whose sources make the value.
        inputs: Inputs of the makers: arrays, and values that differ in their `repr`.
        make: Returns the value.
        of: Type of the value; `eyas.core.cache.flat` must be able to flatten it.
        folder: The cache; None: the user's. The cache only saves time: one that cannot be written
            to is not used, and a damaged entry is made anew.

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    limit = cache_limit()
    path = (folder or cache_folder()) / kind / f"eyas-{_key(kind, makers, inputs)}.npy"
    found = _found(path, of)
    if found is not None:
        return found
    start = time.perf_counter()
    made = make()
    taken = time.perf_counter() - start
    flat, arrays = flatten(made)
    content = Content(flat, [np.asarray(array, order="C") for array in arrays])
    # A value just made is restored like one read from the file, so that both have the same types.
    restored = restore(of, *content)
    try:
        write_entry(path, array_file(content, path.name), limit)
    except OSError as error:
        not_kept(error)
    if taken > _LONG:
        _LOG.info("made %s in %.1f s", kind, taken)
    return restored


def _found(path: Path, of: type[Thing]) -> Thing | None:
    """Return the value of an entry; None if there is none, or it is damaged."""
    try:
        found = restore(of, *map_arrays(path))
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return None  # if it cannot be replaced either, that is told
    except (OSError, ValueError):
        _LOG.warning("%s: damaged or unreadable, so it is made anew", path)
        return None
    touch(path)
    return found


def _key(kind: Kind, makers: tuple[str, ...], inputs: tuple[object, ...]) -> str:
    digest = blake2b(f"{np.__version__} {kind}".encode(), digest_size=16)
    for maker in makers:
        digest.update(_sources(_ROOT, maker))
    for maker in _MATHEMATICS:
        digest.update(_sources(_ROOT, maker))
    for value in inputs:
        if isinstance(value, np.ndarray):
            digest.update(repr((value.dtype.str, value.shape)).encode())
            digest.update(np.ascontiguousarray(value).data)
        else:
            digest.update(repr(value).encode())
        digest.update(b"\0")
    return digest.hexdigest()


@cache
def _sources(root: Path, maker: str) -> bytes:
    """Return a hash of the sources of a package or of one file."""
    digest = blake2b(maker.encode(), digest_size=16)
    path = root / maker
    files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    assert files, f"no sources: {path}"
    for file in files:
        digest.update(file.relative_to(root).as_posix().encode())
        digest.update(file.read_bytes())
    return digest.digest()
