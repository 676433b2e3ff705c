"""What is known of a map besides its streets; `eyas.maps.towns.completed` decides the rest."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

import shapely
from annotated_types import Ge

from eyas.maps.build.values import Area as Region
from eyas.maps.build.values import Colour, Curve, Named, Outline

Point = tuple[float, float]

Roof = Literal["flat", "gabled", "hipped", "pyramidal", "skillion", "dome"]
"""Shape of a roof."""

PaintColour = Literal["white", "yellow"]
"""Colour of paint on roads."""

AREA_KINDS = (
    "water", "parking", "plaza", "path", "pitch", "playground", "sand", "rail", "park", "forest",
    "scrub", "grass", "farmland", "soil", "industrial", "commercial", "residential",
)  # fmt: skip
"""Kinds of ground; where two overlap, the earlier one lies on top."""


@dataclass(slots=True)
class House:
    """A building, or a part of one, in plan view."""

    shape: Outline
    """Footprint, with courtyards as holes [m]."""
    kind: str = ""
    """As in OpenStreetMap, `house`, `office`, ...; empty: not known."""
    bottom: float = 0.0
    """Height of its foot above the ground [m]."""
    height: Annotated[float, Ge(0.0)] | None = None
    """Height of its highest point above the ground [m]; None: not known."""
    levels: Annotated[float, Ge(0.0)] | None = None
    """Storeys below the roof, counted from the ground; None: not known."""
    roof: Roof | Literal[""] = ""
    """Shape of its roof; empty: not known."""
    roof_height: Annotated[float, Ge(0.0)] | None = None
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

    kind: Annotated[str, Named(lambda: AREA_KINDS)]
    """What it is."""
    shape: Outline
    """[m]"""


@dataclass(slots=True)
class Survey:
    """What is known of a map: buildings, ground, trees, lamps, crossings."""

    houses: list[House] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    trees: list[tuple[float, float, float]] = field(default_factory=list)
    """East, north and height [m] of each tree; height 0: not known."""
    lamps: list[Point] = field(default_factory=list)
    """Street lamps that the file names [m]."""
    crossings: list[Point] = field(default_factory=list)
    """Crossings for people on streets, as mapped [m]."""
    lit_crossings: dict[str, Curve] = field(default_factory=dict)
    """Crossings at traffic lights, by their names in the network [m]."""
    rails: list[Curve] = field(default_factory=list)
    """Tracks of railways [m]."""
    pavement: Region = field(default_factory=shapely.Polygon)
    """Sidewalks and the corners between them [m]."""
    sidewalks: Annotated[float, Ge(0.0)] = 0.0
    """Width of others along all streets [m]; 0: there are none."""
    signals: tuple[str, ...] = ()
    """Edges of the network that end at a traffic light."""
    parking: dict[str, list[Point]] = field(default_factory=dict)
    """Parts of the kerb of each edge of the network along which cars park, from and to [m]."""
    stops: list[Point] = field(default_factory=list)
    """Bus stops [m]."""
    crossing_paint: PaintColour = "yellow"
    """Colour of the bars of crossings."""
    middle_paint: PaintColour = "white"
    """Colour of the line between the two directions of a street."""
