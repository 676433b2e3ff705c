"""The plan of a map: everything that stands on it, with its place. A builder makes triangles of it.

Areas are already cut out of each other, and every thing has its place: the builder decides nothing.
Random numbers are left for what is texture: wear, leaves, the roughness of mounds. A plan may also
be incomplete: `eyas.maps.towns.completed` makes layers of what `MapPlan.survey` knows.

Lengths are in metres, angles in radians, colours sRGB from 0 to 1. x is east, y is north; z is 0
on roads and -0.1 on the ground.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np
import shapely
from annotated_types import Ge, Len
from numpy.typing import NDArray
from pydantic import Discriminator, StringConstraints, Tag

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.roads import RoadEdge, RoadNode
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import facade, material
from eyas.engine.world.build.placed import Placed
from eyas.maps.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.maps.build.values import (
    Area,
    ClassName,
    Colour,
    Cover,
    Facade,
    Heights,
    Named,
    Natural,
    NumberRows,
    Numbers,
    Outline,
    Path,
    Positive,
    Share,
)
from eyas.maps.land.mounds import Mound
from eyas.maps.osm.features import Survey
from eyas.maps.roads.overpass import Pillar
from eyas.maps.roads.painting import Stripe
from eyas.maps.roads.tunnels import Tunnel
from eyas.maps.things.railway import Viaduct
from eyas.maps.things.skyways import Skyway

__all__ = [
    "Backdrop",
    "Building",
    "BuildingPart",
    "Buildings",
    "Chance",
    "Cover",
    "Deck",
    "Far",
    "Field",
    "Flat",
    "GroundCover",
    "Heap",
    "Hills",
    "LampLight",
    "Layer",
    "MapPlan",
    "Paint",
    "Paved",
    "Railway",
    "Roads",
    "Roadway",
    "Skyways",
    "ThingKind",
    "Things",
    "Tunnels",
    "Walkways",
    "state_of",
    "things",
]


_PAVING, _KERB = material("paving"), material("stone", (1.0, 0.95, 0.92))
_PLASTER, _TILES, _LAWN = facade("facade_plaster"), material("roof_tiles"), material("lawn")


def _makers() -> tuple[str, ...]:
    from eyas.maps.things.kinds import THINGS

    return tuple(THINGS)


def _solids() -> tuple[str, ...]:
    from eyas.maps.things.kinds import SOLIDS

    return tuple(SOLIDS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Chance:
    """Random numbers of shapes: a named stream of the plan's seed, or the state of a generator."""

    stream: str = ""
    """Name of the stream."""
    index: tuple[Natural, ...] = ()
    """Numbers that tell streams of one name apart."""
    state: Annotated[str, StringConstraints(pattern="^(([0-9a-f]+:){2}[01]:[0-9]+)?$")] = ""
    """State of a generator that has placed things before, in place of a stream."""

    def generator(self, seed: int) -> np.random.Generator:
        """Return the generator on the map of a seed, the same at each call."""
        if not self.state:
            return stream(seed, self.stream, *self.index)
        state, increment, halved, half = self.state.split(":")
        made = np.random.PCG64()
        made.state = {
            "bit_generator": "PCG64",
            "state": {"state": int(state, 16), "inc": int(increment, 16)},
            "has_uint32": int(halved),
            "uinteger": int(half),
        }
        return np.random.Generator(made)


_CORNERS = Chance(stream="hills")


def state_of(rng: np.random.Generator) -> Chance:
    """Return the chance that goes on where a generator is now."""
    state = rng.bit_generator.state
    numbers = state["state"]
    return Chance(
        state=f"{numbers['state']:x}:{numbers['inc']:x}:{state['has_uint32']}:{state['uinteger']}"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingKind:
    """A kind of thing, whose shape is made once and copied."""

    name: str
    """Name, by which `Things.kinds` refers to it."""
    make: Annotated[str, Named(_makers)] = ""
    """What it is: a row of `eyas.maps.things.kinds.THINGS`; empty: its name says it."""
    variant: Natural = 0
    """Which of its shapes."""
    width: Positive = 1.0
    """Factor on the width of a tree's crown."""
    storeys: Annotated[int, Ge(1)] = 2
    """Storeys of a house."""
    walls: Cover = _PLASTER
    """Walls of a house."""
    roof: Cover = _TILES
    """Roof of a house."""
    chance: str = ""
    """One of `MapPlan.chances`, which kinds share in their order; empty: one of its own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildingPart:
    """A building, or a part of one: walls, and a roof."""

    outline: Outline
    """Its ground, counter-clockwise; holes are courtyards [m]."""
    bottom: float = FLOOR_HEIGHT
    """z of its foot [m]."""
    height: Annotated[float, Ge(0.0)]
    """Distance from the foot to the eaves [m]."""
    facade: Facade
    """Its walls."""
    tint: Colour = (1.0, 1.0, 1.0)
    """Factor on the colour of the walls."""
    roof: Literal["flat", "pyramid", "gabled", "hipped", "pyramidal", "skillion", "dome"] = "flat"
    """Shape of its roof; a `pyramid` has eaves of stone and a height of its own."""
    rise: Annotated[float, Ge(0.0)] = 0.0
    """Height of a sloping roof [m]."""
    across: bool = False
    """Whether the ridge runs across the longer side."""
    cover: Cover
    """What covers the roof."""
    parapet: bool = True
    """Whether a flat roof has a wall around it."""
    shops: bool = True
    """Whether shop windows or a lobby are at street level, if it stands there."""
    underside: bool = False
    """Whether one may see it from below."""

    @property
    def footprint(self) -> NDArray[np.float64]:
        """Its corners without those of courtyards, shape (K, 2) [m]."""
        corners: NDArray[np.float64] = shapely.get_coordinates(self.outline.exterior)[:-1]
        return corners

    @property
    def top(self) -> float:
        """Z of the eaves [m]."""
        return self.bottom + self.height


@dataclass(frozen=True, slots=True, kw_only=True)
class Building:
    """A building: one object."""

    parts: Annotated[tuple[BuildingPart, ...], Len(1)]
    """Its parts, the lowest first."""
    fittings: tuple[Literal["roof units", "tank", "fronts"], ...] = ()
    """What is on it: equipment of flat roofs, a water tank, awnings and fire escapes."""
    keep_free: Area | None = None
    """Part of its roof where something else stands."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Buildings:
    """Buildings, each an object of its own."""

    layer: Literal["buildings"] = "buildings"
    items: tuple[Building, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Backdrop:
    """Plain blocks far away, one object in all. K blocks."""

    layer: Literal["backdrop"] = "backdrop"
    outlines: tuple[Annotated[NDArray[np.float64], NumberRows(2, 4)], ...]
    """Corners of each, counter-clockwise [m]."""
    tops: Heights
    """z of their roofs [m], shape (K,)."""
    walls: tuple[Cover, ...]
    roofs: tuple[Cover, ...]
    bays: tuple[Annotated[NDArray[np.int64], NumberRows(2, 4, whole=True)], ...]
    """Window at which each of the four walls begins: its column, its row."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Things:
    """Copies of kinds of things. K copies, each an object of its own."""

    layer: Literal["things"] = "things"
    kinds: tuple[str, ...]
    """Names of kinds of the library; new ones become the scene's next fixtures, used or not."""
    kind: Numbers
    """Index into `kinds` of each, shape (K,)."""
    pose: Annotated[NDArray[np.float64], NumberRows(5)]
    """x, y, z [m], turn [rad] and scale of each, shape (K, 5). Trees are 1 m high at scale 1."""
    solid: Annotated[str, Named(_solids)] = ""
    """What of them is solid, a row of `eyas.maps.things.kinds.SOLIDS`; empty: as usual."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Paint:
    """White and yellow paint on roads."""

    rule: Literal["grid", "none"] = "grid"
    """What is painted beside the shapes given here: lines, arrows and crossings as on streets of a
    regular grid, or nothing."""
    centre: Literal["white", "double yellow"] = "white"
    """Line between the two directions of a road."""
    crossings: Natural = 1
    """One zebra crossing in so many is painted; 0: none."""
    lines: tuple[Stripe, ...] = ()
    """White lines."""
    bars: tuple[Stripe, ...] = ()
    """Yellow bars of zebra crossings."""
    shapes: tuple[Outline, ...] = ()
    """White shapes, such as the lines of parking bays."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Roadway:
    """The asphalt for traffic, with its paint."""

    layer: Literal["roadway"] = "roadway"
    area: Area
    """Asphalt [m]."""
    bays: Area | None = None
    """Light asphalt of parking bays along the streets [m]."""
    paint: Paint = field(default_factory=Paint)
    wear: Chance
    """Random numbers of tracks, patches, seals and lids."""
    apart: Positive = 1.0
    """Factor on the distances between these."""
    worn_from: Annotated[float, Ge(0.0)] = 0.0
    """Least length of lanes with wear; narrower ones than 3 m have none then [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Paved:
    """Raised pavements with kerb stones."""

    layer: Literal["paved"] = "paved"
    area: Area
    """[m]"""
    beside: Area
    """Asphalt at which the kerb stones are [m]."""
    slabs: Cover = _PAVING
    """Cover of the pavements."""
    kerb: Cover = _KERB
    """Cover of the kerb stones and of all sides."""
    kerb_width: Positive = 0.35
    """[m]"""
    turn: float = 0.0
    """Direction in which the slabs are laid [rad]."""
    z: float = KERB_HEIGHT
    """Height of their tops [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat:
    """A level piece of ground of one material."""

    form: Literal["flat"] = "flat"
    area: Area
    """[m]"""
    z: float = FLOOR_HEIGHT
    """Height [m]."""
    cover: Cover
    winter: Cover | None = None
    """What covers it in winter; None: the same."""
    turn: float = 0.0
    """Direction of its texture [rad]."""
    cells: Literal["grid", "wide", "whole"] = "grid"
    """Size of the triangles' squares: 32 m, larger ones away from streets, or not cut at all."""
    sides: Cover | None = None
    """What covers its sides; None: it has none."""
    foot: float = FLOOR_HEIGHT
    """z down to which the sides reach [m]."""
    beside: Area | None = None
    """From what a cover that changes with a distance measures it; None: from its own edge [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heap:
    """A flat heap, whose sides slope down to the ground."""

    form: Literal["heap"] = "heap"
    area: Outline
    """Outline of its top [m]."""
    z: float
    """Height of its top [m]."""
    cover: Cover


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A field with the tracks of the tractor through it."""

    form: Literal["field"] = "field"
    area: Outline
    """[m]"""
    z: float
    """Height of the crop [m]."""
    cover: Cover
    winter: Cover
    """What covers it in winter."""
    north: bool
    """Whether its rows run north, not east."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Far:
    """The land beyond the floor, up to the horizon."""

    form: Literal["far"] = "far"
    rule: Literal["plain", "fields", "city"]
    """One material, large fields, or the ground of a city."""
    covers: Annotated[tuple[Cover, ...], Len(1)]
    winter: tuple[Cover, ...] = ()
    """What covers it in winter; none: the same."""
    shares: tuple[Share, ...] = (1.0,)
    """Share of the ground that each covers."""
    beyond: tuple[Positive, Positive] | None = None
    """Extent of the ground around which it lies [m]; None: that of the floor."""
    chance: Chance | None = None
    """Random numbers of the choice of the covers."""


Piece = Annotated[
    Annotated[Flat, Tag("flat")]
    | Annotated[Heap, Tag("heap")]
    | Annotated[Field, Tag("field")]
    | Annotated[Far, Tag("far")],
    Discriminator("form"),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundCover:
    """Pieces of ground, water or paving that are one object."""

    layer: Literal["ground"] = "ground"
    kind: ClassName = ObjectClass.GROUND
    """Class of the object."""
    season: Literal["summer", "winter"] | None = None
    """The only season in which it is there; None: it always is."""
    pieces: tuple[Piece, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Deck:
    """An elevated road, and its descent beyond the floor."""

    layer: Literal["deck"] = "deck"
    middle: Path
    """Centre line [m], shape (K, 3)."""
    pillars: tuple[Pillar, ...]
    descent: Path
    """Centre line of the descent, which is not solid [m], shape (K, 3)."""
    legs: tuple[Pillar, ...]
    """Pillars of the descent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tunnels:
    """Tunnels under mounds, with lamps inside."""

    layer: Literal["tunnels"] = "tunnels"
    items: tuple[Tunnel, ...]
    outside: Cover
    inside: Cover
    chance: Chance
    """Random numbers of the lumps of the mounds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hills:
    """Rising ground, as triangles."""

    layer: Literal["hills"] = "hills"
    mounds: tuple[Mound, ...]
    """The hills."""
    flat: Area | None = None
    """Area that stays level [m]; with a survey, streets and buildings do so, too."""
    half: tuple[Positive, Positive] = (345.0, 730.0)
    """Half the side of the square with the smaller triangles, and of the whole relief [m]."""
    spacing: tuple[Positive, Positive] = (6.5, 12.5)
    """Distance of their corners inside and outside of that square [m]."""
    rough: Annotated[float, Ge(0.0)] = 0.0
    """Most by which a corner lies above or below the smooth shape, as a share of its height."""
    chance: Chance = _CORNERS
    """Random numbers of the corners."""
    covers: Annotated[tuple[Cover, ...], Len(1)] = (_LAWN,)
    """Covers from the foot up; under snow: ground, and ground with snow."""
    shades: Chance | None = None
    """Random numbers of the covers by height; None: the first everywhere, with snow in winter."""
    white: tuple[Natural, ...] = ()
    """Mounds on which snow lies in winter, indices."""
    smooth: bool = False
    """Whether light changes smoothly over the edges of triangles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Skyways:
    """Bridges for walkers between buildings, each an object of its own."""

    layer: Literal["skyways"] = "skyways"
    items: tuple[Skyway, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Railway:
    """An elevated railway with a station and two trains."""

    layer: Literal["railway"] = "railway"
    line: Viaduct


Layer = Annotated[
    Annotated[Buildings, Tag("buildings")]
    | Annotated[Backdrop, Tag("backdrop")]
    | Annotated[Things, Tag("things")]
    | Annotated[Roadway, Tag("roadway")]
    | Annotated[Paved, Tag("paved")]
    | Annotated[GroundCover, Tag("ground")]
    | Annotated[Deck, Tag("deck")]
    | Annotated[Tunnels, Tag("tunnels")]
    | Annotated[Hills, Tag("hills")]
    | Annotated[Skyways, Tag("skyways")]
    | Annotated[Railway, Tag("railway")],
    Discriminator("layer"),
]
"""Things of one sort. The layers of a plan are built in their order, which gives object ids."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LampLight:
    """Light of the street lamps."""

    axis: tuple[float, float, float] = (0.4, 0.0, -1.0)
    """Axis of the beams; x is the direction of a lamp's arm. Its length does not matter."""
    intensity: Positive = 30.0
    """As in `eyas.engine.state.scene.Lamps`."""
    cut_off: Positive = 1.4
    """Angle from the axis at which a beam ends [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Walkways:
    """Lines on which people walk, beside those along the asphalt."""

    lines: tuple[Annotated[NDArray[np.float64], NumberRows(2, 2)], ...] = ()
    """Crossings, each from kerb to kerb [m]."""
    lights: tuple[str, ...] = ()
    """Names of their lights in the network; empty where there are none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Roads:
    """The roads that SUMO makes a network of."""

    nodes: tuple[RoadNode, ...] = ()
    edges: tuple[RoadEdge, ...] = ()
    file: str = ""
    """A network file of SUMO beside the plan (`.net.xml`, `.net.xml.gz`), in place of nodes and
    edges."""
    left_hand: bool = False
    """Whether traffic keeps left; the lanes of an edge are then on the left of its line. A file
    says it itself."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapPlan:
    """Everything on a map, in the order in which it is built."""

    name: Annotated[str, StringConstraints(pattern=r"^\w+(-\w+)*$")]
    """Words joined by hyphens."""
    title: str = ""
    """Name for people, a few words."""
    attribution: str = ""
    """What must be said wherever the map, or data made from it, is shown."""
    seed: Natural = 0
    """Seed of all that is left to chance."""
    size: tuple[Positive, Positive]
    """Extent of the floor, centred on the origin [m]."""
    roads: Roads = field(default_factory=Roads)
    library: tuple[ThingKind, ...] = ()
    """Kinds of things that layers refer to."""
    chances: dict[str, Chance] = field(default_factory=dict)
    """Random numbers of the kinds' shapes, by names that kinds refer to."""
    layers: tuple[Layer, ...] = ()
    """All that stands on the map, largest occluders first."""
    lamps: LampLight = field(default_factory=LampLight)
    horizon: Horizon = field(default_factory=Horizon)
    near: Area | None = None
    """Area where `wide` ground is cut into small squares; None: up to 80 m beside streets [m]."""
    walkways: Walkways | None = None
    """Lines on which people cross streets; None: at zebra crossings."""
    survey: Survey | None = None
    """What is known of the land, from which `completed` makes the rest of the map; None: the plan
    is complete."""


def things(
    placed: Sequence[Placed],
    kinds: Sequence[str] = (),  # Names of kinds that come first, whether any is placed or not
    solid: str = "",  # See `Things.solid`
) -> Things:
    """Return the layer of things at their places."""
    names = list(dict.fromkeys([*kinds, *(one.kind for one in placed)]))
    index = {name: number for number, name in enumerate(names)}
    return Things(
        kinds=tuple(names),
        kind=np.array([index[one.kind] for one in placed], np.int64),
        pose=np.array([one[1:] for one in placed], np.float64).reshape(-1, 5),
        solid=solid,
    )
