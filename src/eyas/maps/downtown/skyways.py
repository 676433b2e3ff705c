"""Bridges for walkers between the upper floors of buildings that face each other over a street."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.lanes import exact
from eyas.maps.downtown.lots import Box, Lot
from eyas.maps.downtown.massing import STOREY
from eyas.maps.downtown.roads import Grid
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.things.skyways import FLOORS_UNDER, Skyway

__all__ = ["make_skyways"]

_COUNT = 46  # Number of skyways, if there are so many places
_APART = 44.0  # Least distance between two [m]
_WIDEST_STREET = 32.0  # Fronts farther apart than this are not joined [m]
_FROM_CORNER = 5.0  # From the corners of blocks to the side of a skyway [m]
_STEP = 3.0  # Distance between the places tried along a street [m]

Points = NDArray[np.float64]
_Gap = tuple[Box, int, int, bool]
"""Ground between two fronts, the numbers of their lots, and whether the fronts lie north and
south."""


def make_skyways(
    grid: Grid,
    lots: list[Lot],
    buildings: list[list[BuildingPart]],
    roads: shapely.Geometry,
    keep_free: shapely.Geometry,
    rng: np.random.Generator,
) -> list[Skyway]:
    """Return skyways between fronts that are high enough on both sides.

    Args:
        grid: The grid of the streets.
        lots: The lots.
        buildings: The parts of the building on each of them.
        roads: Asphalt of the streets [m].
        keep_free: Ground of trees, poles and the railway [m].
        rng: Random numbers of the skyways.
    """
    high = [parts[0].height >= STOREY * (FLOORS_UNDER + 2) for parts in buildings]
    shapely.prepare(keep_free)
    shapely.prepare(roads)
    made: list[Skyway] = []
    taken: list[Points] = []
    for place, width, gap in _places(lots, high, rng):
        skyway = _skyway(grid, place, width, gap, buildings, rng)
        middle = (skyway.start + skyway.end) / 2
        near = min((float(exact.hypot(*(middle - other))) for other in taken), default=np.inf)
        free = not keep_free.intersects(shapely.Polygon(skyway.outline()))
        # Elsewhere a yard lies between the two.
        if near > _APART and free and shapely.contains_xy(roads, *middle):
            made.append(skyway)
            taken.append(middle)
        if len(made) == _COUNT:
            break
    return made


def _places(
    lots: list[Lot], high: list[bool], rng: np.random.Generator
) -> list[tuple[float, float, _Gap]]:
    """Return places along streets, widths [m] and gaps that a skyway can span, in any order."""
    found = []
    for gap in _gaps(lots, high):
        west, south, east, north = gap[0]
        low, top = (west, east) if gap[3] else (south, north)
        width = float(rng.choice((4.5, 6.0, 7.5, 9.0), p=(0.3, 0.25, 0.25, 0.2)))
        room = _FROM_CORNER + width / 2
        found += [(float(at), width, gap) for at in np.arange(low + room, top - room, _STEP)]
    return [found[k] for k in rng.permutation(len(found)).tolist()]


def _gaps(lots: list[Lot], high: list[bool]) -> list[_Gap]:
    """Return the ground between each two high fronts that face each other over a street."""
    boxes = np.array([lot.box for lot in lots])
    made: list[_Gap] = []
    for k in np.flatnonzero(high).tolist():
        for across, near, along in ((1, 3, 0), (0, 2, 1)):
            front = boxes[k, near]
            gap = boxes[:, across] - front
            low = np.maximum(boxes[:, along], boxes[k, along])
            top = np.minimum(boxes[:, along + 2], boxes[k, along + 2])
            facing = (gap > 12.0) & (gap < _WIDEST_STREET) & (top - low > 16.0) & high
            for other in np.flatnonzero(facing).tolist():
                back = boxes[other, across]
                sides = (low[other], front, top[other], back)
                if not across:
                    sides = (front, low[other], back, top[other])
                made.append((sides, k, other, bool(across)))
    return made


def _skyway(
    grid: Grid,
    place: float,
    width: float,
    gap: _Gap,
    buildings: list[list[BuildingPart]],
    rng: np.random.Generator,
) -> Skyway:
    (west, south, east, north), one, other, across = gap
    ends = [(place, south), (place, north)] if across else [(west, place), (east, place)]
    start, end = grid.world(np.array(ends))
    floors = 1 if width < 5.0 else 2
    glazed = floors == 1 or rng.random() < 0.5
    owner = buildings[one if rng.random() < 0.5 else other][0]
    look = ("facade_glass", (0.86, 0.95, 0.98)) if glazed else (owner.facade, owner.tint)
    return Skyway(start, end, width, floors, *look)
