"""The entries of the cache: listing, writing, and removing the least recently used ones.

Only files that Eyas made are counted or removed: those whose names have the forms below, and
compiled kernels in folders of kernels. A process that has mapped a file can still read it after the
file is removed.
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

from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.files import PART_SUFFIX
from eyas.lanes.folder import kernel_folder
from eyas.lanes.text_index import FOLDER, SUFFIX
from eyas.lanes.trusted import made_folder

_DAY = 86_400.0  # [s]
_KERNELS_LAST = 30 * _DAY  # Time for which kernels are kept after their last use [s]
_PARTS_LAST = _DAY
"""Longest time to write an entry [s]; an older part was left by a process that was killed."""

_ARRAYS = r"eyas-[0-9a-f]{32}\.npy"
_RECORDING = r".+-\d+-[0-9a-f]{32}\.npz"
_DEFINITIONS = rf"eyas-[0-9a-f]{{32}}{re.escape(SUFFIX)}(\.tmp\.[0-9a-f]{{16}})?"
_PARTS = rf"\.(?:{_ARRAYS}|{_RECORDING})\.[0-9a-f]{{16}}{re.escape(PART_SUFFIX)}"

_FORMS = (
    *((kind, kind.value, _ARRAYS) for kind in EntryKind),
    (EntryKind.TRAFFIC, "traffic", _RECORDING),
    (EntryKind.KERNELS, "kernels", r"[0-9a-f]{16}"),
    (EntryKind.DEFINITIONS, FOLDER, _DEFINITIONS),
)
"""Kinds, their folders, and the forms of the names in them."""

_KERNEL_FILE = re.compile(r".*\.ey[km](\.tmp\..*)?|started")


@dataclass(frozen=True, slots=True)
class CacheEntry:
    """A file of the cache, or a folder of kernels."""

    kind: EntryKind
    path: Path
    size: int  # [bytes]
    used: float  # Time of the last use [s since 1970]


def entries(folder: Path) -> list[CacheEntry]:
    """Return all entries of a cache, the least recently used first."""
    found = [
        CacheEntry(kind, path, _size(path, status), status.st_mtime)
        for kind, name, form in _FORMS
        for path, status in _named(folder / name, form)
        if (S_ISDIR if kind == EntryKind.KERNELS else S_ISREG)(status.st_mode)
    ]
    return sorted(found, key=lambda entry: entry.used)


def write_entry(
    path: Path,  # `<folder>/<kind>/<name>`, with a name of the form of its kind
    pieces: Iterable[bytes | memoryview],  # Content of the entry
    limit: int,  # Largest size of the cache [bytes]
) -> None:
    """Write an entry completely or not at all; remove others if the cache becomes too large.

    Raises:
        OSError: The file cannot be written.
    """
    write_whole(path, pieces)
    prune(path.parent.parent, limit)


def write_whole(path: Path, pieces: Iterable[bytes | memoryview]) -> None:
    """Write an entry completely or not at all, and remove no other.

    Raises:
        OSError: The file cannot be written.
    """
    made_folder(path.parent)
    # Several processes may write the same entry at once; each writes its own part.
    part = path.with_name(f".{path.name}.{secrets.token_hex(8)}{PART_SUFFIX}")
    try:
        with part.open("xb") as file:
            file.writelines(pieces)
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def prune(folder: Path, limit: int) -> None:
    """Remove the least recently used entries until the cache is no larger than its limit.

    Kernels unused for a month, and parts left by processes that were killed, are always removed.
    Other kernels in the folder that this process uses are kept.
    """
    now = time.time()
    _remove_parts(folder, [kind.value for kind in EntryKind], now - _PARTS_LAST)
    mine = kernel_folder()
    found = entries(folder)
    total = sum(entry.size for entry in found)
    for entry in found:
        stale = entry.kind == EntryKind.KERNELS and now - entry.used > _KERNELS_LAST
        if entry.path != mine and (stale or total > limit):
            total -= _remove(entry)
        elif entry.path == mine:
            _remove_unused(mine, now - _KERNELS_LAST)


def _remove_unused(folder: Path, before: float) -> None:
    """Remove the kernels of a folder that were last used before a time [s since 1970]."""
    for file in _kernel_files(folder):
        with contextlib.suppress(OSError):
            if file.lstat().st_mtime < before:
                file.unlink()


def _remove(entry: CacheEntry) -> int:
    """Remove an entry; return the size freed, 0 if it could not be removed [bytes]."""
    if entry.kind == EntryKind.KERNELS:
        return _remove_kernels(entry.path)
    with contextlib.suppress(OSError):
        entry.path.unlink()
        return entry.size
    return 0


def clear(folder: Path, kind: EntryKind | None = None) -> int:
    """Remove all entries, or those of one kind; return the size freed [bytes].

    Processes that use an entry are not disturbed; an entry that is being written is lost.
    """
    chosen = [entry for entry in entries(folder) if kind in (None, entry.kind)]
    freed = sum(map(_remove, chosen))
    _remove_parts(folder, {name for of, name, _ in _FORMS if kind in (None, of)}, math.inf)
    for emptied in {entry.path.parent for entry in chosen}:
        with contextlib.suppress(OSError):  # the folder is not empty
            emptied.rmdir()
    return freed


def _remove_parts(folder: Path, names: Iterable[str], before: float) -> None:
    """Remove the parts in some folders that were last written to before a time [s since 1970]."""
    for name in names:
        for path, status in _named(folder / name, _PARTS):
            if status.st_mtime < before:
                with contextlib.suppress(OSError):
                    path.unlink()


def _named(folder: Path, form: str) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield the path and status of everything in a folder whose name has the form."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return
    for name in names:
        if re.fullmatch(form, name):
            with contextlib.suppress(OSError):  # just removed by another process
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
        with contextlib.suppress(OSError):  # it holds other files
            os.rmdir(path)
    return freed
