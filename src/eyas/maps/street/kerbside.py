"""Parking bays along kerbs, and the cars in them."""

from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.ops import substring

from eyas.engine.world.build.millimetres import rounded, unit
from eyas.lanes import exact

BAY_DEPTH: Final = 2.3  # Depth of a bay [m]
BAY_LENGTH: Final = 6.1  # Length of a bay along the kerb [m]
_BETWEEN = 11.0  # From one row of bays to the next; the pavement reaches out to the kerb there [m]
_IN_USE = 0.86  # Share of the rows that are made
_OCCUPIED = 0.82  # Share of the bays with a car

Points = NDArray[np.float64]


def rows_along(
    kerb: shapely.LineString,  # [m]
    span: tuple[float, float],  # Part of the kerb with bays [m]
    bays: tuple[int, int],  # Least number of bays in a row, and above the largest
    rng: np.random.Generator,
) -> list[shapely.LineString]:
    """Return the kerb along each row of bays."""
    made: list[shapely.LineString] = []
    at = span[0] + float(rng.uniform(0.0, 6.0))
    while True:
        length = BAY_LENGTH * int(rng.integers(*bays))
        if at + length > span[1]:
            return made
        if rng.random() < _IN_USE:
            made.append(substring(kerb, at, at + length))
        at += length + _BETWEEN


def lines_between(row: shapely.LineString, side: float, count: int) -> list[shapely.Polygon]:
    """Return the paint at both ends of each of some bays of a row [m]; `side` as of a `Street`."""
    made = []
    for k in range(count + 1):
        at = float(np.clip(k * BAY_LENGTH, 0.05, row.length - 0.05))
        made.append(beside(row, side, (0.0, BAY_DEPTH - 0.1), at - 0.05, at + 0.05))
    return made


def cars_in(
    row: shapely.LineString, side: float, count: int, rng: np.random.Generator
) -> list[list[float]]:
    """Return the cars in a row of bays, which face as the traffic beside them, some askew.

    Each is its middle [m] and heading [rad].
    """
    start, end = shapely.get_coordinates(row)[[0, -1]]
    along = unit(end - start)
    across = side * np.array([along[1], -along[0]])
    heading = float(exact.atan2(along[1], along[0]))
    cars = []
    for k in range(count):
        here = rng.random() < _OCCUPIED
        shift = (k + 0.5) * BAY_LENGTH + rng.uniform(-0.35, 0.35)
        place = start + shift * along + (1.18 + rng.uniform(-0.1, 0.1)) * across
        turn = heading + rng.uniform(-0.055, 0.055)
        if here:
            cars.append([*rounded(place), float(turn)])
    return cars


def beside(
    row: shapely.LineString,
    side: float,
    depth: tuple[float, float],  # From the kerb [m]
    low: float,
    high: float,
) -> shapely.Polygon:
    """Return a rectangle beyond a straight kerb from `low` to `high`, counter-clockwise [m]."""
    start, end = shapely.get_coordinates(row)[[0, -1]]
    along = unit(end - start)
    across = side * np.array([along[1], -along[0]])
    near, far = depth
    corners = [(low, near), (low, far), (high, far), (high, near)][:: int(side)]
    return shapely.Polygon([rounded(start + x * along + y * across) for x, y in corners])
