"""A map for other programs: the formats of `eyas maps export`."""

from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from eyas.engine.core.errors import UnknownNameError
from eyas.engine.world.maps import MAPS

__all__ = ["ExportOptions", "MapFormat", "export", "format_named"]


class MapFormat(StrEnum):
    """The formats."""

    GLTF = "gltf"
    """Shapes, textures and lamps as one binary glTF file."""
    USD = "usd"
    """The same as OpenUSD, with classes and colliders."""
    OPENDRIVE = "opendrive"
    """Roads and traffic lights as OpenDRIVE."""
    SUMO = "sumo"
    """A folder: roads and traffic for SUMO."""
    GEOJSON = "geojson"
    """A folder: streets, buildings and rasters."""
    WEBOTS = "webots"
    """A folder: a project of Webots, laid out as the original's."""


_ENDINGS = {
    MapFormat.GLTF: ".glb",
    MapFormat.USD: ".usdc",
    MapFormat.OPENDRIVE: ".xodr",
    MapFormat.SUMO: "-sumo",
    MapFormat.GEOJSON: "-geojson",
    MapFormat.WEBOTS: "-webots",
}


class ExportOptions(NamedTuple):
    """What is exported, and how fine."""

    name: str
    """Name of the map."""
    seed: int = 0
    """Seed of the map."""
    detail: int = 1
    """Level of detail of trees and furniture; 0 is the finest."""
    lamps: bool = True
    """Whether street lamps are lights."""
    cell: float | None = None
    """Side of a raster cell [m]; None: 0.5, or 1 on a large map."""
    weather: str | None = None
    """Weather of a world of Webots; None: the map's first."""
    hour: float | None = None
    """Its hour, 0 to 24; None: the weather's own."""


def format_named(name: str) -> MapFormat:
    """Return a format by its name.

    Raises:
        UnknownNameError: There is no such format.
    """
    if name not in list(MapFormat):
        raise UnknownNameError("--format", name, list(MapFormat))
    return MapFormat(name)


def export(kind: MapFormat, out: Path | None, options: ExportOptions) -> Iterator[str]:
    """Write a map in a format; yield what was written, a line each.

    Args:
        kind: The format.
        out: The file or folder; None: one in the present folder that is named after the map.
        options: What is exported.

    Raises:
        EyasError: The map cannot be built, an extra is missing, or a file cannot be written.
    """
    path = out or Path(f"{MAPS.get(options.name).name}{_ENDINGS[kind]}")
    name, seed = options.name, options.seed
    # Each format loads its own libraries.
    if kind is MapFormat.GLTF:
        from eyas.maps.programs.gltf import run as write_gltf

        triangles = write_gltf(name, seed, path, options.detail, lamps=options.lamps)
        yield f"{path}: {triangles} triangles"
    elif kind is MapFormat.USD:
        from eyas.maps.programs.usd import run as write_usd

        yield f"{path}: {write_usd(name, seed, path, options.detail)} triangles"
    elif kind is MapFormat.OPENDRIVE:
        from eyas.maps.programs.roads import write_opendrive

        write_opendrive(name, seed, path)
        yield str(path)
    elif kind is MapFormat.SUMO:
        from eyas.maps.programs.roads import write_sumo

        yield from map(str, write_sumo(name, seed, path))
    elif kind is MapFormat.WEBOTS:
        from eyas.dat.webots.project import Condition
        from eyas.dat.webots.project import run as write_webots

        condition = Condition(options.weather, options.hour)
        yield from map(str, write_webots(name, seed, path, options.detail, condition))
    else:
        from eyas.maps.programs.plan_files import write_layers

        yield from map(str, write_layers(name, seed, path, options.cell))
