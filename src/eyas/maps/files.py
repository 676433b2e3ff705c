"""Maps that are files: a plan, or the folder that `eyas maps import` makes of OpenStreetMap.

<folder>/<name>/map.json          name, title, origin, size
<folder>/<name>/map.plan.json     its plan: what is known of buildings, ground, trees, lamps
<folder>/<name>/roads.net.xml.gz  SUMO's network
<folder>/<name>/network.npz       its lanes
<folder>/<name>/traffic*.npz      recordings
<folder>/<name>/ATTRIBUTION.txt   whose data it is
"""

import logging
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from eyas.engine.core.decoding import gunzipped, read_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited, require_sum, user_path
from eyas.engine.world.maps.recipe import PLAN_FILE, PLAN_SUFFIXES, MapRecipe

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

_LOG = logging.getLogger("eyas")

FOLDER_VARIABLE = "EYAS_MAPS_DIR"
"""Environment variable: the folder of the imported maps, instead of the user's default."""

FORMAT = "eyas-map-2"
MAP_FILE, ROADS_FILE = "map.json", "roads.net.xml.gz"

_LARGEST_ROADS = 256 << 20
"""Largest network of SUMO, unpacked [bytes]; that of 6 x 6 km of a city has 30 MB."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Position of an imported map on earth, and the files that it was made of."""

    name: str
    title: str
    source: str  # Name of the file that it was made of
    longitude: float | None  # Longitude of the middle of the map [degrees]; None: it lies nowhere
    latitude: float | None  # Latitude of the middle of the map [degrees]
    size: tuple[float, float]  # Extent of the floor [m]
    format: str = FORMAT
    checksums: dict[str, str] = field(default_factory=dict)
    """SHA-256 of the files beside it, by name; of older maps none."""


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
        said = read_json(path, 1 << 20, "the file of an imported map")
        origin = Origin(**{**said, "size": tuple(map(float, said["size"]))})
        width, height = origin.size
        if not all(isinstance(text, str) for text in (origin.name, origin.title, origin.source)):
            raise TypeError("name, title and source must be texts")
        placed = (origin.longitude, origin.latitude)
        if placed != (None, None) and not all(map(math.isfinite, placed)):  # type: ignore[arg-type]
            raise TypeError("longitude and latitude must be numbers")
        if not all(isinstance(text, str) for pair in origin.checksums.items() for text in pair):
            raise TypeError("checksums must be texts")
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise DataFileError(f"{path}: not the file of an imported map: {error!s:.300}") from error
    if origin.format != FORMAT or not (0 < width < 1e5 and 0 < height < 1e5):
        raise DataFileError(f"{path}: not the file of an imported map of this version; import it")
    return origin


class MapFiles:
    """Imported maps by names or folders, plans by paths, and maps that ship with traffic that
    keeps left.
    """

    form = "FILE.plan.json"

    def names(self) -> tuple[str, ...]:
        """Return the names of the maps in the folder of imported maps."""
        try:
            inside = sorted(maps_folder().iterdir())
        except OSError:
            return ()
        return tuple(folder.name for folder in inside if self._whole(folder))

    def get(self, name: str) -> MapRecipe | None:
        """Return the map with a name, in a folder or a file; None if there is none.

        Raises:
            DataFileError: Its files are damaged, or the path is of no user.
        """
        if name.endswith(PLAN_SUFFIXES):
            return _recipe_of_plan(user_path(name).absolute())
        folder = user_path(name) if "/" in name or "\\" in name else maps_folder() / name
        try:
            there = (folder / MAP_FILE).is_file()
        except (OSError, ValueError):  # a name that no file can have
            return None
        return _recipe(folder.absolute()) if there else _keeps_left(name)

    def _whole(self, folder: Path) -> bool:
        if not (folder / MAP_FILE).is_file():
            return False
        try:
            return _recipe(folder).name == folder.name
        except DataFileError as error:
            _LOG.warning("an imported map is left out: %s", error)
            return False


def _keeps_left(name: str) -> MapRecipe | None:
    """Return the generated map of a name with `LEFT_ENDING`: one that ships, with other traffic."""
    from eyas.engine.state.roads import LEFT_ENDING
    from eyas.engine.world.maps import MAPS

    kind = name.removesuffix(LEFT_ENDING)
    return MAPS.get(kind).keeping_left() if kind != name and kind in MAPS.built_in else None


def _recipe(folder: Path) -> MapRecipe:
    origin = origin_of(folder)
    try:
        return MapRecipe(
            name=origin.name,
            title=origin.title,
            roads=partial(_roads, folder / ROADS_FILE, origin.name, sums=origin.checksums),
            plan=partial(_plan, folder / PLAN_FILE, sums=origin.checksums),
            origin=None
            if origin.longitude is None or origin.latitude is None
            else (origin.longitude, origin.latitude),
            home=folder,
            checksums=origin.checksums,
        )
    except ConfigError as error:
        raise DataFileError(f"{folder / MAP_FILE}: {error}") from None


def roads_in(path: Path) -> bytes:
    """Return SUMO's network in a file, `.net.xml` or `.net.xml.gz`.

    Raises:
        DataFileError: It cannot be read or unpacked.
    """
    content = read_limited(path, _LARGEST_ROADS)
    try:
        return gunzipped(content, _LARGEST_ROADS) if content[:2] == b"\x1f\x8b" else content
    except ValueError as error:
        raise DataFileError(f"{path}: cannot read: {error}") from None


def _roads(
    path: Path, name: str, seed: int, sums: Mapping[str, str] = MappingProxyType({})
) -> "RoadGraph":
    """Return the streets in a file of SUMO, the same for every seed."""
    from eyas.engine.state.roads import RoadGraph

    require_sum(path, sums)
    return RoadGraph(name, seed, (), (), roads_in(path))


def _plan(
    path: Path, network: "RoadNetwork", seed: int, sums: Mapping[str, str] = MappingProxyType({})
) -> "MapPlan":
    """Return a plan in a file; the seed decides anew what it leaves open."""
    from dataclasses import replace

    from eyas.maps.plan.file import read_plan

    require_sum(path, sums)
    plan = read_plan(path)
    return replace(plan, seed=plan.seed + seed) if plan.survey else plan


def _recipe_of_plan(path: Path) -> MapRecipe:
    """Return the map of a plan in a file; the rest of it is read when it is built."""
    from eyas.maps.plan.file import content_of

    content = content_of(path)
    name, title = content.get("name"), content.get("title", "")
    try:
        return MapRecipe(
            name=str(name),
            title=str(title) or str(name),
            roads=partial(_roads_of_plan, path),
            plan=partial(_plan, path),
            seasons=True,
            file=path,
            notice=str(content.get("attribution", "")),
        )
    except ConfigError as error:
        raise DataFileError(f"{path}: {error}") from None


def _roads_of_plan(path: Path, seed: int) -> "RoadGraph":
    """Return the roads of a plan, the same for every seed."""
    from eyas.engine.state.roads import RoadGraph
    from eyas.maps.plan.file import read_plan, road_faults

    plan = read_plan(path)
    for line in road_faults(plan, path.parent):
        raise DataFileError(f"{path}: {line}")
    roads = plan.roads
    if roads.file:
        return _roads(path.parent / roads.file, plan.name, seed)
    return RoadGraph(plan.name, plan.seed, roads.nodes, roads.edges, left_hand=roads.left_hand)


MAP_FILES = MapFiles()  # The imported maps of the user, and plans in files
