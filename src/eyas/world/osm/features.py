"""What an imported map consists of besides its streets, and the file that keeps it."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import shapely

from eyas.core.errors import DataFileError

__all__ = ["AREA_KINDS", "Area", "Features", "House", "from_text", "to_text"]

Colour = tuple[float, float, float]
Point = tuple[float, float]

AREA_KINDS = (
    "water", "parking", "plaza", "path", "pitch", "playground", "sand", "rail", "park", "forest",
    "scrub", "grass", "farmland", "soil", "industrial", "commercial", "residential",
)  # fmt: skip
"""Kinds of ground; where two overlap, the earlier one lies on top."""


@dataclass(slots=True)
class House:
    """A building, or a part of one, in plan view."""

    shape: shapely.Polygon
    """Footprint, with courtyards as holes [m]."""
    kind: str
    """Value of `building` or `building:part`."""
    bottom: float = 0.0
    """Height of its foot above the ground [m]."""
    height: float | None = None
    """Height of its highest point above the ground [m]; None: not known."""
    levels: float | None = None
    """Storeys below the roof, counted from the ground; None: not known."""
    roof: str = ""
    """`flat`, `gabled`, `hipped`, `pyramidal`, `skillion`, `dome`; empty: not known."""
    roof_height: float | None = None
    """Height of the roof [m]; None: not known."""
    across: bool = False
    """Whether the ridge runs across the longer side."""
    wall: Colour | None = None
    """Colour of the walls, sRGB; None: not known."""
    cover: Colour | None = None
    """Colour of the roof, sRGB; None: not known."""


@dataclass(slots=True)
class Area:
    """Ground of one kind."""

    kind: str
    """One of `AREA_KINDS`."""
    shape: shapely.Polygon
    """[m]"""


@dataclass(slots=True)
class Features:
    """Everything on an imported map but its streets."""

    houses: list[House] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    trees: list[tuple[float, float, float]] = field(default_factory=list)
    """East, north and height [m] of each tree; height 0: not known."""
    lamps: list[Point] = field(default_factory=list)
    """Street lamps that the file names [m]."""
    crossings: list[Point] = field(default_factory=list)
    """Crossings for people on streets, as mapped [m]."""
    lit_crossings: dict[str, shapely.LineString] = field(default_factory=dict)
    """Crossings at traffic lights, by their names in the network [m]."""
    rails: list[shapely.LineString] = field(default_factory=list)
    """Tracks of railways [m]."""
    pavement: shapely.Geometry = field(default_factory=shapely.Polygon)
    """Sidewalks and the corners between them [m]."""
    signals: tuple[str, ...] = ()
    """Edges of the network that end at a traffic light."""


def to_text(features: Features) -> str:
    """Return features as JSON; equal ones give equal texts."""
    kept = {one.name: getattr(features, one.name) for one in fields(features)}
    kept["houses"] = [_plain(house) for house in features.houses]
    kept["areas"] = [_plain(area) for area in features.areas]
    lit = features.lit_crossings.items()
    kept["lit_crossings"] = {name: _numbers(line) for name, line in lit}
    kept["rails"] = [_numbers(line) for line in features.rails]
    kept["pavement"] = [_numbers(part) for part in shapely.get_parts(features.pavement)]
    return json.dumps(kept, separators=(",", ":"))


def from_text(text: str, source: str) -> Features:
    """Return the features of a text from `to_text`.

    Raises:
        DataFileError: It is none.
    """
    try:
        kept = json.loads(text)
        return Features(
            houses=[_house(one) for one in kept["houses"]],
            areas=[Area(one["kind"], _polygon(one["shape"])) for one in kept["areas"]],
            trees=[(float(x), float(y), float(z)) for x, y, z in kept["trees"]],
            lamps=[(float(x), float(y)) for x, y in kept["lamps"]],
            crossings=[(float(x), float(y)) for x, y in kept["crossings"]],
            # Maps that were imported before Eyas knew them have none.
            lit_crossings={
                str(name): shapely.LineString(line)
                for name, line in kept.get("lit_crossings", {}).items()
            },
            rails=[shapely.LineString(line) for line in kept["rails"]],
            pavement=shapely.make_valid(
                shapely.MultiPolygon([_polygon(part) for part in kept["pavement"]])
            ),
            signals=tuple(str(name) for name in kept["signals"]),
        )
    except Exception as error:  # JSON of anyone
        raise DataFileError(f"{source}: not the file of an imported map: {error!r:.200}") from error


def _plain(thing: House | Area) -> dict[str, Any]:
    kept = {one.name: getattr(thing, one.name) for one in fields(thing)}
    kept["shape"] = _numbers(thing.shape)
    return kept


def _house(kept: dict[str, Any]) -> House:
    house = House(**{**kept, "shape": _polygon(kept["shape"])})
    house.wall, house.cover = _colour(house.wall), _colour(house.cover)
    return house


def _colour(kept: Sequence[float] | None) -> Colour | None:
    if kept is None:
        return None
    red, green, blue = kept
    return float(red), float(green), float(blue)


def _numbers(shape: shapely.Geometry) -> list[Any]:
    if isinstance(shape, shapely.Polygon):
        return [_numbers(ring) for ring in (shape.exterior, *shape.interiors)]
    return [[round(x, 3), round(y, 3)] for x, y in shape.coords]


def _polygon(rings: list[Any]) -> shapely.Polygon:
    return shapely.Polygon(rings[0], rings[1:])
