"""Maps made of OpenStreetMap: each is a folder of files, made by `eyas maps import`.

<folder>/<name>/map.json          name, title, origin, size
<folder>/<name>/features.json     buildings, ground, trees, lamps
<folder>/<name>/roads.net.xml.gz  SUMO's network
<folder>/<name>/network.npz       its lanes
<folder>/<name>/traffic*.npz      recordings
<folder>/<name>/ATTRIBUTION.txt   whose data it is
"""

import json
import logging
import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from eyas.core.errors import ConfigError, DataFileError
from eyas.core.files import user_path
from eyas.world.maps.recipe import MapRecipe
from eyas.world.weather import Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = [
    "FOLDER_VARIABLE",
    "FORMAT",
    "IMPORTED",
    "MAP_FILE",
    "ROADS_FILE",
    "Origin",
    "maps_folder",
    "origin_of",
]

_LOG = logging.getLogger("eyas")

FOLDER_VARIABLE = "EYAS_MAPS_DIR"
"""Environment variable: the folder of the imported maps, instead of the user's default."""

FORMAT = "eyas-map-1"
MAP_FILE, ROADS_FILE = "map.json", "roads.net.xml.gz"


@dataclass(frozen=True, slots=True)
class Origin:
    """Where an imported map lies, and what it was made of."""

    name: str
    title: str
    source: str
    """Name of the file that it was made of."""
    longitude: float
    """Of the middle of the map, in degrees."""
    latitude: float
    """Of the middle of the map, in degrees."""
    size: tuple[float, float]
    """Extent of the floor [m]."""
    format: str = FORMAT


def maps_folder() -> Path:
    """Return the folder of the imported maps; it need not exist."""
    import platformdirs

    named = os.environ.get(FOLDER_VARIABLE)
    try:
        return Path(named or platformdirs.user_data_dir("eyas"), "" if named else "maps").absolute()
    except RuntimeError:  # the user has no home
        return Path(os.devnull, "eyas")


def origin_of(folder: Path) -> Origin:
    """Return what the file of an imported map says.

    Raises:
        DataFileError: It is missing or damaged.
    """
    path = folder / MAP_FILE
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        origin = Origin(**{**said, "size": tuple(map(float, said["size"]))})
        width, height = origin.size
        if not all(isinstance(text, str) for text in (origin.name, origin.title, origin.source)):
            raise TypeError("name, title and source must be texts")
    except (OSError, ValueError, TypeError, KeyError, RecursionError) as error:
        raise DataFileError(f"{path}: not the file of an imported map: {error}") from error
    if origin.format != FORMAT or not (0 < width < 1e5 and 0 < height < 1e5):
        raise DataFileError(f"{path}: not the file of an imported map of this version; import it")
    return origin


class ImportedMaps:
    """The imported maps of the user, by their names or by the paths of their folders."""

    def names(self) -> tuple[str, ...]:
        """Return the names of the maps in the folder of imported maps."""
        try:
            inside = sorted(maps_folder().iterdir())
        except OSError:
            return ()
        return tuple(folder.name for folder in inside if self._whole(folder))

    def get(self, name: str) -> MapRecipe | None:
        """Return the map with a name or in a folder; None if there is none.

        Raises:
            DataFileError: Its files are damaged, or the path is of no user.
        """
        folder = user_path(name) if "/" in name or "\\" in name else maps_folder() / name
        try:
            there = (folder / MAP_FILE).is_file()
        except (OSError, ValueError):  # a name that no file can have
            return None
        return _recipe(folder.absolute()) if there else None

    def _whole(self, folder: Path) -> bool:
        if not (folder / MAP_FILE).is_file():
            return False
        try:
            return _recipe(folder).name == folder.name
        except DataFileError as error:
            _LOG.warning("an imported map is left out: %s", error)
            return False


def _recipe(folder: Path) -> MapRecipe:
    origin = origin_of(folder)
    try:
        return MapRecipe(
            name=origin.name,
            title=origin.title,
            roads=partial(_roads, folder, origin.name),
            scene=partial(_scene, folder, origin.name, origin.size),
            home=folder,
        )
    except ConfigError as error:
        raise DataFileError(f"{folder / MAP_FILE}: {error}") from None


def _roads(folder: Path, name: str, seed: int) -> "RoadGraph":
    """Return the streets, the same for every seed."""
    import gzip
    import zlib

    from eyas.state.roads import RoadGraph

    path = folder / ROADS_FILE
    try:
        return RoadGraph(name, seed, (), (), gzip.decompress(path.read_bytes()))
    except (OSError, EOFError, zlib.error) as error:
        raise DataFileError(f"{path}: cannot read: {error}; import the map again") from error


def _scene(
    folder: Path,
    name: str,
    size: tuple[float, float],
    network: "RoadNetwork",
    seed: int,
    season: Season,
) -> "Scene":
    """Build the town; the seed decides what the map does not tell."""
    from eyas.core.files import read_limited
    from eyas.world.maps.imported.scene import build_scene
    from eyas.world.maps.recipe import FEATURES_FILE
    from eyas.world.osm.features import from_text

    path = folder / FEATURES_FILE
    text = read_limited(path, 1 << 30).decode("utf-8", errors="replace")
    return build_scene(name, size, network, from_text(text, str(path)), seed)


IMPORTED = ImportedMaps()
"""The imported maps of the user."""
