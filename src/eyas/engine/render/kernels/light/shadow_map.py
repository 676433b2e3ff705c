"""The shadow map: height towards the sun of the first surface that sunlight meets."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import TILE, Geometry, Projection, Row
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.clusters import (
    CLUSTER,
    CLUSTER_ROWS,
    UV_ROWS,
    along_row,
    has_leaves,
)
from eyas.engine.render.kernels.visibility.fill import fill
from eyas.engine.render.kernels.visibility.holes import LEVELS, holes_of, no_holes
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.engine.render.kernels.visibility.leaves import material_of
from eyas.engine.render.kernels.visibility.transform import object_projection
from eyas.engine.render.kernels.visibility.triangles import Corners, set_up, set_up_leaves
from eyas.lanes import kernel, parallel
from eyas.lanes.vector import any_of, bits_of, first_bit, greater, lane_numbers, load, to_f8

BLOCK = 8  # Tiles along a side of what is drawn at a time: 257 x 257 keys fit into a core's cache

BLOCK_TEXELS = BLOCK * TILE + 1
"""Texels along the same side; the last ones belong to the next block too."""

LEAF_LEVEL = 3  # Mip level of the holes between leaves, matched to the size of the map's texels

THICKER = 0.3
"""Margin added to all sides of thin things [texels]: the shadow of a pole narrower than a
texel would break into pieces."""


EVERYWHERE = 1e9  # Nothing is farther away [m]


class ShadowBake(NamedTuple):
    """Input and output of `bake_tiles`, K workers."""

    cards: NDArray[np.int32]
    """For each material: 0 if it is solid; n if one leaf card in n is drawn, with its holes; -1
    if none is drawn."""
    thin: NDArray[np.bool_]  # Whether each prototype of the fixtures may be narrower than a texel
    flat: float  # Static triangles nowhere above this z cast no shadow [m]
    sun: Projection
    """World to column and row of the map and, in place of the distance, height, 1 to 65535."""
    reach: NDArray[np.float32]
    """First column, first row, last column and last row that each chunk, then each fixture, may
    cover, shape (C + F, 4)."""
    block: NDArray[np.int32]  # Row and column of the first tile of each block to draw, shape (B, 2)
    tile: NDArray[np.int32]
    """Number of each tile in `heights`, 0 for those not wanted; shape (rows, columns), both
    multiples of `BLOCK`."""
    triangle: NDArray[np.float64]  # Working memory, see `Scratch`, shape (K, TRIANGLE_ROWS, 8)
    span: NDArray[np.int32]  # Working memory, see `Scratch`, shape (K, SPAN_ROWS, 8)
    key: NDArray[np.int64]
    """Working memory, see `Scratch`, with heights in place of 1/distance;
    shape (K, BLOCK_TEXELS, BLOCK_TEXELS, rounded up to a multiple of 8)."""
    heights: NDArray[np.uint16]
    """Tiles that are wanted are filled, shape (tiles, TILE + 1, TILE + 1)."""


@parallel
def bake_tiles(worker: int, workers: int, geometry: Geometry, bake: ShadowBake) -> None:
    """Draw static triangles and the finest level of all fixtures into the tiles that are wanted."""
    for block in range(worker, len(bake.block), workers):
        row, column = bake.block[block]
        _draw_block(geometry, bake, row * TILE, column * TILE, worker)
        for i in range(row, row + BLOCK):
            for j in range(column, column + BLOCK):
                if bake.tile[i, j] > 0:
                    _copy_tile(
                        bake.key[worker], (i - row) * TILE, (j - column) * TILE,
                        bake.heights[bake.tile[i, j]],
                    )  # fmt: skip


@kernel(inline=True)
def _copy_tile(key: NDArray[np.int64], top: int, left: int, heights: NDArray[np.uint16]) -> None:
    for line in range(TILE + 1):
        for column in range(TILE + 1):
            height = distance_inverse(key[top + line, left + column])
            heights[line, column] = np.uint16(min(height, f4(65535.0)))


@kernel
def _draw_block(geometry: Geometry, bake: ShadowBake, top: int, left: int, worker: int) -> None:
    """Draw a block, whose first texel is that of row `top` and column `left` of the map."""
    bake.key[worker][:] = 0
    column, row, thin = bake.sun.column, bake.sun.row, bake.thin
    sun = Projection(
        Row(column.x, column.y, column.z, column.w - left),
        Row(row.x, row.y, row.z, row.w - top),
        bake.sun.distance,
    )
    chunks = len(geometry.chunk_range)
    for chunk in range(chunks):
        if _is_in(bake.reach, chunk, top, left):
            _draw(geometry, bake, geometry.chunk_range[chunk], sun, bake.flat, 0.0, 0.0, worker)
    for i in range(len(geometry.fixture_prototype)):
        if not _is_in(bake.reach, chunks + i, top, left):
            continue
        prototype = geometry.fixture_prototype[i]
        mesh = geometry.mesh_range[geometry.level_first[prototype]]
        screen = object_projection(sun, geometry.fixture_pose, i)
        for side in range(4 if thin[prototype] else 1):
            right, down = 0.0, 0.0
            if thin[prototype]:
                right = THICKER if side & 1 else -THICKER
                down = THICKER if side & 2 else -THICKER
            _draw(geometry, bake, mesh, screen, -EVERYWHERE, right, down, worker)


@kernel(inline=True)
def _is_in(reach: NDArray[np.float32], thing: int, top: int, left: int) -> bool:
    """Return whether a chunk or fixture may cover texels of a block."""
    return (
        reach[thing, 0] < left + BLOCK_TEXELS
        and reach[thing, 1] < top + BLOCK_TEXELS
        and reach[thing, 2] > left
        and reach[thing, 3] > top
    )


@kernel(inline=True)
def _corner(
    cluster: NDArray[np.float32], at: int, screen: Projection
) -> tuple[float, float, float]:
    x = to_f8(load(cluster, at))
    y = to_f8(load(cluster, at + CLUSTER))
    z = to_f8(load(cluster, at + 2 * CLUSTER))
    return (
        along_row(screen.column, x, y, z),
        along_row(screen.row, x, y, z),
        along_row(screen.distance, x, y, z),
    )


@kernel(inline=True)
def _project(
    cluster: NDArray[np.float32], number: int, screen: Projection, right: float, down: float
) -> Corners:
    """Project eight triangles; heights take the place of 1/distance."""
    at = number * CLUSTER_ROWS * CLUSTER
    ax, ay, ai = _corner(cluster, at, screen)
    bx, by, bi = _corner(cluster, at + 3 * CLUSTER, screen)
    cx, cy, ci = _corner(cluster, at + 6 * CLUSTER, screen)
    return Corners(ax + right, ay + down, ai, bx + right, by + down, bi, cx + right, cy + down, ci)


@kernel(inline=True)
def _top(cluster: NDArray[np.float32], number: int) -> float:
    """Return z of the highest corner of eight triangles."""
    at = number * CLUSTER_ROWS * CLUSTER + 2 * CLUSTER
    b, c = load(cluster, at + 3 * CLUSTER), load(cluster, at + 6 * CLUSTER)
    return greater(greater(load(cluster, at), b), c)


@kernel
def _draw(
    geometry: Geometry,
    bake: ShadowBake,
    mesh: NDArray[np.int32],
    screen: Projection,
    flat: float,
    right: float,
    down: float,
    worker: int,
) -> None:
    """Draw what is above a height of one mesh, as seen from the sun, moved by some texels, leaves
    with their holes.

    Heights differ little across a leaf, so `fill` may use them in place of 1/distance.
    """
    prepared, key, size = bake.triangle[worker], bake.key[worker], float(BLOCK_TEXELS)
    for first in range(mesh[0], mesh[1], CLUSTER):
        cluster = first // CLUSTER
        corners = _project(geometry.cluster, cluster, screen, right, down)
        real, both_sides = lane_numbers() < i4(mesh[1] - first), lane_numbers() >= i4(0)
        real &= _top(geometry.cluster, cluster) > f4(flat)
        left = bits_of(set_up(corners, real, both_sides, 0.0, size, size, 0.0, prepared))
        if left != 0 and any_of(has_leaves(geometry.cluster, cluster)):
            at = geometry.uv_row[cluster] * UV_ROWS * CLUSTER
            set_up_leaves(corners, geometry.corner_uv, at, prepared)
        while left != 0:
            number = first_bit(left)
            left &= left - 1
            triangle = first + number
            material = material_of(geometry, triangle)
            drawn, holes = bake.cards[material], no_holes(geometry.texture)
            if drawn != 0:
                # A card has four triangles, or two. Counted in its mesh, so that the shade of a
                # tree does not change with what else stands in the map.
                if drawn < 0 or ((triangle - mesh[0]) >> 2) % drawn != 0:
                    continue
                holes = holes_of(
                    geometry.texture, i8(geometry.layer[material]) * LEVELS + LEAF_LEVEL
                )
            fill(prepared, number, 0, BLOCK_TEXELS, key, i8(0), holes, bake.span[worker])
