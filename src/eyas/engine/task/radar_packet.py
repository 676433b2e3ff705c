"""The radar packet of the original as named records: the points of the lidar.

It has five numbers for each of its 400 points: x, y, z, layer, time.
"""

from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

RADAR_POINTS = 400  # Points of the original's lidar

_NUMBERS = ("x", "y", "z", "layer", "time")

RADAR_FIELDS = tuple(f"{name}_{point}" for point in range(RADAR_POINTS) for name in _NUMBERS)
"""Names of the columns of a radar packet."""


@dataclass(frozen=True, slots=True)
class RadarPoint:
    """One point, in the frame of the lidar: x forward, y left, z up."""

    x: float  # [m]; x and y are infinite where nothing was within range
    y: float  # [m]
    z: float  # [m]; 0, as all rays are in one plane. (The original tells "nan" where nothing was.)
    layer: int  # 0: the lidar has one layer
    time: float  # When it was measured, in simulated time [s]

    @property
    def distance(self) -> float:
        """Distance from the lidar [m], infinity where nothing was within range."""
        return float(exact.hypot(self.x, self.y))


@dataclass(frozen=True, slots=True)
class RadarPacket:
    """A turn of the lidar: point 0 looks back, 100 left, 200 ahead, 300 right. Those that the head
    has not passed again yet are older than others.
    """

    points: tuple[RadarPoint, ...]

    @classmethod
    def from_row(cls, row: NDArray[np.float64]) -> "RadarPacket":
        """Return the packet of a row, shape (2000,), or five numbers for each of other points."""
        table = row.reshape(-1, len(_NUMBERS)).tolist()
        return cls(tuple(RadarPoint(x, y, z, int(layer), time) for x, y, z, layer, time in table))

    def to_row(self) -> NDArray[np.float64]:
        """Return the numbers, shape (2000,)."""
        return np.array([astuple(point) for point in self.points], np.float64).ravel()
