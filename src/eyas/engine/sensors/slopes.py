"""How steep the ground is around each place, so that rays need not be followed in small steps."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.terrain import Terrain
from eyas.lanes import exact, kernel

_CELLS: Final = 4  # Cells of the relief along the side of a block

_AROUND: Final = (1, 4)  # Blocks around each over which the steepest slope is taken

_SLACK: Final = 1e-3
"""What is nearer to the ground than this is looked at exactly [m]: far more than rounding."""

Floats = NDArray[np.float64]


class Slopes(NamedTuple):
    """The steepest slopes around square blocks of the relief, rise per metre in any direction."""

    near: Floats  # In a block and those beside it, shape (R, C); (0, 0) for a flat map
    far: Floats  # In a block and four around it, shape (R, C)
    width: float  # Side of a block [m]


def slopes_of(terrain: Terrain) -> Slopes:
    """Return the slopes of a terrain."""
    width = _CELLS * terrain.spacing
    if terrain.relief.size == 0:
        return Slopes(np.zeros((0, 0)), np.zeros((0, 0)), width)
    relief = terrain.relief.astype(np.float64)
    east, north = np.abs(np.diff(relief, axis=1)), np.abs(np.diff(relief, axis=0))
    across, up = np.maximum(east[1:], east[:-1]), np.maximum(north[:, 1:], north[:, :-1])
    steep = exact.hypot(across, up) / terrain.spacing
    rows, columns = (-(-size // _CELLS) for size in steep.shape)
    whole = np.zeros((rows * _CELLS, columns * _CELLS))
    whole[: steep.shape[0], : steep.shape[1]] = steep
    blocks = whole.reshape(rows, _CELLS, columns, _CELLS).max(axis=(1, 3))
    near, far = (_most_around(blocks, reach) for reach in _AROUND)
    return Slopes(near, far, width)


def _most_around(blocks: Floats, reach: int) -> Floats:
    """Return the most in the square of blocks around each."""
    padded = np.pad(blocks, reach)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (2 * reach + 1, 2 * reach + 1))
    return np.ascontiguousarray(windows.max(axis=(2, 3)))


@kernel(inline=True)
def free_way(
    slopes: Slopes,  # Those of the terrain
    terrain: Terrain,  # The ground, not flat
    place: tuple[float, float],  # Where the ray is, east and north [m]
    ahead: tuple[float, float],  # Its ways on the level, and up, per metre
    above: float,  # Its height above the ground [m]
) -> float:
    """Return how far a ray is surely above hills [m]."""
    rows, columns = slopes.near.shape
    row = int(min(max((place[1] - terrain.south) / slopes.width, 0.0), float(rows - 1)))
    column = int(min(max((place[0] - terrain.west) / slopes.width, 0.0), float(columns - 1)))
    height, (level, rise) = above - _SLACK, ahead
    near = height / (max(slopes.near[row, column] * level - rise, 0.0) + _SLACK)
    far = height / (max(slopes.far[row, column] * level - rise, 0.0) + _SLACK)
    width = slopes.width
    return float(max(min(near, _AROUND[0] * width - _SLACK), min(far, _AROUND[1] * width - _SLACK)))
