"""A quarter in which every tag stands that the importer reads, on a plot or a street of its own.

`tools/synthetic_osm.py` puts one beside each town: what no other street or house of it has, a town
of other people's data does.
"""

from collections.abc import Iterator
from itertools import count
from typing import Any, Protocol

import shapely

Point = tuple[float, float]
Tags = dict[str, str]

SIDE = 14.0
"""Side of a plot [m]."""
STEP = 19.0
"""From a plot to the next [m]."""

_GROUND = {
    "natural": "water bay beach sand wood scrub heath grassland",
    "landuse": (
        "basin reservoir railway cemetery recreation_ground allotments forest grass meadow "
        "village_green flowerbed farmland orchard vineyard farmyard construction brownfield quarry "
        "industrial port garages depot commercial retail residential"
    ),
    "waterway": "riverbank dock",
    "leisure": "swimming_pool pitch track playground park garden dog_park golf_course",
    "amenity": "fountain parking",
    "place": "square",
    "man_made": "pier",
}
_ROOFS = (
    "flat gabled gambrel saltbox round gabled_height_moved double_saltbox crosspitched hipped "
    "half-hipped mansard side_hipped hipped-and-gabled quadruple_saltbox pyramidal cone conical "
    "skillion lean_to pent dome onion unheard-of"
)
_COLOURS = ("#d9c7a0", "beige", "#b54", "light grey", "stripes")

_HOUSES: tuple[Tags, ...] = (
    {"height": "12,5 m"},
    {"height": "40'"},
    {"height": "31 ft"},
    {"height": "high"},
    {"height": "6", "min_height": "9"},
    {"building:height": "9"},
    {"building:levels": "4"},
    {"building:levels": "3;4"},
    {"building:levels": "6", "building:min_level": "2"},
    {"height": "14", "min_height": "4"},
    {"building:levels": "2", "roof:shape": "gabled", "roof:levels": "2"},
    {"height": "11", "roof:shape": "hipped", "roof:height": "4"},
    {"height": "8", "roof:shape": "gabled", "roof:orientation": "across"},
    {"height": "8", "building:roof:shape": "pyramidal"},
    {"location": "underground"},
    {"layer": "-1"},
    {"layer": "1"},
    *({"building": kind} for kind in "no proposed construction demolished ruins none".split()),
    *({"building:levels": "3", "roof:shape": "flat", "roof:colour": text} for text in _COLOURS),
    *({"building:levels": "3", "building:colour": text} for text in _COLOURS),
)

_STREETS: tuple[Tags, ...] = (
    {"highway": "tertiary", "lanes": "3", "lanes:forward": "2", "lanes:backward": "1"},
    {"highway": "unclassified", "maxspeed": "20 mph", "sidewalk:left": "yes"},
    {"highway": "living_street", "sidewalk:both": "separate"},
    {"highway": "trunk", "lanes": "4", "turn:lanes:forward": "left|through", "sidewalk": "no"},
    {"highway": "secondary", "lanes": "2", "oneway": "yes", "turn:lanes": "left|through;right"},
    {"highway": "secondary", "oneway": "-1", "maxspeed": "walk"},
    {"highway": "tertiary", "lanes": "3", "turn:lanes:backward": "left|right"},
    {"highway": "motorway", "lanes": "2", "maxspeed": "DE:motorway"},
    {"highway": "motorway_link", "layer": "1", "bridge": "yes"},
    {"highway": "primary", "width": "wide", "sidewalk:right": "separate"},
    {"highway": "road", "footway": "right", "lanes": "many", "maxspeed": "fast"},
)
_SHORT_STREETS: tuple[Tags, ...] = (
    {"highway": "residential"},
    {"highway": "residential", "access": "private"},
    {"highway": "residential", "vehicle": "no"},
    {"highway": "residential", "motor_vehicle": "destination"},
    {"highway": "residential", "motorcar": "yes"},
    {"highway": "service"},
    {"highway": "service", "service": "driveway"},
)

_LINES: tuple[Tags, ...] = (
    *({"highway": kind} for kind in "footway path cycleway steps bridleway track".split()),
    {"highway": "pedestrian", "width": "6"},
    {"highway": "footway", "footway": "sidewalk"},
    {"highway": "path", "tunnel": "yes"},
    *({"waterway": kind} for kind in "river canal stream ditch drain".split()),
    {"waterway": "stream", "width": "4 m"},
    *({"railway": kind} for kind in "rail light_rail tram narrow_gauge subway".split()),
    {"railway": "rail", "layer": "-2"},
    {"natural": "tree_row"},
    {"natural": "tree_row", "height": "9"},
)

_POINTS: tuple[Tags, ...] = (
    {"natural": "tree"},
    {"natural": "tree", "height": "17 m"},
    {"natural": "tree", "height": "tall"},
    {"highway": "street_lamp"},
)


class Writer(Protocol):
    """What the writer of a file offers."""

    def node(self, place: Point, **tags: str) -> int:
        """Add a point; return its number."""
        ...

    def way(self, nodes: list[int], **tags: str) -> int:
        """Add a line of points; return its number."""
        ...

    def area(self, shape: shapely.Polygon, **tags: str) -> None:
        """Add an area."""
        ...

    def relation(self, members: list[tuple[str, int, str]], **tags: str) -> None:
        """Add a relation of members: kind, number and role of each."""
        ...


def add_quarter(out: Writer, west: float, south: float, width: float, start: int) -> float:
    """Add the quarter; return where it ends in the north [m].

    Args:
        out: To add to.
        west: Its western edge [m].
        south: Its southern edge [m].
        width: From west to east [m].
        start: The node of another street with which its streets are connected.
    """
    _add_street(out, west, south, width, start)
    plots = _plots(west, south + STEP, width)
    for tags in _areas():
        x, y = next(plots)
        out.area(shapely.box(x, y, x + SIDE, y + SIDE), **tags)
    _add_parts(out, *next(plots))
    for tags in _LINES:
        x, y = next(plots)
        out.way([out.node((x, y)), out.node((x + SIDE, y + 0.3 * SIDE))], **tags)
    for tags in _POINTS:
        x, y = next(plots)
        out.node((x + 0.5 * SIDE, y + 0.5 * SIDE), **tags)
    return next(plots)[1] + 2 * STEP


def _plots(west: float, south: float, width: float) -> Iterator[Point]:
    """Yield the south-western corners of plots, row by row [m]."""
    columns = int(width / STEP)
    for number in count():
        yield west + STEP * (number % columns), south + STEP * (number // columns)


def _areas() -> Iterator[Tags]:
    for key, values in _GROUND.items():
        yield from ({key: value} for value in values.split())
    yield {"amenity": "parking", "parking": "underground"}
    for kind in ("pedestrian", "footway"):
        yield {"highway": kind, "area": "yes"}
    for tags in _HOUSES:
        yield {"building": "yes"} | tags
    for shape in _ROOFS.split():
        yield {"building": "house", "building:levels": "2", "roof:shape": shape}
        yield {"building": "house", "roof:shape": shape, "roof:colour": "#803020"}


def _add_parts(out: Writer, x: float, y: float) -> None:
    """Add a building of parts, which lack what only the whole one tells."""
    whole = shapely.box(x, y, x + SIDE, y + SIDE)
    out.area(whole, building="office", height="20", **{"roof:colour": "grey"})
    out.area(shapely.box(x, y, x + SIDE, y + 0.5 * SIDE), **{"building:part": "yes"})
    tower = {"building:part": "tower", "height": "32", "min_height": "20", "roof:shape": "flat"}
    out.area(shapely.box(x + 4, y + 4, x + 9, y + 9), **tower, **{"building:colour": "white"})


def _add_street(out: Writer, west: float, south: float, width: float, start: int) -> None:
    """Add streets in a row, with crossings of all kinds, a roundabout and turns not allowed."""
    step = width / len(_STREETS)
    last, ways = start, []
    for number, tags in enumerate(_STREETS):
        crossing: dict[str, Any] = {}
        if number % 4 == 1:
            crossing = {"highway": "crossing"} | ({"crossing": "unmarked"} if number > 8 else {})
        middle = out.node((west + step * (number + 0.5), south + 2.0), **crossing)
        signal = {"highway": "traffic_signals"} if number % 6 == 5 else {}
        end = out.node((west + step * (number + 1), south), **signal)
        ways.append(out.way([last, middle, end], **tags))
        last = end
        if number < len(_SHORT_STREETS):
            _add_short(out, (west + step * (number + 1), south), end, _SHORT_STREETS[number])
    x = west + width + 9.0
    ring = [out.node((x + 9.0 * a, south + 9.0 * b)) for a, b in ((0, 1), (1, 0), (0, -1))]
    out.way([last, *ring, last], highway="tertiary", junction="roundabout")
    members = [("way", ways[2], "from"), ("node", start, "via"), ("way", ways[3], "to")]
    turn = {"restriction": "no_u_turn", "except": "bicycle"}
    out.relation(members, type="restriction", **turn)


def _add_short(out: Writer, place: Point, end: int, tags: Tags) -> None:
    """Add a street to the south, and a way for people that crosses it."""
    x, y = place
    out.way([end, out.node((x, y - 16.0))], **tags)
    sides = [out.node((x - 6.0, y - 8.0)), out.node((x + 6.0, y - 8.0))]
    out.way(sides, highway="footway", footway="crossing")
