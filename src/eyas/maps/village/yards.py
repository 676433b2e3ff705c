"""What stands about the houses of the village: bins, letter boxes, garden things."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.engine.world.build.millimetres import rounded
from eyas.engine.world.build.placed import Placed
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.cottages import Cottage
from eyas.maps.plants import gardens

__all__ = ["yard_things"]

_GARDEN = ("trampoline", "washing line", "garden pool", "logs", "cafe table 1", "cafe table 2")
_REACH = 17.0  # Largest distance of these from a wall [m]
_ROOM = 3.2  # Room that each of them needs [m]
_APART, _DENSITY = 7.0, 0.02
"""Least distance between two of them [m], and number of attempts on a square metre."""
_BESIDE_PATH = 2.6  # From the middle of the path to a house to what stands beside it [m]
_FROM_DOOR = 12.5  # From the middle of a house to its bins and its bicycles [m]


def yard_things(
    cottages: Sequence[Cottage],
    roads: shapely.Geometry,
    free: shapely.Geometry,
    rng: np.random.Generator,
) -> list[Placed]:
    """Return what stands about the houses.

    Args:
        cottages: The houses.
        roads: Asphalt [m].
        free: Where nothing else stands [m].
        rng: Random numbers of the yards.
    """
    walls = shapely.union_all([shapely.Polygon(house.outline) for house in cottages])
    made = []
    room = shapely.intersection(shapely.buffer(free, -_ROOM), shapely.buffer(walls, _REACH))
    room = shapely.difference(room, shapely.buffer(roads, _ROOM + 3.0))
    for x, y in rounded(gardens.scattered(room, _APART, _DENSITY, rng)).tolist():
        kind = _GARDEN[int(rng.integers(len(_GARDEN)))]
        made.append(Placed(kind, x, y, FLOOR_HEIGHT, float(rng.uniform(0.0, 2.0 * np.pi))))
    shapely.prepare(free)
    for house in cottages:
        front = np.array([-exact.sin(house.turn), exact.cos(house.turn)])
        aside = np.array([front[1], -front[0]]) * (1.0 if rng.random() < 0.5 else -1.0)
        gap = float(shapely.distance(roads, shapely.Polygon(house.outline)))
        spots = (
            (f"wheeled bins {int(rng.integers(2))}", _FROM_DOOR, _BESIDE_PATH),
            ("bicycle rack", _FROM_DOOR, -_BESIDE_PATH - 1.2),
            ("letter box", 10.0 + gap - 2.8, -_BESIDE_PATH),
        )
        for kind, ahead, beside in spots:
            place = rounded(house.place + ahead * front + beside * aside)
            away = float(shapely.distance(roads, shapely.Point(place)))
            if away > 2.6 and shapely.contains_xy(free, *place):
                made.append(Placed.at(kind, place, FLOOR_HEIGHT, house.turn))
    return made
