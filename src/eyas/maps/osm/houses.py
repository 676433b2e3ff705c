"""Buildings of OpenStreetMap: footprints, heights and roofs from their tags."""

from typing import Literal

import shapely

from eyas.engine.world.roads.areas import polygons_of
from eyas.maps.osm.features import House, Roof
from eyas.maps.osm.measures import Odd, colour, length, number
from eyas.maps.osm.reader import Bounds, OsmData, Tags
from eyas.maps.osm.rings import OsmShapes

_ROOFS: dict[str, Roof] = {
    "flat": "flat",
    "gabled": "gabled", "gambrel": "gabled", "saltbox": "gabled", "round": "gabled",
    "gabled_height_moved": "gabled", "double_saltbox": "gabled", "crosspitched": "gabled",
    "hipped": "hipped", "half-hipped": "hipped", "mansard": "hipped", "side_hipped": "hipped",
    "hipped-and-gabled": "hipped", "quadruple_saltbox": "hipped",
    "pyramidal": "pyramidal", "cone": "pyramidal", "conical": "pyramidal",
    "skillion": "skillion", "lean_to": "skillion", "pent": "skillion",
    "dome": "dome", "onion": "dome",
}  # fmt: skip
"""The shape that each value of `roof:shape` is drawn as."""

_NO_HOUSES = {"no", "proposed", "construction", "demolished", "ruins", "none"}
_COVERED = 0.85  # Share of an outline from which on its parts are the whole building
_HIGHEST = 900.0
_PART = "building:part"


def houses_of(
    shapes: OsmShapes,  # Polygons of the file
    odd: Odd,  # Told of tags whose values make no sense
) -> list[House]:
    """Return all buildings; one that is described by parts is replaced by these."""
    parts = [_house(tags, shape, _PART, odd) for tags, shape in shapes.areas(_is_part)]
    outlines = [_house(tags, shape, "building", odd) for tags, shape in shapes.areas(_is_house)]
    if not parts:
        return outlines
    tree = shapely.STRtree([part.shape for part in parts])
    whole: list[House] = []
    for house in outlines:
        inside = [parts[k] for k in tree.query(house.shape) if _mostly(parts[k].shape, house.shape)]
        for part in inside:
            _complete(part, house)
        # Parts that begin in the air stand on the rest of the outline.
        ground = [part.shape for part in inside if part.bottom < 0.5]
        rest = shapely.difference(house.shape, shapely.union_all(ground))
        if not inside or rest.area > (1.0 - _COVERED) * house.shape.area:
            whole += [_piece(house, one) for one in polygons_of(rest) if one.area > 4.0]
    return whole + parts


def buildings_beyond(data: OsmData, limits: Bounds) -> int:
    """Return the number of buildings that lie outside of an area."""
    west, south, east, north = limits
    count = 0
    for way in data.ways.values():
        places = [data.places[node] for node in way.nodes if node in data.places]
        if places and _is_house(way.tags):
            count += not any(west <= x <= east and south <= y <= north for x, y in places)
    return count


def _is_house(tags: Tags) -> bool:
    kind = tags.get("building", "no")
    return kind not in _NO_HOUSES and not _buried(tags) and not _is_part(tags)


def _is_part(tags: Tags) -> bool:
    return tags.get(_PART, "no") not in _NO_HOUSES and not _buried(tags)


def _buried(tags: Tags) -> bool:
    return tags.get("location") == "underground" or tags.get("layer", "").startswith("-")


def _house(tags: Tags, shape: shapely.Polygon, key: str, odd: Odd) -> House:
    height = length(tags, "height", (1.0, _HIGHEST), odd)
    if height is None:
        height = length(tags, "building:height", (1.0, _HIGHEST), odd)
    levels = number(tags, "building:levels", (0.0, 250.0), odd)
    bottom = length(tags, "min_height", (0.0, _HIGHEST), odd)
    if bottom is None:
        first = number(tags, "building:min_level", (0.0, 250.0), odd)
        bottom = 3.0 * first if first is not None else 0.0
    roof_height = length(tags, "roof:height", (0.0, 80.0), odd)
    if roof_height is None:
        storeys = number(tags, "roof:levels", (0.0, 10.0), odd)
        roof_height = 3.0 * storeys if storeys else None
    if height is not None and height <= bottom:
        odd("height")
        height = None
    return House(
        shape=shape,
        kind=tags.get(key, "yes") if tags.get(key) != "yes" else tags.get("building", "yes"),
        bottom=bottom,
        height=height,
        levels=levels,
        roof=_roof(tags, odd),
        roof_height=roof_height,
        across=tags.get("roof:orientation") == "across",
        wall=colour(tags, "building:colour", odd),
        cover=colour(tags, "roof:colour", odd),
    )


def _roof(tags: Tags, odd: Odd) -> Roof | Literal[""]:
    text = tags.get("roof:shape", tags.get("building:roof:shape", "")).strip().lower()
    if text and text not in _ROOFS:
        odd("roof:shape")
    return _ROOFS.get(text, "")


def _mostly(part: shapely.Polygon, house: shapely.Polygon) -> bool:
    return bool(shapely.intersection(part, house).area > 0.5 * part.area)


def _complete(part: House, house: House) -> None:
    """Fill in what is told of the whole building only."""
    if part.kind == "yes":
        part.kind = house.kind
    part.wall = part.wall or house.wall
    part.cover = part.cover or house.cover
    if part.height is None and part.levels is None:
        part.height, part.levels = house.height, house.levels
        if part.height is not None and part.height <= part.bottom:
            part.height = None


def _piece(house: House, shape: shapely.Polygon) -> House:
    return House(
        shape=shape, kind=house.kind, bottom=house.bottom, height=house.height,
        levels=house.levels, roof=house.roof, roof_height=house.roof_height,
        across=house.across, wall=house.wall, cover=house.cover,
    )  # fmt: skip
