"""A grid of square cells on the ground, with the solids that reach into each."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import step_kernel

__all__ = ["Grid", "cells_between", "grid_of"]

SPACING = 8.0
"""Width of a cell [m]."""


class Grid(NamedTuple):
    """The items in each cell."""

    first: NDArray[np.int32]
    """Start of each cell's items, row by row from the south-west, shape (rows * columns + 1,)."""
    item: NDArray[np.int32]
    """The items."""
    top: NDArray[np.float64]
    """Highest z of each cell's items [m], shape (rows * columns,)."""
    columns: int
    rows: int
    west: float
    """[m]"""
    south: float
    """[m]"""


def grid_of(bounds: NDArray[np.float64], top: NDArray[np.float64]) -> Grid:
    """Return the grid of I items.

    Args:
        bounds: West, south, east, north of each [m], shape (I, 4).
        top: Highest z of each [m], shape (I,).
    """
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
    return Grid(
        first=np.cumsum([0, *map(len, cells)]).astype(np.int32),
        item=np.array([item for cell in cells for item in cell], np.int32),
        top=np.array([max((heights[item] for item in cell), default=-math.inf) for cell in cells]),
        columns=columns,
        rows=rows,
        west=float(corner[0]),
        south=float(corner[1]),
    )


@step_kernel
def cells_between(
    grid: Grid, x: tuple[float, float], y: tuple[float, float], beside: float
) -> tuple[int, int, int, int]:
    """Return the first and last row, and the first and last column, of the cells around a line.

    Args:
        grid: The grid.
        x: Where the line begins and ends, east [m].
        y: The same, north [m].
        beside: How far cells matter beside it [m].
    """
    left = math.floor((min(x[0], x[1]) - beside - grid.west) / SPACING)
    right = math.floor((max(x[0], x[1]) + beside - grid.west) / SPACING)
    lower = math.floor((min(y[0], y[1]) - beside - grid.south) / SPACING)
    upper = math.floor((max(y[0], y[1]) + beside - grid.south) / SPACING)
    return max(lower, 0), min(upper, grid.rows - 1), max(left, 0), min(right, grid.columns - 1)
