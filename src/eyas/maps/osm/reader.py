"""OpenStreetMap files: `.osm`, plain or packed, and `.osm.pbf`, told apart by their content."""

import bz2
import gzip
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from eyas.engine.core.errors import ConfigError, DataFileError, MissingExtraError
from eyas.engine.core.files import refuse_pointer

Tags = dict[str, str]
Bounds = tuple[float, float, float, float]  # West, south, east and north, in degrees


@dataclass(frozen=True, slots=True)
class Way:
    """A line of nodes; an area if it is closed and its tags say so."""

    id: int
    nodes: tuple[int, ...]
    tags: Tags


@dataclass(frozen=True, slots=True)
class Relation:
    """A group of ways, for example the outlines of an area with holes."""

    id: int
    members: tuple[tuple[str, int, str], ...]
    """Kind (`node`, `way`, `relation`), id and role of each member."""
    tags: Tags


@dataclass(slots=True)
class OsmData:
    """Everything that an OpenStreetMap file tells and a map can use."""

    places: dict[int, tuple[float, float]] = field(default_factory=dict)
    """Longitude and latitude of each node, in degrees."""
    nodes: dict[int, Tags] = field(default_factory=dict)  # Tags of the nodes that have some
    ways: dict[int, Way] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    bounds: Bounds | None = None  # The area that the file says it covers


_KINDS = {"n": "node", "w": "way", "r": "relation"}


def read_pbf(path: Path) -> OsmData:
    """Return the content of a file in OpenStreetMap's binary format.

    Raises:
        DataFileError: The file is damaged.
        MissingExtraError: pyosmium is not installed.
    """
    try:
        import osmium
    except ImportError:
        raise MissingExtraError(
            f"{path.name}, a .pbf file,",
            "osm",
            "(or turn it into .osm with other tools, which needs nothing)",
        ) from None
    data = OsmData()
    try:
        file = osmium.FileProcessor(str(path))
        box = file.header.box()
        if box.valid():
            low, high = box.bottom_left, box.top_right
            data.bounds = (low.lon, low.lat, high.lon, high.lat)
        for thing in file:
            _take_pbf(thing, data)
    except (RuntimeError, OSError, ValueError) as error:
        raise DataFileError(f"{path}: not a complete OpenStreetMap file: {error}") from error
    return data


def _take_pbf(one: Any, data: OsmData) -> None:  # noqa: ANN401  # pyosmium need not be there
    """Add a node, way or relation of pyosmium to the data."""
    tags = {tag.k: tag.v for tag in one.tags}
    number = int(one.id)
    kind = one.type_str()
    if kind == "n" and one.location.valid():
        data.places[number] = (one.location.lon, one.location.lat)
        if tags:
            data.nodes[number] = tags
    elif kind == "w":
        line = tuple(int(node.ref) for node in one.nodes)
        data.ways[number] = Way(number, line, tags)
    elif kind == "r":
        members = tuple((_KINDS[m.type], int(m.ref), str(m.role)) for m in one.members)
        data.relations.append(Relation(number, members, tags))


_PACKED: dict[bytes, Callable[[Path], Any]] = {b"\x1f\x8b": gzip.open, b"BZ": bz2.open}
"""What opens packed files, by how they begin."""

_LARGEST = 400 << 20
"""Largest file, packed and unpacked [bytes]; one of a dense square kilometre has about 6 MB."""


def read_osm(path: Path) -> OsmData:
    """Return the content of an OpenStreetMap file.

    Raises:
        DataFileError: The file is missing, too large, damaged, or of another kind.
        MissingExtraError: It is a `.pbf` file, and pyosmium is not installed.
    """
    try:
        if not path.is_file():
            raise DataFileError(f"{path}: cannot read: there is no such file")
        size = path.stat().st_size
        with path.open("rb") as file:
            start = file.read(64)
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error
    if size > _LARGEST:
        raise DataFileError(
            f"{path}: larger than {_LARGEST >> 20} MiB; cut a part out of it first, for example "
            "with `osmium extract --bbox WEST,SOUTH,EAST,NORTH`"
        )
    refuse_pointer(path, start)
    if b"OSMHeader" in start:
        from eyas.maps.osm.reader import read_pbf  # pyosmium, which is optional

        data = read_pbf(path)
    elif start.startswith(tuple(_PACKED)) or start.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        data = _read_xml(path, _PACKED.get(start[:2], partial(Path.open, mode="rb")))
    else:
        raise DataFileError(
            f"{path}: not an OpenStreetMap file (.osm, .osm.gz, .osm.bz2 or .osm.pbf)"
        )
    if not data.places:
        if _is_lanelet2(data):
            raise no_streets(data, str(path))
        raise DataFileError(f"{path}: has no nodes, so there is nothing to import")
    _unroll(data)
    return data


def _unroll(data: OsmData) -> None:
    """Let longitudes of a place at the date line count on beyond 180 degrees."""
    longitudes = [x for x, _ in data.places.values()]
    if max(longitudes) - min(longitudes) <= 180.0:
        return
    data.places = {node: (x % 360.0, y) for node, (x, y) in data.places.items()}
    if data.bounds is not None:
        west, south, east, north = data.bounds
        west, east = west % 360.0, east % 360.0
        data.bounds = (west, south, east, north) if west < east else None


def covered(data: OsmData, asked: Bounds | None, source: str) -> Bounds:
    """Return the area to import: the one asked for, what the file covers, or where its streets are.

    Raises:
        ConfigError: The area asked for is empty, or has nothing of the file in it.
        DataFileError: The file has no streets.
    """
    if asked is not None:
        west, south, east, north = asked
        if any(x > 180.0 for x, _ in data.places.values()):
            west, east = west % 360.0, east % 360.0
            asked = west, south, east, north
        if not (-180 <= west < east <= 360 and -80 <= south < north <= 80):
            raise ConfigError(
                f"--bbox: {asked} is not allowed; allowed: west, south, east and north in degrees"
            )
        if not any(west < x < east and south < y < north for x, y in data.places.values()):
            raise ConfigError(f"--bbox: nothing of {source} lies within {asked}")
        return asked
    if data.bounds is not None:
        return _with_drawn(data, data.bounds)
    on_streets = [
        data.places[node]
        for way in data.ways.values()
        if "highway" in way.tags
        for node in way.nodes
        if node in data.places
    ]
    if not on_streets:
        raise no_streets(data, source)
    x, y = zip(*on_streets, strict=True)
    return min(x), min(y), max(x), max(y)


def no_streets(data: OsmData, source: str) -> DataFileError:
    """Return the error about a file without streets for cars."""
    if _is_lanelet2(data):
        return DataFileError(f"{source}: is a map of Lanelet2, which is not read")
    return DataFileError(
        f"{source}: has no streets for cars there (ways with the tag 'highway' and places)"
    )


def _is_lanelet2(data: OsmData) -> bool:
    return any(one.tags.get("type") == "lanelet" for one in data.relations)


def _with_drawn(data: OsmData, bounds: Bounds) -> Bounds:
    """Return the area, and around it the streets that an editor has drawn beyond it (JOSM)."""
    west, south, east, north = bounds
    for way in data.ways.values():
        places = [data.places[node] for node in way.nodes if node in data.places]
        if way.id < 0 and places and "highway" in way.tags:
            x, y = zip(*places, strict=True)
            beside = max(x) < bounds[0] or min(x) > bounds[2]
            if beside or max(y) < bounds[1] or min(y) > bounds[3]:
                west, south = min(west, *x), min(south, *y)
                east, north = max(east, *x), max(north, *y)
    return west, south, east, north


def _read_xml(path: Path, opened: Callable[[Path], Any]) -> OsmData:
    builder = _Builder(path)
    parser = ElementTree.XMLParser(target=builder)
    left = _LARGEST
    try:
        with opened(path) as file:
            while part := file.read(1 << 16):
                left -= len(part)
                if left < 0:
                    raise DataFileError(f"{path}: larger than {_LARGEST >> 20} MiB when unpacked")
                parser.feed(part)
        parser.close()
    except ElementTree.ParseError as error:
        raise DataFileError(f"{path}: not a complete OpenStreetMap file: {error}") from error
    except (OSError, EOFError, zlib.error) as error:
        raise DataFileError(f"{path}: cannot read: {error}") from error
    except (ValueError, LookupError) as error:  # the encoding may be unknown
        raise DataFileError(f"{path}: not a readable OpenStreetMap file: {error!r}") from error
    return builder.gathered


class _Builder:
    """Takes nodes, ways, relations and bounds one by one from a parser. The text in and between
    elements, of which the format has none, is dropped: it would pile up in memory.
    """

    def __init__(self, path: Path) -> None:
        self.gathered = OsmData()  # `data` would be called with the text
        self._path = path
        self._depth = 0
        self._element: ElementTree.Element | None = None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Begin an element."""
        self._depth += 1
        if self._depth == 1 and tag != "osm":
            raise DataFileError(f"{self._path}: not an OpenStreetMap file: its content is <{tag}>")
        if self._depth == 2 and tag in ("node", "way", "relation", "bounds"):
            self._element = ElementTree.Element(tag, attributes)
        elif self._element is not None:
            ElementTree.SubElement(self._element, tag, attributes)

    def end(self, tag: str) -> None:
        """End an element."""
        self._depth -= 1
        if self._depth == 1 and self._element is not None:
            _take(self._element, self.gathered)
            self._element = None


def _take(element: ElementTree.Element, data: OsmData) -> None:
    """Add what an element tells to the data; deleted objects have no place or `visible="false"`."""
    if element.tag == "bounds":
        limits = [float(element.attrib[low]) for low in _LIMITS]
        if not _on_earth(*limits[:2]) or not _on_earth(*limits[2:]):
            raise ValueError(f"bounds {limits} are not on the earth")
        west, south, east, north = data.bounds or limits  # editors write one for each download
        data.bounds = (
            min(west, limits[0]), min(south, limits[1]), max(east, limits[2]), max(north, limits[3])
        )  # fmt: skip
        return
    if element.get("visible") == "false" or element.get("action") == "delete":
        return
    number = int(element.attrib["id"])
    tags: Tags = {tag.attrib["k"]: tag.attrib["v"] for tag in element.iter("tag")}
    if element.tag == "node":
        if element.get("lon") == element.get("lat") == "":
            return  # of maps of Lanelet2 in metres
        place = float(element.attrib["lon"]), float(element.attrib["lat"])
        if not _on_earth(*place):
            raise ValueError(f"node {number} lies at {place}, not on the earth")
        data.places[number] = place
        if tags:
            data.nodes[number] = tags
    elif element.tag == "way":
        line = tuple(int(node.attrib["ref"]) for node in element.iter("nd"))
        data.ways[number] = Way(number, line, tags)
    else:
        members = tuple(
            (one.attrib["type"], int(one.attrib["ref"]), one.get("role", ""))
            for one in element.iter("member")
        )
        data.relations.append(Relation(number, members, tags))


def _on_earth(longitude: float, latitude: float) -> bool:
    return abs(longitude) <= 180.0 and abs(latitude) <= 90.0  # also not a number: it is not


_LIMITS = ("minlon", "minlat", "maxlon", "maxlat")
