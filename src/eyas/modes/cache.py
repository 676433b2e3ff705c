"""Show and delete the contents of the cache."""

import time
from collections.abc import Iterable

from rich.console import Console
from rich.table import Table

from eyas.core.cache.entries import Entry, clear, entries
from eyas.core.cache.folder import LIMIT_VARIABLE, Kind, cache_limit
from eyas.core.errors import OutputError, UnknownNameError
from eyas.lanes.folder import FOLDER_VARIABLE, cache_folder

__all__ = ["run_clear", "run_info"]


def run_info() -> None:
    """Print the folder, size and size limit of the cache, and its contents by kind.

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    limit, found = cache_limit(), entries(cache_folder())
    print(f"{cache_folder()} ({FOLDER_VARIABLE} moves it)")
    print(f"{_shown(_total(found))} of at most {_shown(limit)} ({LIMIT_VARIABLE} changes it)")
    if not found:
        return
    table = Table("kind", "entries", "size", "last used")
    for kind in Kind:
        chosen = [entry for entry in found if entry.kind == kind]
        if chosen:
            used = time.strftime("%Y-%m-%d %H:%M", time.localtime(chosen[-1].used))
            table.add_row(kind, str(len(chosen)), _shown(_total(chosen)), used)
    Console().print(table)


def run_clear(kind: str | None) -> None:
    """Delete the contents of the cache, and print how much space that freed.

    Args:
        kind: Delete only entries of this kind; None: all.

    Raises:
        UnknownNameError: There is no such kind.
        OutputError: An entry could not be deleted.
    """
    if kind is not None and kind not in list(Kind):
        raise UnknownNameError("--kind", kind, Kind)
    chosen = None if kind is None else Kind(kind)
    folder = cache_folder()
    freed = clear(folder, chosen)
    print(f"freed {_shown(freed)}")
    left = [entry for entry in entries(folder) if chosen in (None, entry.kind)]
    if left:
        raise OutputError(f"{left[0].path}: cannot remove it (one of {len(left)} entries)")


def _total(found: Iterable[Entry]) -> int:
    return sum(entry.size for entry in found)


def _shown(size: int) -> str:
    return f"{size / 2**20:,.1f} MiB"
