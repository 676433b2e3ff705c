"""A map for other programs: the formats of `eyas maps export`.

Each format loads its own libraries.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from eyas.engine.core.registry import Registry
from eyas.engine.world.maps import MAPS


class MapExport(NamedTuple):
    """What is exported, and how fine."""

    name: str  # Name of the map
    seed: int = 0  # Seed of the map
    detail: int = 1  # Level of detail of trees and furniture; 0 is the finest
    lamps: bool = True  # Whether street lamps are lights
    cell: float | None = None  # Side of a raster cell [m]; None: 0.5, or 1 on a large map.
    weather: str | None = None  # Weather of a world of Webots; None: the map's first
    hour: float | None = None  # Its hour, 0 to 24; None: the weather's own


class MapFormat(NamedTuple):
    """A format."""

    ending: str  # of the name of a file or folder that the user does not name
    write: Callable[[Path, MapExport], Iterator[str]]  # yields what was written, a line each


def export(name: str, out: Path | None, options: MapExport) -> Iterator[str]:
    """Write a map in a format; yield what was written, a line each.

    Args:
        out: The file or folder; None: one in the present folder that is named after the map.
        options: What is exported.

    Raises:
        EyasError: There is no such format, the map cannot be built, an extra is missing, or a file
            cannot be written.
    """
    form = MAP_FORMATS.get(name)
    yield from form.write(out or Path(f"{MAPS.get(options.name).name}{form.ending}"), options)


def _gltf(path: Path, options: MapExport) -> Iterator[str]:
    from eyas.maps.formats.gltf.world import write_gltf

    triangles = write_gltf(options.name, options.seed, path, options.detail, lamps=options.lamps)
    yield f"{path}: {triangles} triangles"


def _usd(path: Path, options: MapExport) -> Iterator[str]:
    from eyas.maps.formats.usd import write_usd

    yield f"{path}: {write_usd(options.name, options.seed, path, options.detail)} triangles"


def _opendrive(path: Path, options: MapExport) -> Iterator[str]:
    from eyas.maps.formats.roads import write_opendrive

    write_opendrive(options.name, options.seed, path)
    yield str(path)


def _sumo(path: Path, options: MapExport) -> Iterator[str]:
    from eyas.maps.formats.roads import write_sumo

    yield from map(str, write_sumo(options.name, options.seed, path))


def _geojson(path: Path, options: MapExport) -> Iterator[str]:
    from eyas.maps.formats.layers import write_layers

    yield from map(str, write_layers(options.name, options.seed, path, options.cell))


GLTF = MapFormat(".glb", _gltf)  # shapes, textures and lamps as one binary file
USD = MapFormat(".usdc", _usd)  # the same as OpenUSD, with classes and colliders
OPENDRIVE = MapFormat(".xodr", _opendrive)  # roads and traffic lights
SUMO = MapFormat("-sumo", _sumo)  # a folder: roads and traffic
GEOJSON = MapFormat("-geojson", _geojson)  # a folder: streets, buildings and rasters

MAP_FORMATS: Registry[MapFormat] = Registry(
    "--format",
    MapFormat,
    {
        name: f"{__name__}:{name.upper()}"
        for name in ("gltf", "usd", "opendrive", "sumo", "geojson")
    },
    group="eyas.map_formats",
)
"""All formats; a user's own is found by its path, `my_package.module:FORMAT`."""
