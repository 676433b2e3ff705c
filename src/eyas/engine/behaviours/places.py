"""Where things are put: beside the roads, on free ground."""

from typing import Final, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.behaviours.obstacles import GroundObstacles
from eyas.engine.core.errors import SpawnError
from eyas.engine.core.variation import Variation, bounds, sample
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import Street, streets
from eyas.lanes import exact

_ROUNDS: Final = 200  # How often places are sampled for those that have none yet

_PATIENT: Final = 10
"""Rounds with the offset that is asked for; then it grows, by up to `_WIDER` more each round."""

_WIDER: Final = 0.3  # [m]

_HOPELESS: Final = 40  # Rounds without a single place after which there is none

_APART: Final = 0.3  # Free ground around each [m]

Floats = NDArray[np.float64]


class _Middle(NamedTuple):
    """Points on the middles of roads, shape (K, 2) each."""

    point: Floats  # [m]
    left: Floats  # Unit vectors across the road


class Roadside:
    """Draws places at an offset from the middle of a random road.

    As in the original, all roads are equally likely, whatever their lengths; unlike there, the
    offset is perpendicular to the road, and the middle follows its bends.

    Args:
        network: The roads.
        obstacles: What stands in the way.
    """

    def __init__(self, network: RoadNetwork, obstacles: GroundObstacles) -> None:
        self._lines = [_line(street) for street in streets(network)]
        self._obstacles = obstacles

    def sample(
        self,
        count: int,  # How many
        offset: Variation,  # To the left of the middle of the road [m]
        radius: float,  # Distance to obstacles [m]
        rng: np.random.Generator,  # Random numbers
        what: str,  # Setting that asks for them, for the message
    ) -> Floats:
        """Return free places [m], shape (count, 2).

        Where there is nothing free at the offset, places are sought ever farther from it.

        Raises:
            SpawnError: The map has no room.
        """
        places, open_ = np.zeros((count, 2)), np.arange(count)
        for round_ in range(_ROUNDS):
            hopeless = round_ == _HOPELESS and len(open_) == count
            if not len(open_) or not self._lines or hopeless:
                break
            middle = self._middles(len(open_), rng)
            aside = np.array([sample(offset, rng) for _ in open_])
            aside += rng.uniform(-1.0, 1.0, len(open_)) * _WIDER * max(round_ - _PATIENT, 0)
            sampled = middle.point + aside[:, None] * middle.left
            free = ~self._obstacles.blocked(shapely.points(sampled), radius + _APART)
            places[open_[free]] = sampled[free]
            open_ = open_[~free]
        if len(open_):
            least, most = (f"{end:g}" for end in bounds(offset))
            raise SpawnError(
                f"{what}: beside the roads, {least if least == most else f'{least} to {most}'} m "
                f"from their middle, the map has only {count - len(open_)} of the {count} places "
                "that are needed one after the other; allowed: fewer, or a smaller offset"
            )
        return places

    def _middles(self, count: int, rng: np.random.Generator) -> _Middle:
        road = rng.integers(len(self._lines), size=count)
        lines = np.array(self._lines, object)[road]
        length = shapely.length(lines)
        along = rng.uniform(0.0, 1.0, count) * length
        before, after = np.maximum(along - 0.5, 0.0), np.minimum(along + 0.5, length)
        here, low, high = (
            shapely.get_coordinates(shapely.line_interpolate_point(lines, way))
            for way in (along, before, after)
        )
        onwards = high - low
        onwards /= np.maximum(exact.hypot(onwards[:, 0], onwards[:, 1]), 1e-9)[:, None]
        return _Middle(here, np.column_stack([-onwards[:, 1], onwards[:, 0]]))


def _line(street: Street) -> shapely.LineString:
    return shapely.LineString(street.left)
