"""Positions of street furniture: on the pavements beside kerbs, never on a road."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import unit
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import streets
from eyas.lanes import exact

__all__ = ["furniture_along"]

_CLEAR = 0.5  # Room around each thing [m]


@dataclass(frozen=True, slots=True)
class _Rule:
    """Spacing of one kind of furniture along a kerb."""

    beyond_kerb: float  # From the kerb to its centre [m]
    every: float  # Mean distance to the next [m]
    room: float  # Radius of the space that it needs [m]
    from_end: float  # Least distance to the end of the street [m]


_RULES = {
    "shelter": _Rule(1.75, 190.0, 2.4, 24.0),
    "bench": _Rule(2.05, 42.0, 1.1, 9.0),
    "tub": _Rule(2.0, 60.0, 0.8, 9.0),
    "post_box": _Rule(0.75, 170.0, 0.5, 8.0),
    "bin": _Rule(0.65, 55.0, 0.4, 6.0),
    "hydrant": _Rule(0.6, 85.0, 0.4, 6.0),
}
"""The kinds of furniture, the largest first, because small ones find room more easily."""


def furniture_along(
    network: RoadNetwork,
    pavement: shapely.Geometry,
    keep_free: shapely.Geometry,
    height: float,
    rng: np.random.Generator,
) -> list[Placed]:
    """Return what furnishes the pavements beside kerbs.

    Args:
        pavement: Area where furniture may stand [m].
        keep_free: Area where something else stands, people walk or cars drive [m].
        height: z of the pavement [m].
    """
    room = shapely.difference(pavement, shapely.buffer(keep_free, _CLEAR))
    shapely.prepare(room)
    taken, made = np.zeros((0, 3)), []
    for kind, rule in _RULES.items():
        for place, turn in _places(network, rule, rng):
            apart = np.linalg.norm(taken[:, :2] - place, axis=1) - taken[:, 2]
            # Legs may reach over the back edge of the pavement, on to the lawn.
            if apart.min(initial=np.inf) > rule.room and shapely.contains_xy(room, *place):
                taken = np.concatenate([taken, [[*place, rule.room + _CLEAR]]])
                made.append(Placed(kind, float(place[0]), float(place[1]), height, turn))
    return made


def _places(
    network: RoadNetwork, rule: _Rule, rng: np.random.Generator
) -> list[tuple[NDArray[np.float64], float]]:
    """Return positions beside all kerbs [m], and angles that make y face the road [rad]."""
    made = []
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        low, high = rule.from_end, kerb.length - rule.from_end
        count = rng.poisson(max(high - low, 0.0) / rule.every)
        for along in np.sort(rng.uniform(low, max(high, low), count)):
            here, there = (
                shapely.get_coordinates(kerb.interpolate(s))[0] for s in (along, along + 0.1)
            )
            onwards = unit(there - here)
            leftwards = np.array([-onwards[1], onwards[0]])
            turn = float(exact.atan2(leftwards[1], leftwards[0]) - np.pi / 2)
            made.append((here - rule.beyond_kerb * leftwards, turn))
    return made
