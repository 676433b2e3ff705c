"""The entries of the cache: listing, writing, and removing the ones that were not used for long.

Only what Eyas made is counted or removed: files whose names have the forms below, and numba's
files in folders of kernels. A file that another process has mapped stays readable for it.
"""

import contextlib
import math
import os
import re
import secrets
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from eyas.core.cache.folder import Kind
from eyas.core.files import PART_SUFFIX

__all__ = ["Entry", "clear", "entries", "prune", "write_entry"]

_DAY = 86_400.0

_KERNELS_LAST = 30 * _DAY
"""How long kernels are kept after their last use, if others are in use [s]."""

_PARTS_LAST = _DAY
"""Longest time to write an entry [s]; an older part is of a process that was killed."""

_ARRAYS = r"eyas-[0-9a-f]{32}\.npy"
_RECORDING = r".+-\d+-[0-9a-f]{32}\.npz"
_PARTS = rf"\.(?:{_ARRAYS}|{_RECORDING})\.[0-9a-f]{{16}}{re.escape(PART_SUFFIX)}"

_FORMS = (
    *((kind, kind.value, _ARRAYS) for kind in Kind),
    (Kind.TRAFFIC, "traffic", _RECORDING),
    (Kind.KERNELS, "kernels", r"[0-9a-f]{16}"),
    (Kind.OLD, "made", r"[a-z]+-[0-9a-f]{32}\.pickle"),
    (Kind.OLD, "shadows", r"[0-9a-f]{32}\.npz"),
    (Kind.OLD, "traffic", r".+-\d+-[0-9a-f]{16}\.npz"),
)
"""Kinds, their folders, and the forms of the names in them."""

_KERNEL_FILE = re.compile(r".*\.nb[ci](\.tmp\..*)?|started")


@dataclass(frozen=True, slots=True)
class Entry:
    """A file of the cache, or a folder of kernels."""

    kind: Kind
    path: Path
    size: int
    """[bytes]"""
    used: float
    """When it was used last [s since 1970]."""


def entries(folder: Path) -> list[Entry]:
    """Return all entries of a cache, the ones not used for longest first."""
    found = [
        Entry(kind, path, _size(path, status), status.st_mtime)
        for kind, name, form in _FORMS
        for path, status in _named(folder / name, form)
        if (S_ISDIR if kind == Kind.KERNELS else S_ISREG)(status.st_mode)
    ]
    return sorted(found, key=lambda entry: entry.used)


def write_entry(path: Path, pieces: Iterable[bytes | memoryview], limit: int) -> None:
    """Write an entry, whole or not at all, and remove others if the cache becomes too large.

    Args:
        path: `<folder>/<kind>/<name>`, with a name of the form of its kind.
        pieces: Its content.
        limit: How large the cache may become [bytes].

    Raises:
        OSError: The file system refused.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # Processes may write the same entry at once; each has a part of its own.
    part = path.with_name(f".{path.name}.{secrets.token_hex(8)}{PART_SUFFIX}")
    try:
        with part.open("xb") as file:
            file.writelines(pieces)
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    prune(path.parent.parent, limit)


def prune(folder: Path, limit: int) -> None:
    """Remove what was not used for longest until the cache is no larger than its limit.

    Kernels that no one used for a month go in any case, and parts of processes that were killed.
    The kernels of this process stay.
    """
    now = time.time()
    _remove_parts(folder, [kind.value for kind in Kind], now - _PARTS_LAST)
    mine = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
    found = entries(folder)
    total = sum(entry.size for entry in found)
    for entry in found:
        stale = entry.kind == Kind.KERNELS and now - entry.used > _KERNELS_LAST
        if entry.path != mine and (stale or total > limit):
            total -= _remove(entry)


def _remove(entry: Entry) -> int:
    """Remove an entry; return how much that freed, 0 if it could not be removed [bytes]."""
    if entry.kind == Kind.KERNELS:
        return _remove_kernels(entry.path)
    with contextlib.suppress(OSError):
        entry.path.unlink()
        return entry.size
    return 0


def clear(folder: Path, kind: Kind | None = None) -> int:
    """Remove all entries, or those of one kind; return how much that freed [bytes].

    A process that uses an entry goes on; one that is writing an entry will not keep it.
    """
    chosen = [entry for entry in entries(folder) if kind in (None, entry.kind)]
    freed = sum(map(_remove, chosen))
    _remove_parts(folder, {name for of, name, _ in _FORMS if kind in (None, of)}, math.inf)
    for emptied in {entry.path.parent for entry in chosen}:
        with contextlib.suppress(OSError):  # it holds something else
            emptied.rmdir()
    return freed


def _remove_parts(folder: Path, names: Iterable[str], before: float) -> None:
    """Remove what processes have begun to write in some folders, last before a time."""
    for name in names:
        for path, status in _named(folder / name, _PARTS):
            if status.st_mtime < before:
                with contextlib.suppress(OSError):
                    path.unlink()


def _named(folder: Path, form: str) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield what lies in a folder and has a name of a form, with its status."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return
    for name in names:
        if re.fullmatch(form, name):
            with contextlib.suppress(OSError):  # removed by another process just now
                yield folder / name, os.lstat(folder / name)


def _size(path: Path, status: os.stat_result) -> int:
    if S_ISREG(status.st_mode):
        return status.st_size
    size = 0
    for file in _kernel_files(path):
        with contextlib.suppress(OSError):
            size += file.lstat().st_size
    return size


def _kernel_files(folder: Path) -> list[Path]:
    return [
        Path(path, name)
        for path, _, names in os.walk(folder)
        for name in names
        if _KERNEL_FILE.fullmatch(name)
    ]


def _remove_kernels(folder: Path) -> int:
    freed = 0
    for file in _kernel_files(folder):
        with contextlib.suppress(OSError):
            size = file.lstat().st_size
            file.unlink()
            freed += size
    for path, _, _ in os.walk(folder, topdown=False):
        with contextlib.suppress(OSError):  # it holds something that is not ours
            os.rmdir(path)
    return freed
