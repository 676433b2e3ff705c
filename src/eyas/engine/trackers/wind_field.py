"""The mean wind among buildings: a table of what it is, for a wind of 1 m/s from each side."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.elementary import atan2

Vector = tuple[float, float, float]

UNIT = 0.001  # Unit of the numbers of a table [m/s]


class WindField(NamedTuple):
    """The mean wind over a map, on a grid."""

    table: NDArray[np.int16]
    """Velocity in a wind of 1 m/s, towards east, north and up [mm/s], of D directions towards which
    it blows, counter-clockwise from east, shape (D, levels, rows, columns, 3)."""
    west: float  # East coordinate of the middle of the first column [m]
    south: float  # North coordinate of the middle of the first row [m]
    spacing: float
    """Between columns, between rows, and between levels, of which the first is half of it over the
    ground [m]."""
    known: int  # 0: there is none, the wind is the same everywhere


OPEN = WindField(np.zeros((1, 1, 1, 1, 3), np.int16), 0.0, 0.0, 1.0, 0)
"""No field: a wind that nothing stands in."""


@kernel
def wind_among(
    field: WindField,
    east: float,  # Direction towards which the wind blows, cosine from east
    north: float,  # Its sine
    x: float,  # East coordinate [m]
    y: float,  # North coordinate [m]
    height: float,  # Over the ground [m]
) -> Vector:
    """Return the mean wind at a place in a wind of 1 m/s [m/s].

    Between the points of the grid it changes evenly; beyond them it is that of the nearest.
    """
    directions, levels, rows, columns, _ = field.table.shape
    turn = atan2(north, east) * (0.5 / math.pi) * directions
    before = math.floor(turn)
    first, share = int(before) % directions, turn - before
    column, right = _between((x - field.west) / field.spacing, columns)
    row, ahead = _between((y - field.south) / field.spacing, rows)
    level, above = _between(height / field.spacing - 0.5, levels)
    sum_x = sum_y = sum_z = 0.0
    for corner in range(16):
        weight = share if corner & 8 else 1.0 - share
        weight *= right if corner & 1 else 1.0 - right
        weight *= ahead if corner & 2 else 1.0 - ahead
        weight *= above if corner & 4 else 1.0 - above
        direction = (first + (corner >> 3)) % directions
        at = field.table[
            direction,
            min(level + ((corner >> 2) & 1), levels - 1),
            min(row + ((corner >> 1) & 1), rows - 1),
            min(column + (corner & 1), columns - 1),
        ]
        sum_x += weight * at[0]
        sum_y += weight * at[1]
        sum_z += weight * at[2]
    return UNIT * sum_x, UNIT * sum_y, UNIT * sum_z


@kernel
def _between(place: float, count: int) -> tuple[int, float]:
    """Return the point of a grid before a place, and how far it is from it to the next."""
    held = min(max(place, 0.0), count - 1.0)
    before = math.floor(held)
    return int(before), held - before
