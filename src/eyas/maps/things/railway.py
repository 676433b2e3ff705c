"""An elevated railway: girders on columns, two tracks, a station, trains that stand on it."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import TEXTURES, material
from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.scene_builder import SceneBuilder
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.build.values import Heights, Place, Unit

_UNDER = 5.5
"""z of the underside: higher than any vehicle [m]."""
_RAIL = 7.35
"""z of the rails [m]."""

_DECK_WIDTH = 9.2
"""Width of the deck with its girders [m]."""
SECTION = 12.0
"""Length of a section of the deck [m]."""
_STATION = 84.0
"""Length of the platforms [m]."""
COLUMNS = (-3.6, 3.6)
"""Places of the columns across the line [m]."""

BESIDE = 9.0
"""Distance from its middle to the walls beside it [m]."""

_PLATFORM = (3.45, 7.6)
"""Inner and outer edge of the platforms, from the middle of the line [m]."""
_STEEL = material("plain", (0.27, 0.32, 0.31))
"""What the railway is built of."""
_DARK = material("plain", (0.16, 0.19, 0.19))
"""Its railings, posts and undersides."""
_SLAB = material("concrete", (0.88, 0.87, 0.84))
"""Its platforms and the feet of its columns."""

_TOP = 8.5
"""z of the platforms: they hide the railings of the deck [m]."""
_FOOT = _UNDER + 0.3
"""z of their undersides: over those of the girders [m]."""
_TREADS, _GOING = 24, 0.48
_STAIRS = _TREADS * _GOING
"""Number and depth of the treads of stairs, and the length of a flight [m]."""
_INNER = 4.75
"""Inner edge of the stairs, beside the girders [m]."""
_CANOPY = 11.3
"""z of the upper edge of the canopies [m]."""
_OPEN = 6.0
"""Length of a platform without canopy at either end [m]."""
_WING = 1.75
"""Half the width of a canopy [m]."""
_YELLOW = material("plain", (0.88, 0.70, 0.12))
_COPPER = material("roof_membrane", (0.50, 0.74, 0.66))
_WOOD = material("plain", (0.30, 0.22, 0.16))
_GLOW = Material(tint=(1.0, 0.92, 0.76), surface=Surface.LAMP, emission=1.6)

_DECK = 7.1
"""z of the ballast [m]."""
_TRACKS = (-1.95, 1.95)
_HALF = _DECK_WIDTH / 2
_RAILING = 1.05
"""Height of the railings over the girders [m]."""

_BALLAST = material("roof_gravel", (0.50, 0.46, 0.43))
_TIE = material("plain", (0.17, 0.13, 0.11))
_IRON = material("plain", (0.42, 0.37, 0.34))
_PLANK = material("concrete", (0.66, 0.64, 0.60))

_PITCH = 15.2
"""Distance from one car of a train to the next [m]."""

_CAR = (14.6, 2.7, 3.3)
"""Length, width and height of a car [m]."""
_SILVER = material("plain", (0.72, 0.74, 0.76))
_TRAIN_ROOF = material("plain", (0.58, 0.60, 0.62))
_STRIPE = material("plain", (0.12, 0.24, 0.50))
_PANE = material("plain", (0.06, 0.08, 0.10))

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Viaduct:
    """A straight line along the avenues; places are distances along it from its first end [m]."""

    start: Place
    """Its first end, world frame [m], shape (2,)."""
    along: Unit
    """Its direction, a unit vector, shape (2,)."""
    length: float
    """Length [m]."""
    bents: Heights
    """Pairs of columns, shape (K,)."""
    over: Heights
    """Middles of the roads that it crosses, shape (C,)."""
    station: float
    """Middle of the station."""

    @property
    def turn(self) -> float:
        """Its direction [rad]."""
        return float(exact.atan2(self.along[1], self.along[0]))

    def at(self, place: float, aside: float = 0.0) -> Points:
        """Return a point of the line, or to the left of it, in whole millimetres [m]."""
        across = np.array([-self.along[1], self.along[0]])
        return rounded(self.start + place * self.along + aside * across)

    def strip(self, low: float, high: float, right: float, left: float) -> Points:
        """Return the corners of a rectangle along it, counter-clockwise [m], shape (4, 2)."""
        sides = ((low, right), (high, right), (high, left), (low, left))
        return np.array([self.at(place, aside) for place, aside in sides])

    @property
    def ground(self) -> shapely.Polygon:
        """The ground between the walls beside it [m]."""
        return shapely.Polygon(self.strip(0.0, self.length, -BESIDE, BESIDE))

    @property
    def feet(self) -> Points:
        """The columns [m], shape (2 K, 2)."""
        return np.array([self.at(b, side) for b in self.bents.tolist() for side in COLUMNS])


def add_railway(builder: SceneBuilder, line: Viaduct) -> None:
    """Add the railway with its station and two trains."""
    _add_deck(builder, line)
    _add_bents(builder, line)
    _add_station(builder, line)
    first = line.station - 2 * _PITCH
    _add_train(builder, line, first, 5, _TRACKS[0])
    _add_train(builder, line, float(line.over[-2]) - 1.5 * _PITCH, 4, _TRACKS[1])


def _add_deck(builder: SceneBuilder, line: Viaduct) -> None:
    section = builder.prototype("railway section", lambda: (_section(2), _section(1), _section(0)))
    for k in range(int(line.length // SECTION)):
        low, high = k * SECTION, (k + 1) * SECTION
        spot = (*line.at(low + SECTION / 2).tolist(), 0.0)
        owner = builder.add_copy(ObjectClass.STRUCTURE, section, spot, line.turn, 1.0)
        outline = line.strip(low, high, -_HALF, _HALF)
        builder.add_prism(outline, _UNDER, _DECK + 0.3 + _RAILING, owner)


def _section(detail: int) -> Mesh:
    """Return one section of the deck along x, its middle over the origin; 2 is the finest."""
    inner = _HALF - 0.3
    made = [box((SECTION, 0.3, 1.9), (0.0, s * (_HALF - 0.15), _UNDER + 0.95), _STEEL, 1.0)
            for s in (-1, 1)]  # fmt: skip
    made += [
        _level(-SECTION / 2, SECTION / 2, -inner, inner, _DECK, _BALLAST),
        _level(-SECTION / 2, SECTION / 2, -inner, inner, _DECK - 0.7, _DARK, down=True),
    ]
    for side in (-1, 1):
        near, far = sorted((side * (inner - 0.75), side * inner))
        made.append(_level(-SECTION / 2, SECTION / 2, near, far, _DECK + 0.16, _PLANK))
        low = (SECTION, 0.05, 0.08)
        heights = (0.5, _RAILING) if detail == 2 else (_RAILING,)
        made += [box(low, (0.0, side * (_HALF - 0.1), _DECK + 0.3 + z), _DARK, 1.0)
                 for z in heights]  # fmt: skip
    if detail:
        made += _tracks(every=0.6 if detail == 2 else 1.2)
    if detail == 2:
        for x in np.arange(-SECTION / 2 + 1.0, SECTION / 2, 2.0).tolist():
            for side in (-1, 1):
                made.append(box((0.14, 0.12, 1.9), (x, side * _HALF, _UNDER + 0.95), _STEEL, 1.0))
                post = (x, side * (_HALF - 0.1), _DECK + 0.3 + _RAILING / 2)
                made.append(box((0.06, 0.06, _RAILING), post, _DARK, 1.0))
    return concatenate(made)


def _tracks(every: float) -> list[Mesh]:
    """Return the ties and rails of both tracks in a section."""
    ties = np.arange(-SECTION / 2 + every / 2, SECTION / 2, every)
    wide = 0.22 if every < 1.0 else 0.4
    made = []
    for middle in _TRACKS:
        edge, end = np.array([-wide, wide, wide, -wide]) / 2, np.array([-1.25, -1.25, 1.25, 1.25])
        corners = np.empty((len(ties), 4, 3))
        corners[..., 0] = ties[:, None] + edge
        corners[..., 1] = middle + end
        corners[..., 2] = _DECK + 0.06
        made.append(quads(corners, np.zeros((len(corners), 4, 2)), _TIE))
        made += [box((SECTION, 0.09, 0.14), (0.0, middle + gauge, _RAIL - 0.14), _IRON, 1.0)
                 for gauge in (-0.72, 0.72)]  # fmt: skip
    return made


def _add_bents(builder: SceneBuilder, line: Viaduct) -> None:
    """Add the columns, wider crossbeams where they carry platforms."""
    plain = builder.prototype("railway columns", lambda: (_bent(_HALF, fine=True), _bent(_HALF)))
    broad = builder.prototype(
        "station columns", lambda: (_bent(_PLATFORM[1], fine=True), _bent(_PLATFORM[1]))
    )
    for place in line.bents.tolist():
        wide = abs(place - line.station) < _STATION / 2
        half = _PLATFORM[1] if wide else _HALF
        spot = (*line.at(place).tolist(), 0.0)
        kind = broad if wide else plain
        owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, line.turn, 1.0)
        for side in COLUMNS:
            builder.add_cylinder(line.at(place, side).tolist(), 0.4, FLOOR_HEIGHT, _UNDER, owner)
        builder.add_prism(line.strip(place - 0.35, place + 0.35, -half, half), 4.6, _UNDER, owner)


def _bent(half: float, *, fine: bool = False) -> Mesh:
    """Return two columns and the crossbeam that they carry, along y."""
    made = [box((0.6, 2 * half, 0.9), (0.0, 0.0, _UNDER - 0.45), _STEEL, 1.0)]
    high = _UNDER - FLOOR_HEIGHT
    for y in COLUMNS:
        made.append(box((0.5, 0.5, high), (0.0, y, FLOOR_HEIGHT + high / 2), _STEEL, 1.0))
        if fine:
            made.append(box((1.1, 1.1, 0.7), (0.0, y, FLOOR_HEIGHT + 0.35), _SLAB, 6.0))
            foot = [(0.0, y, _UNDER - 2.3), (0.0, y, _UNDER - 1.9)]
            for lean in (-1.6, 1.6):
                tip = [(0.0, y + lean, _UNDER - 0.9), (0.0, y + lean * 0.8, _UNDER - 0.9)]
                strut = np.array([foot[0], tip[0], tip[1], foot[1]])
                apart = np.array([0.1, 0.0, 0.0])
                both = np.stack([strut + apart, strut[::-1] - apart])
                made.append(quads(both, np.zeros((2, 4, 2)), _STEEL))
    return concatenate(made)


def _add_station(builder: SceneBuilder, line: Viaduct) -> None:
    """Add platforms and canopies on both sides of the tracks."""
    kind = builder.prototype("station", lambda: (_station(fine=True), _station()))
    spot = (*line.at(line.station).tolist(), 0.0)
    owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, line.turn, 1.0)
    low, high = line.station - _STATION / 2, line.station + _STATION / 2
    for side in (-1, 1):
        right, left = sorted(side * edge for edge in _PLATFORM)
        builder.add_prism(line.strip(low, high, right, left), _FOOT, _TOP, owner)
        roof = line.strip(low + _OPEN, high - _OPEN, right, left)
        builder.add_prism(roof, _CANOPY - 0.7, _CANOPY, owner)
        right, left = sorted((side * _INNER, side * _PLATFORM[1]))
        for end in (low - _STAIRS, high):
            stairs = line.strip(end, end + _STAIRS, right, left)
            builder.add_prism(stairs, FLOOR_HEIGHT, _TOP, owner)


def _level(
    west: float, east: float, south: float, north: float, z: float, cover: Material,
    *, down: bool = False,
) -> Mesh:  # fmt: skip
    """Return a level rectangle."""
    corners = np.array([(west, south, z), (east, south, z), (east, north, z), (west, north, z)])
    corners = corners[::-1] if down else corners
    return quads(corners[None], corners[None, :, :2] / TEXTURES[cover.texture], cover)


def _station(*, fine: bool = False) -> Mesh:
    """Return the station along x: its middle over the origin."""
    near, far = _PLATFORM
    half = _STATION / 2
    deep = _TOP - _FOOT
    made = []
    for side in (-1, 1):
        middle = side * (near + far) / 2
        at = (0.0, middle, _FOOT + deep / 2)
        made.append(box((_STATION, far - near, deep), at, _SLAB, TEXTURES["concrete"]))
        edge = sorted((side * near, side * (near + 0.4)))
        made.append(_level(-half, half, edge[0], edge[1], _TOP + 0.01, _YELLOW))
        made += _canopy(middle, half - _OPEN)
        made += [_stairs(end, side * (_INNER + far) / 2, far - _INNER) for end in (-half, half)]
        fence = (0.0, side * (far - 0.06), _TOP + 0.6)
        made.append(box((_STATION, 0.06, 1.2), fence, _STEEL, 1.0))
        if fine:
            for x in np.arange(-half + 9.0, half - 6.0, 6.0).tolist():
                post = (x, middle, (_TOP + _CANOPY - 0.5) / 2)
                made.append(box((0.18, 0.18, _CANOPY - 0.5 - _TOP), post, _DARK, 1.0))
                made.append(box((1.6, 0.3, 0.08), (x + 3.0, middle, _CANOPY - 0.75), _GLOW, 1.0))
            made += [
                box((1.8, 0.5, 0.5), (x, middle, _TOP + 0.25), _WOOD, 1.0)
                for x in np.arange(-half + 12.0, half - 12.0, 12.0).tolist()
            ]
    return concatenate(made)


def _stairs(end: float, middle: float, width: float) -> Mesh:
    """Return the stairs from one end of a platform down to the ground, with solid sides."""
    out = float(np.sign(end))
    rise = (_TOP - FLOOR_HEIGHT) / _TREADS
    made = []
    for k in range(_TREADS):
        top = _TOP - (k + 0.5) * rise
        at = (end + out * (k + 0.5) * _GOING, middle, top - 0.4)
        made.append(box((_GOING, width - 0.5, 0.8), at, _SLAB, 6.0))
    for y in (middle - width / 2 + 0.15, middle + width / 2 - 0.15):
        ends = ((end, _TOP), (end + out * _STAIRS, FLOOR_HEIGHT))
        side = np.array([(x, y, z + high) for (x, z), high in zip(
            (*ends, *ends[::-1]), (-0.9, -0.1, 1.1, 1.1), strict=True)])  # fmt: skip
        apart = np.array([0.0, 0.05, 0.0])
        faces = np.stack([side - out * apart, side[::-1] + out * apart])
        made.append(quads(faces, np.zeros((2, 4, 2)), _STEEL))
    return concatenate(made)


def _canopy(middle: float, half: float) -> list[Mesh]:
    """Return a roof of two slopes that fall to its middle, seamed by ribs."""
    made = []
    for side in (-1, 1):
        outer, inner = middle + side * _WING, middle
        top, low = _CANOPY, _CANOPY - 0.35
        slope = np.array([(-half, inner, low), (half, inner, low),
                          (half, outer, top), (-half, outer, top)])  # fmt: skip
        slope = slope if side > 0 else slope[::-1]
        flat = slope[:, :2] / TEXTURES[_COPPER.texture]
        made += [quads(slope[None], flat[None], _COPPER)]
        under = slope[::-1] - [0.0, 0.0, 0.12]
        made.append(quads(under[None], np.zeros((1, 4, 2)), _DARK))
        made.append(box((2 * half, 0.08, 0.3), (0.0, outer, top - 0.1), _STEEL, 1.0))
    return made


def _add_train(builder: SceneBuilder, line: Viaduct, first: float, cars: int, track: float) -> None:
    """Add a train of some cars; `first` is the middle of the first [m]."""
    kind = builder.prototype("railway car", lambda: (_car(fine=True), _car()))
    owner = None
    for k in range(cars):
        place = first + k * _PITCH
        spot = (*line.at(place, track).tolist(), _RAIL)
        owner = builder.add_copy(ObjectClass.TRAIN, kind, spot, line.turn, 1.0, owner)
    long, wide, high = _CAR
    ends = (first - long / 2, first + (cars - 1) * _PITCH + long / 2)
    outline = line.strip(*ends, track - wide / 2, track + wide / 2)
    assert owner is not None  # there are cars
    builder.add_prism(outline, _RAIL, _RAIL + high + 0.35, owner)


def _car(*, fine: bool = False) -> Mesh:
    """Return a car of a train along x, on rails at z = 0."""
    long, wide, high = _CAR
    low = 0.85
    made = [
        box((long, wide, high - low - 0.25), (0.0, 0.0, (low + high - 0.25) / 2), _SILVER, 1.0),
        box((long - 0.3, wide - 0.5, 0.3), (0.0, 0.0, high - 0.1), _TRAIN_ROOF, 1.0),
        box((long - 3.0, wide - 0.6, low), (0.0, 0.0, low / 2), _DARK, 1.0),
        box((long + 0.02, wide + 0.02, 0.22), (0.0, 0.0, low + 0.35), _STRIPE, 1.0),
        box((long - 1.2, wide + 0.03, 0.85), (0.0, 0.0, low + 1.25), _PANE, 1.0),
        box((long + 0.04, wide - 0.7, 0.9), (0.0, 0.0, low + 1.3), _PANE, 1.0),
        box((2.6, 1.3, 0.3), (-0.27 * long, 0.0, high + 0.18), _TRAIN_ROOF, 1.0),
        box((2.6, 1.3, 0.3), (0.27 * long, 0.0, high + 0.18), _TRAIN_ROOF, 1.0),
    ]
    if fine:
        made += [
            box((1.25, wide + 0.05, 1.95), (x, 0.0, low + 1.0), _SILVER, 1.0)
            for x in (-0.36 * long, -0.12 * long, 0.12 * long, 0.36 * long)
        ]
        made += [
            box((0.45, wide + 0.07, 0.8), (x + lean, 0.0, low + 1.25), _PANE, 1.0)
            for x in (-0.36 * long, -0.12 * long, 0.12 * long, 0.36 * long)
            for lean in (-0.3, 0.3)
        ]
    return concatenate(made)
