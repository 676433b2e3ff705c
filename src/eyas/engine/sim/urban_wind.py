"""The mean wind among the buildings of a map, made once for each map.

First guesses by Roeckle ("Bestimmung der Stroemungsverhaeltnisse im Bereich komplexer
Bebauungsstrukturen", Darmstadt 1990), as in QUIC-URB: a profile over the ground, behind each
building a zone in which what blows from its wall turns back, and a wake. Then the nearest field, by
least squares, that has neither sources nor goes through walls (Sherman, "A mass-consistent model
for wind fields over complex terrain", Journal of Applied Meteorology 17, 1978): it speeds up at
corners and over roofs and follows streets. Vortices in streets and before walls, trees and hills
are left out.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.bake.ambient import height_map
from eyas.engine.state.scene import Scene
from eyas.engine.trackers.wind_field import UNIT, WindField
from eyas.lanes import compiled, exact, kernel
from eyas.lanes.elementary import power

_SPACING = 5.0  # Of the grid [m]

_LEVELS, _KEPT = 20, 13  # Levels that are computed, and those that are kept: up to 65 m

_MARGIN, _MOST = 12, 400
"""Columns around the buildings that are computed, too, and the most on a side."""

_DIRECTIONS = 16

_SWEEPS = 60  # Sweeps of the relaxation; with 16 more the wind changes by less than 1 %

_OVER = 1.7  # Its over-relaxation

_EXPONENT, _REFERENCE = 0.22, 10.0  # The profile over suburbs: a power of the height over 10 m

_WALL = 3.0  # Height from which on something is a building [m]

_FARTHEST = 60
"""How far upwind buildings are looked for, and how wide they count, in steps of the grid."""

_NEAR = 2  # How far around a place its wall is looked at, in steps of the grid


class _Grid(NamedTuple):
    """A wind over a map: C columns, R rows, L levels."""

    height: NDArray[np.float64]  # Of the buildings [m], shape (R, C)
    zone: NDArray[np.float64]  # Length of the zone behind a building [m], shape (R, C)
    guess: NDArray[np.float64]  # First guess, towards east and north [m/s], shape (L, R, C, 2)
    u: NDArray[np.float64]
    """Towards east through the faces between columns [m/s], shape (L, R, C + 1)."""
    v: NDArray[np.float64]  # Towards north through those between rows, shape (L, R + 1, C)
    w: NDArray[np.float64]  # Upwards through those between levels, shape (L + 1, R, C)
    potential: NDArray[np.float64]  # What the guess is corrected by, shape (L, R, C)
    east: float  # Direction of the wind, cosine from east
    north: float


def wind_field(scene: Scene) -> WindField:
    """Return the mean wind among the buildings of a map, kept in the cache.

    Raises:
        ConfigError: They stand too far apart.
    """
    extent = np.array(scene.size)
    columns, rows = np.ceil(extent / _SPACING).astype(int).tolist()
    frame = np.array([*(-0.5 * extent), 1.0 / _SPACING, scene.terrain.floor])
    heights = height_map(scene, frame, (rows, columns)).astype(np.float64)
    across, along = (_around(heights >= _WALL, axis) for axis in (1, 0))
    heights = heights[across, along]
    if max(heights.shape) > _MOST:
        raise ConfigError(
            f"tracker.wind.buildings: true is not allowed on '{scene.name}', whose buildings stand "
            f"{_SPACING * max(heights.shape):.0f} m apart; allowed: up to {_SPACING * _MOST:.0f} m"
        )
    table = cached(
        EntryKind.WIND, lambda: winds_over(heights), (winds_over, heights), of=NDArray[np.int16]
    )
    west = float(frame[0]) + _SPACING * (along.start + 0.5)
    south = float(frame[1]) + _SPACING * (across.start + 0.5)
    return WindField(table, west, south, _SPACING, 1)


def _around(walls: NDArray[np.bool_], axis: int) -> slice:
    """Return the rows (of axis 1, the columns of axis 0) of buildings, and a margin."""
    found = np.flatnonzero(walls.any(axis=axis))
    if len(found) == 0:
        return slice(0, 2)
    return slice(max(int(found[0]) - _MARGIN, 0), int(found[-1]) + 1 + _MARGIN)


def winds_over(heights: NDArray[np.float64]) -> NDArray[np.int16]:
    """Return the table of a `WindField` over buildings of these heights [m], shape (R, C)."""
    heights = np.ascontiguousarray(heights)  # the kind for which code ships
    rows, columns = heights.shape
    table = np.empty((_DIRECTIONS, _KEPT, rows, columns, 3), np.int16)
    for direction in range(_DIRECTIONS):
        angle = 2.0 * math.pi * direction / _DIRECTIONS
        grid = _Grid(
            heights,
            np.zeros((rows, columns)),
            np.zeros((_LEVELS, rows, columns, 2)),
            np.zeros((_LEVELS, rows, columns + 1)),
            np.zeros((_LEVELS, rows + 1, columns)),
            np.zeros((_LEVELS + 1, rows, columns)),
            np.zeros((_LEVELS, rows, columns)),
            float(exact.cos(angle)),
            float(exact.sin(angle)),
        )
        _blow_over(grid)
        wind = np.stack(
            [
                0.5 * (grid.u[:_KEPT, :, 1:] + grid.u[:_KEPT, :, :-1]),
                0.5 * (grid.v[:_KEPT, 1:] + grid.v[:_KEPT, :-1]),
                0.5 * (grid.w[1 : _KEPT + 1] + grid.w[:_KEPT]),
            ],
            axis=-1,
        )
        table[direction] = np.rint(wind / UNIT)
    return table


@compiled
def _blow_over(grid: _Grid) -> None:
    """Compute the wind over a map."""
    rows, columns = grid.height.shape
    for row in range(rows):
        for column in range(columns):
            grid.zone[row, column] = _zone(grid, row, column)
    for row in range(rows):
        for column in range(columns):
            _guess(grid, row, column)
    _begin(grid)
    for _sweep in range(_SWEEPS):
        _relax(grid)
    _correct(grid)
    _correct_upwards(grid)


@kernel
def _height(grid: _Grid, row: int, column: int) -> float:
    """Return the height of a column [m]; 0 beyond the map."""
    rows, columns = grid.height.shape
    if row < 0 or column < 0 or row >= rows or column >= columns:
        return 0.0
    height = grid.height[row, column]
    return height if height >= _WALL else 0.0


@kernel
def _solid(grid: _Grid, level: int, row: int, column: int) -> bool:
    return _height(grid, row, column) > (level + 0.5) * _SPACING


@kernel
def _width(grid: _Grid, row: int, column: int, east: float, north: float) -> float:
    """Return how far a building goes on along a line through one of its columns [m]."""
    count = 1
    for side in range(2):
        sign = 1.0 if side == 0 else -1.0
        for step in range(1, _FARTHEST):
            beside = math.floor(row + 0.5 + sign * step * north)
            if _height(grid, beside, math.floor(column + 0.5 + sign * step * east)) == 0.0:
                break
            count += 1
    return count * _SPACING


@kernel
def _zone(grid: _Grid, row: int, column: int) -> float:
    """Return the length of the zone behind a building in which the wind turns back [m]."""
    height = _height(grid, row, column)
    if height == 0.0:
        return 0.0
    wide = _width(grid, row, column, -grid.north, grid.east) / height
    deep = _width(grid, row, column, grid.east, grid.north) / height
    deep = min(max(deep, 0.3), 3.0)  # for which the formula was made
    return 1.8 * wide * height / (power(deep, 0.3) * (1.0 + 0.24 * wide))


@kernel
def _guess(grid: _Grid, row: int, column: int) -> None:
    """Write the first guess of a column, by the next building upwind that is higher."""
    done = 0
    for level in range(_LEVELS):
        speed = _profile((level + 0.5) * _SPACING)
        grid.guess[level, row, column, 0] = speed * grid.east
        grid.guess[level, row, column, 1] = speed * grid.north
    for step in range(1, _FARTHEST):
        y = math.floor(row + 0.5 - step * grid.north)
        x = math.floor(column + 0.5 - step * grid.east)
        height = _height(grid, y, x)
        while done < _LEVELS and height > (done + 0.5) * _SPACING:
            share = (done + 0.5) * _SPACING / height
            zone = grid.zone[y, x] * math.sqrt(1.0 - share * share)
            behind = (step - 0.5) * _SPACING
            guess = grid.guess[done, row, column]
            if behind < zone:
                back = 1.0 - behind / zone
                _turn_back(grid, guess, done, y, x, _profile(height) * back * back)
            elif behind < 3.0 * zone:
                near = zone / behind
                left = 1.0 - near * math.sqrt(near)
                guess[0], guess[1] = left * guess[0], left * guess[1]
            done += 1


@kernel
def _turn_back(
    grid: _Grid, guess: NDArray[np.float64], level: int, row: int, column: int, back: float
) -> None:
    """Turn back what blows from a wall, at a speed for a wind straight from it [m/s]; what blows
    along it goes on.
    """
    x = y = 0.0
    for i in range(-_NEAR, _NEAR + 1):
        for j in range(-_NEAR, _NEAR + 1):
            if _solid(grid, level, row + i, column + j):
                x, y = x - j, y - i
    size = math.sqrt(x * x + y * y)
    if size < 0.5 or x * grid.east + y * grid.north <= 0.0:
        x, y, size = grid.east, grid.north, 1.0
    x, y = x / size, y / size
    from_wall = guess[0] * x + guess[1] * y
    change = from_wall + back * (x * grid.east + y * grid.north)
    guess[0] -= change * x
    guess[1] -= change * y


@kernel
def _profile(height: float) -> float:
    """Return the wind at a height over open ground, over that at 10 m."""
    return power(height / _REFERENCE, _EXPONENT)


@kernel
def _begin(grid: _Grid) -> None:
    """Write the first guess through the faces; none goes through walls and the ground."""
    rows, columns = grid.height.shape
    guess = grid.guess
    for level in range(_LEVELS):
        for row in range(rows):
            for column in range(columns + 1):
                a, b = max(column - 1, 0), min(column, columns - 1)
                wall = _solid(grid, level, row, a) or _solid(grid, level, row, b)
                mean = 0.5 * (guess[level, row, a, 0] + guess[level, row, b, 0])
                grid.u[level, row, column] = 0.0 if wall else mean
        for row in range(rows + 1):
            a, b = max(row - 1, 0), min(row, rows - 1)
            for column in range(columns):
                wall = _solid(grid, level, a, column) or _solid(grid, level, b, column)
                mean = 0.5 * (guess[level, a, column, 1] + guess[level, b, column, 1])
                grid.v[level, row, column] = 0.0 if wall else mean


@kernel
def _relax(grid: _Grid) -> None:
    """Improve the potential: its Laplacian is the divergence of the first guess. It is 0 beyond the
    map and above, and does not change through walls.
    """
    rows, columns = grid.height.shape
    potential = grid.potential
    for level in range(_LEVELS):
        for row in range(rows):
            for column in range(columns):
                if _solid(grid, level, row, column):
                    continue
                count = total = 0.0
                for side in range(6):
                    k, i, j = _beside(level, row, column, side)
                    if k < 0 or (k < _LEVELS and _solid(grid, k, i, j)):
                        continue
                    count += 1.0
                    if k < _LEVELS and 0 <= i < rows and 0 <= j < columns:
                        total += potential[k, i, j]
                out = grid.u[level, row, column + 1] - grid.u[level, row, column]
                out += grid.v[level, row + 1, column] - grid.v[level, row, column]
                if count > 0.0:
                    best = (total - out * _SPACING) / count
                    potential[level, row, column] += _OVER * (best - potential[level, row, column])


@kernel
def _beside(level: int, row: int, column: int, side: int) -> tuple[int, int, int]:
    """Return one of the six neighbours of a cell."""
    step = 1 if side % 2 == 0 else -1
    if side < 2:
        return level, row, column + step
    if side < 4:
        return level, row + step, column
    return level + step, row, column


@kernel
def _value(grid: _Grid, level: int, row: int, column: int) -> float:
    """Return the potential of a cell; 0 beyond the grid."""
    rows, columns = grid.height.shape
    if level >= _LEVELS or row < 0 or column < 0 or row >= rows or column >= columns:
        return 0.0
    return float(grid.potential[level, row, column])


@kernel
def _correct(grid: _Grid) -> None:
    """Take the gradient of the potential from what goes through the faces along the ground."""
    rows, columns = grid.height.shape
    for level in range(_LEVELS):
        for row in range(rows):
            for column in range(columns + 1):
                if not (_solid(grid, level, row, column - 1) or _solid(grid, level, row, column)):
                    change = _value(grid, level, row, column) - _value(grid, level, row, column - 1)
                    grid.u[level, row, column] -= change / _SPACING
        for row in range(rows + 1):
            for column in range(columns):
                if not (_solid(grid, level, row - 1, column) or _solid(grid, level, row, column)):
                    change = _value(grid, level, row, column) - _value(grid, level, row - 1, column)
                    grid.v[level, row, column] -= change / _SPACING


@kernel
def _correct_upwards(grid: _Grid) -> None:
    """The same for what goes through the faces between levels."""
    rows, columns = grid.height.shape
    for level in range(1, _LEVELS + 1):
        for row in range(rows):
            for column in range(columns):
                if not _solid(grid, level - 1, row, column):
                    change = _value(grid, level, row, column)
                    change -= _value(grid, level - 1, row, column)
                    grid.w[level, row, column] -= change / _SPACING
