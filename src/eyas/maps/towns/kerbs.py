"""Parking bays along the kerbs of a town, where there is room for them and a pavement."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import polygons_of, streets
from eyas.maps.street.kerbside import (
    BAY_DEPTH,
    BAY_LENGTH,
    beside,
    cars_in,
    lines_between,
    rows_along,
)

_FROM_END: Final = 9.0  # Distance from the end of a street to the nearest bay [m]
_BAYS: Final = (2, 8)  # Least number of bays in a row, and above the largest
_WALK: Final = 2.0  # Width of the pavement behind bays [m]
_LEAST: Final = 1.7  # Least distance from bays with a pavement behind them to walls [m]
_BEHIND: Final = 0.5  # The same without a pavement [m]
_BENT: Final = 0.08  # Most by which a kerb may leave the edge of a bay [m]
_KERB: Final = 0.3  # Distance from the lanes to what must be beside them at a bay [m]


@dataclass(frozen=True, slots=True)
class Kerbside:
    """Parking along the kerbs."""

    bays: shapely.Geometry  # [m]
    walks: shapely.Geometry  # Pavements behind them [m]
    lines: list[shapely.Polygon]  # Paint between them [m]
    cars: NDArray[np.float64]  # Middle of each car [m] and its heading [rad], shape (K, 3)


def kerbside(
    network: RoadNetwork,
    parking: Mapping[str, Sequence[tuple[float, float]]],  # Of each edge: from and to [m]
    roads: shapely.Geometry,  # Asphalt [m]
    pavement: shapely.Geometry,  # Raised pavements [m]
    kept: shapely.Geometry,  # What no bay and no pavement behind it may touch [m]
    extent: shapely.Polygon,  # The floor [m]
    rng: np.random.Generator,
) -> Kerbside:
    """Return the bays along kerbs, and the cars in them."""
    bays, walks, lines = [], [], list[shapely.Polygon]()
    cars = list[list[float]]()
    inside = shapely.buffer(extent, -BAY_DEPTH - _WALK)
    # Other streets, and wider parts of the same one.
    asphalt = shapely.buffer(roads, -_KERB)
    for area in (asphalt, pavement, kept, inside):
        shapely.prepare(area)

    def is_walked(bay: shapely.LineString, side: float) -> bool:
        middle = beside(bay, side, (0.2, 1.5), 0.0, bay.length).centroid
        return bool(shapely.intersects(pavement, middle))

    def fits(bay: shapely.LineString, side: float) -> bool:
        room = BAY_DEPTH + (_LEAST if is_walked(bay, side) else _BEHIND)
        whole = beside(bay, side, (0.0, room), 0.0, bay.length)
        free = not shapely.intersects(kept, whole) and not shapely.intersects(asphalt, whole)
        return free and bool(shapely.contains(inside, whole)) and _is_straight(bay)

    for name, street in zip(network.edges, streets(network), strict=True):
        if name not in parking or len(street.right) < 2:
            continue
        kerb, side = shapely.LineString(street.right), street.side
        for low, high in parking[name]:
            span = max(low, _FROM_END), min(high, kerb.length - _FROM_END)
            for row in rows_along(kerb, span, _BAYS, rng):
                for part, count in _parts(row, partial(fits, side=side)):
                    bays.append(beside(part, side, (-_KERB, BAY_DEPTH), 0.0, part.length))
                    lines += lines_between(part, side, count)
                    cars += cars_in(part, side, count, rng)
                    if is_walked(part, side):
                        depth = BAY_DEPTH, BAY_DEPTH + _WALK
                        walks.append(beside(part, side, depth, -_WALK, part.length + _WALK))
    area = shapely.difference(shapely.union_all(bays), roads)
    behind = shapely.difference(shapely.union_all(walks), kept)
    return Kerbside(
        bays=shapely.MultiPolygon(polygons_of(snapped(area))),
        walks=behind,
        lines=lines,
        cars=np.array(cars, np.float64).reshape(-1, 3),
    )


def _parts(
    row: shapely.LineString, fits: Callable[[shapely.LineString], bool]
) -> Iterator[tuple[shapely.LineString, int]]:
    """Yield the straight parts of a row whose bays have room, and the number of their bays."""
    count = round(row.length / BAY_LENGTH)
    first = None
    for k in range(count + 1):
        begin = (first if first is not None else k) * BAY_LENGTH
        end = min((k + 1) * BAY_LENGTH, row.length)
        here = k < count and fits(substring(row, k * BAY_LENGTH, end))
        straight = here and _is_straight(substring(row, begin, end))
        if first is not None and not straight:
            yield substring(row, first * BAY_LENGTH, k * BAY_LENGTH), k - first
            first = None
        if here and first is None:
            first = k


def _is_straight(line: shapely.LineString) -> bool:
    points = shapely.get_coordinates(line)
    chord = shapely.LineString(points[[0, -1]])
    return bool((shapely.distance(chord, shapely.points(points)) < _BENT).all())
