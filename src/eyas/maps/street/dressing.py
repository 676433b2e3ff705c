"""Where the clutter of streets is: along kerbs, before shops and houses, in gardens.

What is higher than a foot keeps out of the two lanes in which people walk along a kerb
(`eyas.engine.behaviours.pavements.LANES`), and nothing of it is high or near enough to a lane to
hide who drives there.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import length, rounded, unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import streets
from eyas.lanes import exact

_CLEAR: Final = 0.3  # Room between two things [m]

_FROM_WALL: Final = 0.75
"""Distance from a wall to the middle of what stands before it, besides half its depth [m]."""

_FROM_CORNER: Final = 2.0  # Least distance from the corner of a house [m]

Points = NDArray[np.float64]


class DressedGround(NamedTuple):
    """Area on which things may stand, and its height."""

    area: shapely.Geometry  # In plan view [m]
    height: float  # z [m]


@dataclass(frozen=True, slots=True)
class _Rule:
    """Spacing of things along kerbs or walls; which of several is drawn for each place."""

    kinds: tuple[str, ...]
    where: str  # Name of the ground on which they stand
    beyond: float  # From the kerb, or from the wall, to the middle [m]; negative on the road
    every: float  # Mean distance to the next [m]
    room: float  # Radius of the space that each needs [m]
    from_end: float = 6.0  # Least distance to the end of the street [m]
    row: tuple[int, int] = (1, 1)
    """Least and largest number of the same kind that stand side by side."""


_DRAINS = _Rule(("drain",), "road", -0.17, 44.0, 0.1)
_LEAVES = _Rule(("fallen leaves 0", "fallen leaves 1"), "road", -0.4, 55.0, 0.1, 8.0)
_LITTER = ("litter 0", "litter 1", "litter 2")
_PLANTERS = ("planter 0", "planter 1", "planter 2")
_BINS = ("wheeled bins 0", "wheeled bins 1")
_SIGNS = ("road sign 0", "road sign 1")

CITY_KERBS: Final = (
    _DRAINS,
    _LEAVES,
    _Rule(_LITTER, "pavement", 1.4, 34.0, 0.0),
    _Rule(_SIGNS, "pavement", 0.3, 62.0, 0.3),
    _Rule(("bicycle rack",), "behind", 3.6, 190.0, 1.7, 10.0),
    _Rule(("cabinet",), "behind", 3.0, 170.0, 0.7),
    _Rule(_PLANTERS, "behind", 2.95, 150.0, 0.9),
    _Rule(("rubbish",), "behind", 3.2, 260.0, 0.8),
    _Rule(_BINS, "behind", 3.1, 220.0, 0.8),
)
"""Along the kerbs of cities; behind the pavement is lawn, or more pavement."""

TOWN_KERBS: Final = CITY_KERBS[:4]
"""Along the kerbs of towns of which only some is known: drains, leaves, litter, signs."""

VILLAGE_KERBS: Final = (
    _DRAINS,
    _LEAVES,
    _Rule(_SIGNS, "verge", 0.3, 150.0, 0.3, 12.0),
    _Rule(("bus stop",), "verge", 0.3, 330.0, 0.3, 20.0),
    _Rule(_LITTER, "verge", 0.9, 90.0, 0.0),
)
"""Along the roads of villages."""

SHOP_FRONTS: Final = (
    _Rule(tuple(f"cafe table {k}" for k in range(4)), "front", 0.75, 125.0, 1.2, row=(2, 5)),
    _Rule(("bicycle rack",), "front", 0.4, 240.0, 1.3, row=(1, 2)),
    _Rule(("crates",), "front", 0.0, 260.0, 1.2, row=(1, 3)),
    _Rule(_PLANTERS, "front", -0.2, 220.0, 0.9, row=(1, 4)),
    _Rule(_BINS, "front", 0.0, 300.0, 0.75, row=(1, 3)),
    _Rule(("rubbish",), "front", 0.0, 260.0, 0.8),
    _Rule(("shop board",), "front", 0.6, 70.0, 0.45),
)
"""Before the walls of houses in cities."""


class _Standing:
    """What stands already, of which the next keeps clear."""

    def __init__(self) -> None:
        self._taken = np.zeros((0, 3))

    def fits(self, place: Points, room: float) -> bool:
        """Take a place if it is free."""
        away = exact.hypot(*(self._taken[:, :2] - place).T) - self._taken[:, 2]
        free = room == 0.0 or bool(away.min(initial=np.inf) > room + _CLEAR)
        if free and room:
            self._taken = np.concatenate([self._taken, [[*place, room]]])
        return free


def along_kerbs(
    network: RoadNetwork,
    grounds: Mapping[
        str, DressedGround
    ],  # Where things may stand, by the names in the rules; prepared
    rules: Sequence[_Rule],  # What stands there, the largest first
    rng: np.random.Generator,
    apart: float = 1.0,  # Factor on the distances between things of a rule
) -> list[Placed]:
    """Return things along the kerbs of all streets."""
    standing, made = _Standing(), []
    for rule in rules:
        ground = grounds[rule.where]
        for street in streets(network):
            kerb = shapely.LineString(street.right)
            for along in _spread(kerb.length, rule, rng, apart, rule.from_end):
                pair = (kerb.interpolate(s) for s in (along, along + 0.1))
                here, there = (shapely.get_coordinates(point)[0] for point in pair)
                onwards = unit(there - here)
                inwards = street.inwards(onwards)
                place = here - rule.beyond * inwards
                made += _row(rule, place, inwards, ground, standing, rng)
    return made


def at_fronts(
    footprints: Sequence[Points],  # Corners of the houses, counter-clockwise [m]
    ground: DressedGround,  # Where things may stand; prepared
    rules: Sequence[_Rule],  # What stands there, the largest first
    rng: np.random.Generator,
    apart: float = 1.0,  # Factor on the distances between things of a rule
) -> list[Placed]:
    """Return things before the walls of houses, with their backs to them."""
    standing, made = _Standing(), []
    for rule in rules:
        for corners in footprints:
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                onwards, long = unit(end - start), length(end - start)
                outwards = np.array([onwards[1], -onwards[0]])
                for along in _spread(long, rule, rng, apart, _FROM_CORNER):
                    away = _FROM_WALL + rule.beyond
                    place = start + along * onwards + away * outwards
                    made += _row(rule, place, outwards, ground, standing, rng)
    return made


def _spread(
    long: float, rule: _Rule, rng: np.random.Generator, apart: float, low: float
) -> list[float]:
    """Return positions along a line of a length, at least `low` from its ends [m]."""
    count = rng.poisson(max(long - 2.0 * low, 0.0) / (apart * rule.every))
    return sorted(rng.uniform(low, max(long - low, low), count).tolist())


def _row(
    rule: _Rule,
    place: Points,
    facing: Points,
    ground: DressedGround,
    standing: _Standing,
    rng: np.random.Generator,
) -> list[Placed]:
    """Return things from a place on, side by side, that face a direction, where there is room."""
    kind = rule.kinds[int(rng.integers(len(rule.kinds)))]
    turn = float(exact.atan2(facing[1], facing[0]) - np.pi / 2)
    aside, made = np.array([-facing[1], facing[0]]), []
    for number in range(int(rng.integers(*rule.row, endpoint=True))):
        spot = rounded(place + number * (2.0 * rule.room + _CLEAR + 0.01) * aside)
        around = spot + 0.5 * rule.room * np.array([aside, -aside])
        if shapely.contains_xy(ground.area, around).all() and standing.fits(spot, rule.room):
            made.append(Placed.at(kind, spot, ground.height, turn))
    return made
