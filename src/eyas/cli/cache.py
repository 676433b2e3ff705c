"""Show, delete and make the contents of the cache."""

import json
import time
from collections.abc import Iterable, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from eyas.engine.core.cache.entries import CacheEntry, clear, entries
from eyas.engine.core.cache.folder import LIMIT_VARIABLE, EntryKind, cache_limit
from eyas.engine.core.errors import OutputError, UnknownNameError
from eyas.engine.core.files import refusals
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.scenes import load_solids
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.lanes.trusted import FOLDER_VARIABLE, cache_folder
from eyas.maps.gallery.run import conditions


def run_info(*, as_json: bool = False) -> None:
    """Print the folder, size and size limit of the cache, and its contents by kind.

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    limit, found = cache_limit(), entries(cache_folder())
    if as_json:
        kinds = {str(kind): [entry for entry in found if entry.kind == kind] for kind in EntryKind}
        told = {kind: {"entries": len(of), "size": _total(of)} for kind, of in kinds.items()}
        said = {"folder": str(cache_folder()), "limit": limit, "size": _total(found)}
        print(json.dumps(said | {"kinds": told}, indent=1))
        return
    print(f"{cache_folder()} ({FOLDER_VARIABLE} moves it)")
    print(f"{_shown(_total(found))} of at most {_shown(limit)} ({LIMIT_VARIABLE} changes it)")
    if not found:
        return
    table = Table("kind", "entries", "size", "last used")
    for kind in EntryKind:
        chosen = [entry for entry in found if entry.kind == kind]
        if chosen:
            used = time.strftime("%Y-%m-%d %H:%M", time.localtime(chosen[-1].used))
            table.add_row(kind, str(len(chosen)), _shown(_total(chosen)), used)
    Console().print(table)


def run_clear(
    kind: str | None,  # Delete only entries of this kind; None: all
) -> None:
    """Delete the contents of the cache, and print how much space that freed.

    Raises:
        UnknownNameError: There is no such kind.
        OutputError: An entry could not be deleted.
    """
    if kind is not None and kind not in list(EntryKind):
        raise UnknownNameError("--kind", kind, EntryKind)
    chosen = None if kind is None else EntryKind(kind)
    folder = cache_folder()
    freed = clear(folder, chosen)
    print(f"freed {_shown(freed)}")
    left = [entry for entry in entries(folder) if chosen in (None, entry.kind)]
    if left:
        raise OutputError(f"{left[0].path}: cannot remove it (one of {len(left)} entries)")


def _total(found: Iterable[CacheEntry]) -> int:
    return sum(entry.size for entry in found)


def _shown(size: int) -> str:
    return f"{size / 2**20:,.1f} MiB"


def run_warm(map_names: Sequence[str] = (), weather_names: Sequence[str] = ()) -> None:
    """Put into the cache what the default settings need, with passers-by and without.

    Raises:
        ConfigError: No such map or weather.
        OutputError: The cache cannot be written to, or is too small to hold it all.
    """
    wanted, folder = conditions(map_names, weather_names), cache_folder()
    with refusals(folder):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / ".warm").touch()
        (folder / ".warm").unlink()
    begun = time.time()
    for name, weather in wanted:
        start = time.perf_counter()
        for extras in (None, ()):
            _fly(EyasConfig(world=WorldConfig(map=name, weather=weather), extras=extras))
        load_solids(name, 0, MAPS.get(name).season(weather))
        print(f"{name}, {weather}: {time.perf_counter() - start:.1f} s", flush=True)
    used = sum(entry.size for entry in entries(folder) if entry.used >= begun - 1.0)
    print(f"{folder}: {used / 2**20:,.1f} MiB are ready ({FOLDER_VARIABLE} moves it)")
    if used > 0.9 * cache_limit():
        raise OutputError(
            f"{folder}: all of it takes {used / 2**20:,.0f} MiB and more, which is about the limit "
            "of the cache: some may be gone again; raise EYAS_CACHE_LIMIT, or name fewer maps"
        )


def _fly(config: EyasConfig) -> None:
    """Fly for a command and draw a picture, so that everything is made."""
    simulation = build_simulation(config, each_alone(1))
    simulation.reset()
    simulation.advance(np.zeros((1, 4)), 4)
    simulation.packets()
    picture = Picture.create(1, 48, 64, subject=True, actors=simulation.actors)
    simulation.draw(np.zeros(1, np.int32), picture)
    simulation.close()
