"""Things at their places, as planners list them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact


class Placed(NamedTuple):
    """A copy of a kind of thing."""

    kind: str  # Name of the kind
    x: float
    y: float
    z: float  # Height of its foot [m]
    turn: float = 0.0  # Angle, counter-clockwise about z [rad]
    scale: float = 1.0  # Factor on its size

    @classmethod
    def at(
        cls,
        kind: str,
        place: Sequence[float] | NDArray[np.float64],
        z: float,
        turn: float = 0.0,
        scale: float = 1.0,
    ) -> "Placed":
        """Return a copy at a place of 2 numbers [m]."""
        return cls(kind, float(place[0]), float(place[1]), z, turn, scale)

    def at_corners(self, corners: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
        """Return points given ahead and to the left of it, in the world, shape (K, 2) [m]."""
        ahead = np.array([exact.cos(self.turn), exact.sin(self.turn)])
        aside = np.array([-ahead[1], ahead[0]])
        moved = np.array([a * ahead + b * aside for a, b in corners])
        return np.asarray(np.array([self.x, self.y]) + moved, np.float64)
