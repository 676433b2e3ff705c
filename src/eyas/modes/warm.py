"""Fill the cache in advance, for images of a cluster whose machines cannot write to it."""

import time
from collections.abc import Sequence

import numpy as np

from eyas.core.cache.entries import entries
from eyas.core.cache.folder import cache_limit
from eyas.core.errors import OutputError
from eyas.core.files import refusals
from eyas.lanes.folder import FOLDER_VARIABLE, cache_folder
from eyas.modes.gallery.run import conditions
from eyas.settings.config import EyasConfig
from eyas.sim.build import build_simulation
from eyas.sim.scenes import load_solids
from eyas.sim.worlds import each_alone
from eyas.state.draw import Picture
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS

__all__ = ["run"]


def run(map_names: Sequence[str] = (), weather_names: Sequence[str] = ()) -> None:
    """Put into the cache what the default settings need, with passers-by and without.

    Args:
        map_names: The maps; empty: all.
        weather_names: The weathers; empty: all.

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
