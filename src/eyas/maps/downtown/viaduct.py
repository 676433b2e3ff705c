"""Where the elevated railway runs: through the middle of a column of blocks, over every street."""

from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import road_area
from eyas.lanes import exact
from eyas.maps.downtown.lots import Box, Lot
from eyas.maps.downtown.roads import Grid
from eyas.maps.things.railway import BESIDE, SECTION, Viaduct

__all__ = ["cut", "make_viaduct"]

_COLUMN = 4  # The column of blocks in whose middle it runs
_STOP = 4  # The street over which the station lies
_REACH = 1248.0  # From the middle of the floor to either end, beyond its edges [m]
_BESIDE_ROAD = 3.2  # From a kerb to the columns beside it: behind parked cars [m]
_BETWEEN = 15.0  # Greatest distance between columns off the roads [m]
_NARROWEST = 8.0  # Narrower rests of lots that it cuts stay empty [m]

Points = NDArray[np.float64]


def make_viaduct(network: RoadNetwork, grid: Grid) -> Viaduct:
    """Return the railway of a city.

    Args:
        network: The roads.
        grid: Their grid.
    """
    u = _middle(grid)
    start, end = grid.world(np.array([[u, -_REACH], [u, _REACH]]))
    line = shapely.LineString([start, end])
    length = 2 * _REACH
    crossed = shapely.get_parts(shapely.intersection(line, road_area(network)))
    origin = shapely.Point(start)
    ends = np.sort([[shapely.distance(origin, shapely.Point(p)) for p in part.coords]
                    for part in crossed], axis=1)  # fmt: skip
    ends = np.round(ends[np.argsort(ends[:, 0], kind="stable")], 3)
    beside = (ends + np.array([-_BESIDE_ROAD, _BESIDE_ROAD])).ravel()
    stops = [SECTION / 2, *beside.tolist(), length - SECTION / 2]
    bents = [stops[0]]
    for k, (low, high) in enumerate(pairwise(stops)):
        parts = 1 if k % 2 else max(int(np.ceil((high - low) / _BETWEEN)), 1)
        bents += np.round(np.linspace(low, high, parts + 1)[1:], 3).tolist()
    over = ends.mean(axis=1)
    return Viaduct(
        start=start,
        along=np.array([-exact.sin(grid.turn), exact.cos(grid.turn)]),
        length=length,
        bents=np.array(bents),
        over=over,
        station=float(over[_STOP]),
    )


def _middle(grid: Grid) -> float:
    return round((grid.avenues[_COLUMN] + grid.avenues[_COLUMN + 1]) / 2, 3)


def cut(lots: list[Lot], grid: Grid) -> list[Lot]:
    """Return lots without the ground of the railway: what it crosses becomes two lots or one."""
    low, high = _middle(grid) - BESIDE, _middle(grid) + BESIDE
    made: list[Lot] = []
    for lot in lots:
        west, south, east, north = lot.box
        if east <= low or west >= high:
            made.append(lot)
            continue
        rests: list[Box] = [(west, south, low, north), (high, south, east, north)]
        made += [Lot(box, lot.through, lot.rear) for box in rests if box[2] - box[0] >= _NARROWEST]
    return made
