"""A grid of square cells on the ground, with the solids that reach into each."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel

SPACING = 8.0  # Width of a cell [m]

_BESIDE = 1e-3  # How far beside a ray cells are looked at, far more than rounding moves it [m]


class ObstacleGrid(NamedTuple):
    """The items in each cell."""

    first: NDArray[np.int32]
    """Start of each cell's items, row by row from the south-west, shape (rows * columns + 1,)."""
    item: NDArray[np.int32]  # The items
    top: NDArray[np.float64]  # Highest z of each cell's items [m], shape (rows * columns,)
    columns: int
    rows: int
    west: float  # [m]
    south: float  # [m]
    bounds: NDArray[np.float64]  # West, south, east, north of each item [m], shape (I, 4)


class Walk(NamedTuple):
    """The way of a ray through the cells, lane by lane from where it begins.

    Lanes are the columns of a ray that goes rather east or west, else the rows.
    """

    lane: int  # The first lane
    lanes: int  # Number of lanes
    onward: int  # 1 or -1: to the next lane
    stride: int  # From a cell to the one beside it in the next lane of a higher number
    start: float  # Where the ray begins along it, from the edge of the grid [m]
    farthest: float  # Where it ends [m]
    inverse: float  # Length of the ray over its way along it; 0 for an upright one
    least: int  # First cell of each lane that the ray may reach at all
    most: int  # The last one
    cell_stride: int  # From a cell to the next one of its lane
    aside: float  # Where the ray begins across the lanes, from the edge of the grid [m]
    slope: float  # Its way across lanes over that along it


def grid_of(
    bounds: NDArray[np.float64],  # West, south, east, north of each [m], shape (I, 4)
    top: NDArray[np.float64],  # Highest z of each [m], shape (I,)
) -> ObstacleGrid:
    """Return the grid of I items."""
    corner = bounds[:, :2].min(axis=0) if len(bounds) else np.zeros(2)
    far = bounds[:, 2:].max(axis=0) if len(bounds) else np.zeros(2)
    columns, rows = (int(n) + 1 for n in (far - corner) // SPACING)
    cells: list[list[int]] = [[] for _ in range(rows * columns)]
    reach = ((bounds - np.tile(corner, 2)) // SPACING).astype(int)
    for item, (left, low, right, high) in enumerate(reach.tolist()):
        for row in range(low, high + 1):
            for column in range(left, right + 1):
                cells[row * columns + column].append(item)
    heights = top.tolist()
    return ObstacleGrid(
        first=np.cumsum([0, *map(len, cells)]).astype(np.int32),
        item=np.array([item for cell in cells for item in cell], np.int32),
        top=np.array([max((heights[item] for item in cell), default=-math.inf) for cell in cells]),
        columns=columns,
        rows=rows,
        west=float(corner[0]),
        south=float(corner[1]),
        bounds=np.ascontiguousarray(bounds, np.float64),
    )


@kernel(inline=True)
def cells_between(
    grid: ObstacleGrid,
    x: tuple[float, float],  # Where the line begins and ends, east [m]
    y: tuple[float, float],  # The same, north [m]
    beside: float,  # How far cells matter beside it [m]
) -> tuple[int, int, int, int]:
    """Return the first and last row, and the first and last column, of the cells around a line."""
    left = math.floor((min(x[0], x[1]) - beside - grid.west) / SPACING)
    right = math.floor((max(x[0], x[1]) + beside - grid.west) / SPACING)
    lower = math.floor((min(y[0], y[1]) - beside - grid.south) / SPACING)
    upper = math.floor((max(y[0], y[1]) + beside - grid.south) / SPACING)
    return max(lower, 0), min(upper, grid.rows - 1), max(left, 0), min(right, grid.columns - 1)


@kernel(inline=True)
def walk_along(
    grid: ObstacleGrid,
    start: tuple[float, float],  # Where it begins, east and north [m]
    ahead: tuple[float, float],  # Its way east and north, per metre of its length
    end: tuple[float, float],  # Where it ends [m]
    cells: tuple[int, int, int, int],  # See `cells_between`: those of the rectangle around it
) -> Walk:
    """Return the way of a ray."""
    first_row, last_row, left, right = cells
    x, y = start[0] - grid.west, start[1] - grid.south
    if abs(ahead[0]) >= abs(ahead[1]):
        inverse = 1.0 / ahead[0] if ahead[0] != 0.0 else 0.0
        onward, far = (1 if ahead[0] >= 0.0 else -1), end[0] - grid.west
        lane, lanes = (left if onward > 0 else right), right - left + 1
        least, most, slope = first_row, last_row, ahead[1] * inverse
        return Walk(lane, lanes, onward, 1, x, far, inverse, least, most, grid.columns, y, slope)
    inverse = 1.0 / ahead[1]
    onward, far = (1 if ahead[1] >= 0.0 else -1), end[1] - grid.south
    lane, lanes = (first_row if onward > 0 else last_row), last_row - first_row + 1
    return Walk(
        lane, lanes, onward, grid.columns, y, far, inverse, left, right, 1, x, ahead[0] * inverse
    )


@kernel(inline=True)
def entered(walk: Walk, lane: int) -> float:
    """Return a distance before which a ray is not in a lane [m]."""
    edge = lane * SPACING if walk.onward > 0 else (lane + 1) * SPACING
    return (edge - walk.onward * _BESIDE - walk.start) * walk.inverse


@kernel(inline=True)
def lane_cells(walk: Walk, lane: int) -> tuple[int, int]:
    """Return the first and last cell of a lane that a ray goes through."""
    low = max(lane * SPACING, min(walk.start, walk.farthest)) - walk.start
    high = min((lane + 1) * SPACING, max(walk.start, walk.farthest)) - walk.start
    one, other = walk.aside + low * walk.slope, walk.aside + high * walk.slope
    first = math.floor((min(one, other) - _BESIDE) / SPACING)
    last = math.floor((max(one, other) + _BESIDE) / SPACING)
    return max(first, walk.least), min(last, walk.most)
