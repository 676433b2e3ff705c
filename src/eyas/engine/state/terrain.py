"""The height of the ground, in a form that kernels read."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel


class Terrain(NamedTuple):
    """The ground of a map: a floor, and a relief above it.

    Roads and buildings follow the relief. A map without hills has an empty raster, and reading its
    height costs one comparison.
    """

    floor: float
    """z of the floor, where the relief is 0 [m]."""
    relief: NDArray[np.float32]
    """Height above the floor at the points of a square grid [m], row 0 in the south, column 0 in
    the west, shape (R, C), at least (2, 2); (0, 0) for a flat map."""
    west: float
    """East coordinate of column 0 [m]."""
    south: float
    """North coordinate of row 0 [m]."""
    spacing: float
    """Distance between neighbouring points of the grid [m]."""

    @classmethod
    def flat(cls, floor: float) -> "Terrain":
        """Return a flat terrain at a height [m]."""
        return cls(float(floor), np.zeros((0, 0), np.float32), 0.0, 0.0, 1.0)


class Plane(NamedTuple):
    """The plane that touches the ground at a point."""

    x: float  # East coordinate of the point [m]
    y: float  # North coordinate of the point [m]
    z: float  # Height of the ground there [m]
    rise_east: float  # Rise of the plane per metre east
    rise_north: float  # Rise of the plane per metre north


def reliefs(
    terrain: Terrain,  # The ground
    points: NDArray[np.float64],  # East and north [m], shape (..., 2)
) -> NDArray[np.float64]:
    """Return the height above the floor at points, as `relief_at` does.

    Returns:
        Heights [m], shape (...).
    """
    raster = terrain.relief
    if raster.size == 0:
        return np.zeros(points.shape[:-1])
    corner = np.array([terrain.west, terrain.south])
    last = np.array([raster.shape[1] - 1, raster.shape[0] - 1])
    place = np.clip((points - corner) / terrain.spacing, 0.0, last)
    cell = np.minimum(place.astype(np.intp), last - 1)
    across, up = np.moveaxis(place - cell, -1, 0)
    column, row = np.moveaxis(cell, -1, 0)
    south = (1.0 - across) * raster[row, column] + across * raster[row, column + 1]
    north = (1.0 - across) * raster[row + 1, column] + across * raster[row + 1, column + 1]
    return np.asarray((1.0 - up) * south + up * north, np.float64)


@kernel
def relief_at(
    terrain: Terrain,  # The ground
    x: float,  # East [m]
    y: float,  # North [m]
) -> float:
    """Return the height above the floor at a point [m], linear between the points of the grid.

    Beyond the raster, the height of its nearest edge applies.
    """
    if terrain.relief.shape[0] == 0:
        return 0.0
    row, column, up, across = _cell(terrain, x, y)
    raster = terrain.relief
    south = (1.0 - across) * raster[row, column] + across * raster[row, column + 1]
    north = (1.0 - across) * raster[row + 1, column] + across * raster[row + 1, column + 1]
    return float((1.0 - up) * south + up * north)


@kernel
def ground_at(terrain: Terrain, x: float, y: float) -> float:
    """Return z of the ground at a point [m]; arguments as in `relief_at`."""
    return terrain.floor + relief_at(terrain, x, y)


@kernel
def slope_at(terrain: Terrain, x: float, y: float) -> tuple[float, float]:
    """Return the rise of the ground per metre east and per metre north; 0 beyond the raster."""
    if terrain.relief.shape[0] == 0:
        return 0.0, 0.0
    row, column, up, across = _cell(terrain, x, y)
    raster = terrain.relief
    south = raster[row, column + 1] - raster[row, column]
    north = raster[row + 1, column + 1] - raster[row + 1, column]
    west = raster[row + 1, column] - raster[row, column]
    east = raster[row + 1, column + 1] - raster[row, column + 1]
    rise_x = ((1.0 - up) * south + up * north) / terrain.spacing
    rise_y = ((1.0 - across) * west + across * east) / terrain.spacing
    on_x = 0.0 <= x - terrain.west <= (raster.shape[1] - 1) * terrain.spacing
    on_y = 0.0 <= y - terrain.south <= (raster.shape[0] - 1) * terrain.spacing
    return float(rise_x) if on_x else 0.0, float(rise_y) if on_y else 0.0


@kernel
def _cell(terrain: Terrain, x: float, y: float) -> tuple[int, int, float, float]:
    """Return row and column of the grid cell around a point, and its place in the cell, 0 to 1."""
    rows, columns = terrain.relief.shape
    across = min(max((x - terrain.west) / terrain.spacing, 0.0), float(columns - 1))
    up = min(max((y - terrain.south) / terrain.spacing, 0.0), float(rows - 1))
    column, row = min(int(across), columns - 2), min(int(up), rows - 2)
    return row, column, up - row, across - column


@kernel
def plane_at(terrain: Terrain, x: float, y: float) -> Plane:
    """Return the plane that touches the ground at a point; arguments as in `relief_at`."""
    rise_east, rise_north = slope_at(terrain, x, y)
    return Plane(x, y, ground_at(terrain, x, y), rise_east, rise_north)


@kernel
def height_over(plane: Plane, x: float, y: float, z: float) -> float:
    """Return the vertical height of a point above a plane [m]."""
    return z - plane.z - (plane.rise_east * (x - plane.x) + plane.rise_north * (y - plane.y))
