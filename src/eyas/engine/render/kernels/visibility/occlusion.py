"""What is certainly hidden behind what has been drawn: boxes against the depth of whole tiles."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import NEAR, Row, View
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, any_of, lane, lane_numbers, like, load, select, to_f4

TILE = WIDTH  # Side of a tile [samples]

_MARGIN = 1.0  # Width of the border around a box on the screen that counts as the box [samples]

_SLACK = 0.05  # How much nearer than computed a box may be [m]: more than float32 rounds off

_SHARE = 0.98
"""The same as a share: 1/distance at a sample may exceed that of a triangle's corners by 1/64."""


@kernel
def measure_tiles(
    key: NDArray[np.int64],  # See `Scratch`, shape (rows, columns)
    width: int,  # Width of the picture [samples]
    tiles: NDArray[np.float32],  # Written, shape (rows / TILE, columns / TILE), rounded up
) -> None:
    """Set 1/distance of the farthest that each tile shows, 0 where it shows sky."""
    rows, stride = key.shape
    for i in range((rows + TILE - 1) // TILE):
        for k in range(stride // TILE):
            least = load(key, i * TILE * stride + k * TILE)
            for line in range(i * TILE + 1, min((i + 1) * TILE, rows)):
                keys = load(key, line * stride + k * TILE)
                least = select(keys < least, keys, least)
            inside = lane_numbers() < i4(width - k * TILE)
            tiles[i, k] = _least(select(inside, distance_inverse(least), f4(np.inf)))


@kernel(inline=True)
def _least(values: float) -> float:
    least = lane(values, 0)
    for number in range(1, WIDTH):
        least = min(least, lane(values, number))
    return least


@kernel(inline=True)
def _most(values: float) -> float:
    most = lane(values, 0)
    for number in range(1, WIDTH):
        most = max(most, lane(values, number))
    return most


@kernel(inline=True)
def _along(row: Row, x: float, y: float, z: float) -> float:
    return f4(row.x) * x + f4(row.y) * y + f4(row.z) * z + f4(row.w)


@kernel(inline=True)
def _side(boxes: NDArray[np.float32], column: int, axis: int) -> float:
    """Return a coordinate of the eight corners of a box."""
    upper = (lane_numbers() & i4(1 << axis)) != i4(0)
    low = like(to_f4(lane_numbers()), boxes[axis, column])
    return select(upper, like(low, boxes[axis + 3, column]), low)


@kernel
def box_is_hidden(
    boxes: NDArray[np.float32],  # See `Geometry.chunk_box`
    column: int,  # The box
    view: View,  # The band
    tiles: NDArray[np.float32],  # See `measure_tiles`
) -> bool:
    """Return whether all of a box is farther than what the tiles in front of it show."""
    x, y, z = _side(boxes, column, 0), _side(boxes, column, 1), _side(boxes, column, 2)
    distance = _along(view.screen.distance, x, y, z)
    least = distance * f4(_SHARE) - f4(_SLACK)
    if any_of(least < f4(NEAR)):
        return False
    inverse = f4(1.0) / distance
    across = _along(view.screen.column, x, y, z) * inverse + f4(0.5 * view.width)
    down = _along(view.screen.row, x, y, z) * inverse + f4(0.5 * view.height - view.top)
    nearest, last_row = _most(f4(1.0) / least), (view.rows - 1) // TILE
    left, right = _tile(_least(across) - _MARGIN), _tile(_most(across) + _MARGIN)
    top, bottom = _tile(_least(down) - _MARGIN), _tile(_most(down) + _MARGIN)
    for i in range(max(top, 0), min(bottom, last_row) + 1):
        for k in range(max(left, 0), min(right, tiles.shape[1] - 1) + 1):
            if tiles[i, k] <= nearest:
                return False
    return True


@kernel(inline=True)
def _tile(place: float) -> int:
    """Return the tile of a place [samples]; places far away become some tile outside."""
    return i8(np.floor(min(max(place, -1e6), 1e6) / TILE))
