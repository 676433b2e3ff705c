"""Reading of `.osm.pbf` files with pyosmium, the only file that needs it (extra `osm`)."""

from pathlib import Path
from typing import Any

from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.maps.osm.data import OsmData, Relation, Way

__all__ = ["read_pbf"]

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
            _take(thing, data)
    except (RuntimeError, OSError, ValueError) as error:
        raise DataFileError(f"{path}: not a complete OpenStreetMap file: {error}") from error
    return data


def _take(one: Any, data: OsmData) -> None:  # noqa: ANN401  # pyosmium need not be there
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
