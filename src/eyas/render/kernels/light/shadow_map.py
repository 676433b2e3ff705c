"""The shadow map: height towards the sun of the first surface that sunlight meets."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.core.lanes import any_of, bits_of, first_bit, lane_numbers, load, to_f8
from eyas.core.parallel import Pointer, parallel_kernel
from eyas.render.kernels.bundles import Geometry, Projection, Row
from eyas.render.kernels.scalars import f4, i4, i8
from eyas.render.kernels.visibility.clusters import (
    CLUSTER,
    CLUSTER_ROWS,
    UV_ROWS,
    has_leaves,
)
from eyas.render.kernels.visibility.fill import fill
from eyas.render.kernels.visibility.holes import holes_of, no_holes
from eyas.render.kernels.visibility.key import distance_inverse
from eyas.render.kernels.visibility.transform import object_projection
from eyas.render.kernels.visibility.triangles import Corners, set_up, set_up_leaves

__all__ = ["BAND", "ShadowBake", "bake_rows"]

BAND = 256
"""Rows of the map that are drawn at a time."""

LEAF_LEVEL = 3
"""Mip level of the holes between leaves, matched to the size of the map's texels."""

THICKER = 0.3
"""Margin added to all sides of thin things [texels]: the shadow of a pole narrower than a
texel would break into pieces."""


class ShadowBake(NamedTuple):
    """Input and output of `bake_rows`, K workers."""

    cards: NDArray[np.int32]
    """For each material: 0 if it is solid; n if one leaf card in n is drawn, with its holes; -1
    if none is drawn."""
    thin: NDArray[np.bool_]
    """Whether each prototype of the fixtures may be narrower than a texel."""
    sun: Projection
    """World to column and row of the map and, in place of the distance, height, 1 to 65535."""
    triangle: NDArray[np.float64]
    """Working memory, see `Scratch`, shape (K, TRIANGLE_ROWS, 8)."""
    span: NDArray[np.int32]
    """Working memory, see `Scratch`, shape (K, SPAN_ROWS, 8)."""
    key: NDArray[np.int64]
    """Working memory, see `Scratch`, with heights in place of 1/distance; shape (K, BAND, at least
    as many columns as the map has)."""
    shadow_map: NDArray[np.uint16]
    """Filled, shape (lines, columns)."""


@parallel_kernel
def bake_rows(parts: Pointer[tuple[Geometry, ShadowBake]], worker: int, workers: int) -> None:
    """Draw all static triangles and the finest level of all fixtures into the shadow map."""
    geometry, bake = parts[0]
    key, shadow_map, thin = bake.key[worker], bake.shadow_map, bake.thin
    for band in range(worker, (shadow_map.shape[0] + BAND - 1) // BAND, workers):
        key[:] = 0
        top = band * BAND
        for chunk in range(len(geometry.chunk_range)):
            _draw(geometry, bake, geometry.chunk_range[chunk], bake.sun, 0.0, 0.0, top, worker)
        for i in range(len(geometry.fixture_prototype)):
            prototype = geometry.fixture_prototype[i]
            mesh = geometry.mesh_range[geometry.level_first[prototype]]
            screen = object_projection(bake.sun, geometry.fixture_pose, i)
            for side in range(4 if thin[prototype] else 1):
                right, down = 0.0, 0.0
                if thin[prototype]:
                    right = THICKER if side & 1 else -THICKER
                    down = THICKER if side & 2 else -THICKER
                _draw(geometry, bake, mesh, screen, right, down, top, worker)
        for line in range(min(BAND, shadow_map.shape[0] - top)):
            for column in range(shadow_map.shape[1]):
                height = min(distance_inverse(key[line, column]), f4(65535.0))
                shadow_map[top + line, column] = np.uint16(height)


@inlined_kernel
def _along(row: Row, x: float, y: float, z: float) -> float:
    return row.x * x + row.y * y + row.z * z + row.w


@inlined_kernel
def _corner(
    cluster: NDArray[np.float32], at: int, screen: Projection
) -> tuple[float, float, float]:
    x = to_f8(load(cluster, at))
    y = to_f8(load(cluster, at + CLUSTER))
    z = to_f8(load(cluster, at + 2 * CLUSTER))
    return (
        _along(screen.column, x, y, z),
        _along(screen.row, x, y, z),
        _along(screen.distance, x, y, z),
    )


@inlined_kernel
def _project(
    cluster: NDArray[np.float32], number: int, screen: Projection, right: float, down: float
) -> Corners:
    """Project eight triangles; heights take the place of 1/distance."""
    at = number * CLUSTER_ROWS * CLUSTER
    ax, ay, ai = _corner(cluster, at, screen)
    bx, by, bi = _corner(cluster, at + 3 * CLUSTER, screen)
    cx, cy, ci = _corner(cluster, at + 6 * CLUSTER, screen)
    return Corners(ax + right, ay + down, ai, bx + right, by + down, bi, cx + right, cy + down, ci)


@inner_kernel
def _draw(
    geometry: Geometry,
    bake: ShadowBake,
    mesh: NDArray[np.int32],
    screen: Projection,
    right: float,
    down: float,
    top: int,
    worker: int,
) -> None:
    """Draw one mesh from above the sun, moved by some texels, leaves with their holes.

    Heights differ little across a leaf, so `fill` may use them in place of 1/distance.
    """
    prepared, key, width = bake.triangle[worker], bake.key[worker], bake.shadow_map.shape[1]
    for first in range(mesh[0], mesh[1], CLUSTER):
        cluster = first // CLUSTER
        corners = _project(geometry.cluster, cluster, screen, right, down)
        real, both_sides = lane_numbers() < i4(mesh[1] - first), lane_numbers() >= i4(0)
        left = bits_of(
            set_up(
                corners, real, both_sides, float(top), float(top + BAND), float(width), 0.0,
                prepared,
            )
        )  # fmt: skip
        if left != 0 and any_of(has_leaves(geometry.cluster, cluster)):
            set_up_leaves(corners, geometry.corner_uv, cluster * UV_ROWS * CLUSTER, prepared)
        while left != 0:
            number = first_bit(left)
            left &= left - 1
            triangle = first + number
            material = geometry.material[triangle]
            drawn, holes = bake.cards[material], no_holes(geometry.texture)
            if drawn != 0:
                # A card has four triangles, or two. Counted in its mesh, so that the shade of a
                # tree does not change with what else stands in the map.
                if drawn < 0 or ((triangle - mesh[0]) >> 2) % drawn != 0:
                    continue
                holes = holes_of(geometry.texture, geometry.layer[material], LEAF_LEVEL)
            fill(prepared, number, top, width, key, i8(0), holes, bake.span[worker])
