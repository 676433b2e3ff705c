"""Ambient occlusion: the share of the light of the sky that arrives on ground and roofs, baked."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.lanes import exact, kernel, parallel
from eyas.lanes.vector import any_of, gather_square, greater, lesser, like, select, to_f4, to_i4

DIRECTIONS = 16  # Number of directions in which the horizon is searched

STEPS = 14  # Number of points examined in each direction

LEAVES = 0.6  # Share of the light that a crown absorbs

STOREY = 2.0  # Roofs and ground that differ by less are one [m]

BOUNCED = 0.42
"""Share of the sky's light that arrives by way of walls and ground where the sky is hidden."""

WEAR, EVEN = 200.0, 128
"""Of the byte that says how much lighter the ground is than its texture: steps in the whole of
that, and the value of ground that is as its texture."""

_ASIDE = f4(0.9)  # Distance in front of a wall at which its light is looked up [m]


DISTANCES = tuple(0.9 * float(exact.power(1.36, step)) for step in range(STEPS))
"""Distances of these points [m]: 1 to 49, each about a third farther than the last."""

_HALF_WAY = 1.0 / math.sqrt(1.36)


@kernel(inline=True)
def _sine_squared(height: float, far: float) -> float:
    """Return sin^2 of the angle below which something is seen: the share of the light below it."""
    return height * height / (height * height + far * far)


@kernel
def _open_share(
    bake: "OpennessBake", row: int, column: int, near_decks: bool
) -> tuple[float, float]:
    """Return the share of the sky's light on a texel's ground or roof, and the height above the
    ground of what hides it.

    Each direction contributes cos^2 of the horizon's angle, the share on a flat surface below
    a uniformly bright sky, less what decks hide above it.
    """
    solid, crowns = bake.solid, bake.crowns
    rows, columns = solid.shape
    base = solid[row, column]
    total, height, weight = 0.0, 0.0, 1e-6
    for k in range(DIRECTIONS):
        slope, leafy, high = 0.0, 0.0, 0.0
        for step in range(STEPS):
            i, j = int(row + 0.5 + bake.way[k, step, 0]), int(column + 0.5 + bake.way[k, step, 1])
            if i < 0 or j < 0 or i >= rows or j >= columns:
                break
            far = bake.distance[step]
            if solid[i, j] - base > slope * far:
                slope, high = (solid[i, j] - base) / far, max(high, float(solid[i, j]))
            if crowns[i, j] - base > leafy * far:
                leafy = (crowns[i, j] - base) / far
        hidden = _sine_squared(slope, 1.0)
        leaves = max(_sine_squared(leafy, 1.0) - hidden, 0.0)
        total += 1.0 - hidden - LEAVES * leaves
        height += high * hidden
        weight += hidden
        if near_decks:
            covered, top = _covered(bake, row, column, k, hidden)
            total -= covered
            height += top * covered
            weight += covered
    share = total / DIRECTIONS
    above = crowns[row, column]
    if above > base:  # a crown right overhead hides the zenith, the brightest part
        share *= 1.0 - 0.5 * LEAVES
        height, weight = height + 2.0 * above, weight + 2.0
    height /= weight
    if near_decks and bake.decks[row, column] > base:  # the road on the deck is open
        height = min(height, float(bake.decks[row, column]))
    return BOUNCED + (1.0 - BOUNCED) * max(share, 0.0), height


@kernel
def _covered(
    bake: "OpennessBake", row: int, column: int, direction: int, hidden: float
) -> tuple[float, float]:
    """Return the share of the light of one direction that decks hide, and the highest one's height.

    The `hidden` share, which would come from below the horizon, is left out.
    """
    decks, base = bake.decks, bake.solid[row, column]
    total, top, upper = 0.0, 0.0, 1.0
    i, j = row, column
    for step in range(STEPS):
        # What lies at a point is taken to reach half-way to the next ones.
        far = bake.distance[step] * _HALF_WAY
        deck = decks[i, j] - base
        if deck > 0.0:
            lower = max(_sine_squared(deck, far), hidden)
            total += max(upper - lower, 0.0)
            top = max(top, float(decks[i, j]))
        i = int(row + 0.5 + bake.way[direction, step, 0])
        j = int(column + 0.5 + bake.way[direction, step, 1])
        if i < 0 or j < 0 or i >= decks.shape[0] or j >= decks.shape[1]:
            break
        upper = _sine_squared(decks[i, j] - base, far)
    return total, top


class OpennessBake(NamedTuple):
    """Input and output of `bake_openness`."""

    way: NDArray[np.float64]
    """Way to each point that is examined: rows and columns, shape (DIRECTIONS, STEPS, 2)."""
    distance: NDArray[np.float64]  # Its length, `DISTANCES` [m]
    solid: NDArray[np.float32]  # Height of buildings [m], shape (rows, columns)
    crowns: NDArray[np.float32]  # Height of trees [m], shape (rows, columns)
    decks: NDArray[np.float32]  # Height of elevated roads [m], shape (rows, columns)
    square: int  # Side of the squares of `decked` [texels]
    decked: NDArray[np.bool_]
    """Whether there may be decks at the points of a texel, for squares of texels."""
    result: NDArray[np.uint16]  # `AmbientMap.openness`, filled, shape (rows, columns).


@parallel
def bake_openness(worker: int, workers: int, bake: OpennessBake) -> None:
    """Fill `AmbientMap.openness`, for the ground and for roofs.

    Up to 3 texels into a building, where the feet of its walls are looked up, it copies the
    nearest texel of what they stand on.
    """
    solid, result = bake.solid, bake.result
    for row in range(worker, solid.shape[0], workers):
        for column in range(solid.shape[1]):
            i, j = _outside(solid, row, column)
            near_decks = bake.decked[i // bake.square, j // bake.square]
            share, height = _open_share(bake, i, j, near_decks)
            if (row + column) & 1:
                height = solid[i, j]
            height = min(max(height, 0.0), 255.0)
            result[row, column] = np.uint16(int(255.0 * share + 0.5) | (int(height) << 8))


@kernel
def _outside(solid: NDArray[np.float32], row: int, column: int) -> tuple[int, int]:
    """Return the nearest texel within 3 that is lower by a storey, or this one."""
    rows, columns = solid.shape
    if solid[row, column] <= STOREY:  # as most of a map: nothing is lower than the ground
        return row, column
    for reach in range(4):
        best, bi, bj = 1 << 30, -1, -1
        for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
            for j in range(max(column - reach, 0), min(column + reach + 1, columns)):
                far = (i - row) ** 2 + (j - column) ** 2
                if solid[i, j] < solid[row, column] - STOREY and far < best:
                    best, bi, bj = far, i, j
        if bi >= 0:
            return bi, bj
    return row, column


@kernel(inline=True)
def openness(
    light: Light,  # Its map
    x: float,  # The point [m]
    y: float,  # The point [m]
    z: float,  # The point [m]
    normal_x: float,  # Eastward component of the normal: walls see the sky in front of them
    normal_y: float,  # Northward component of the normal
    level: bool,  # Whether any of the points is ground or a roof; one answer for all lanes
) -> tuple[float, float]:
    """Return the share of the sky's light that reaches a point, 0 to 1, and by which share the
    ground there is lighter than its texture: as at the map's first texel beyond the map.
    """
    frame, shares = light.ambient_frame, light.ambient
    column = (x + _ASIDE * normal_x - frame.west) * frame.per_metre - f4(0.5)
    row = (y + _ASIDE * normal_y - frame.south) * frame.per_metre - f4(0.5)
    rows, columns = shares.shape
    zero, one = f4(0.0), like(x, f4(1.0))
    inside = (column >= zero) & (row >= zero)
    inside &= (column < f4(i4(columns - 1))) & (row < f4(i4(rows - 1)))
    column, row = select(inside, column, zero), select(inside, row, zero)
    i, j = to_i4(row), to_i4(column)
    across, down = column - to_f4(j), row - to_f4(i)
    a, b, c, d = gather_square(shares, to_i4(i * i4(columns) + j), columns)
    byte, eight = u4(255), u4(8)
    share = one
    if any_of((a & b & c & d & byte) != byte):
        hidden = one - f4(1.0 / 255.0) * _blend(a, b, c, d, 0, across, down)
        # Higher up less is hidden; at the top of what hides it, nothing. Of four texels two on a
        # diagonal hold the top, two the base. Where neighbours differ, the lower are walls' feet.
        even = (to_i4(i + j) & i4(1)) == i4(0)
        one_a, one_b = to_i4((a >> eight) & byte), to_i4((d >> eight) & byte)
        two_a, two_b = to_i4((b >> eight) & byte), to_i4((c >> eight) & byte)
        one_c, two_c = to_f4(lesser(one_a, one_b)), to_f4(lesser(two_a, two_b))
        top, base = select(even, one_c, two_c), select(even, two_c, one_c)
        above = z - (frame.ground + base)
        climb = one - lesser(greater(above / greater(top - base, one), zero), one)
        share = select(inside, one - hidden * climb * climb, one)
    worn = like(x, zero)
    if level:
        worn = f4(1.0 / WEAR) * (_blend(a, b, c, d, 24, across, down) - f4(EVEN))
    return share, worn


@kernel(inline=True)
def _blend(a: int, b: int, c: int, d: int, at: int, across: float, down: float) -> float:
    """Return the blend of four texels' bytes from a bit on."""
    first, second = to_f4(_byte(a, at)), to_f4(_byte(c, at))
    first += across * (to_f4(_byte(b, at)) - first)
    second += across * (to_f4(_byte(d, at)) - second)
    return first + down * (second - first)


@kernel(inline=True)
def _byte(word: int, at: int) -> int:
    if at == 24:
        return to_i4(word >> u4(24))
    return to_i4((word >> u4(at)) & u4(255))
