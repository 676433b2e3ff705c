"""The shadow map: height towards the sun of the first surface that sunlight meets."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.core.parallel import Pointer, parallel_kernel
from eyas.render.kernels.bundles import Geometry
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.visibility.rasterise import BOTH_SIDES, rasterise

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

    geometry: Geometry
    cards: NDArray[np.int32]
    """For each material: 0 if it is solid; n if one leaf card in n is drawn, with its holes; -1
    if none is drawn."""
    thin: NDArray[np.bool_]
    """Whether each prototype of the fixtures may be narrower than a texel."""
    rows: NDArray[np.float64]
    """World to column, row and height of the map, shape (3, 4); heights are 1 to 65535."""
    screen: NDArray[np.float64]
    """Working memory, shape (K, vertices of the largest mesh, 5)."""
    object_rows: NDArray[np.float64]
    """Working memory, shape (K, 3, 4)."""
    depth: NDArray[np.float32]
    """Working memory, shape (K, BAND, columns)."""
    owner: NDArray[np.int64]
    """Working memory, shape (K, BAND, columns)."""
    shadow_map: NDArray[np.uint16]
    """Filled, shape (lines, columns)."""


@parallel_kernel
def bake_rows(parts: Pointer[tuple[Pointer[ShadowBake]]], worker: int, workers: int) -> None:
    """Draw all static triangles and the finest level of all fixtures into the shadow map."""
    bake = parts[0][0][0]
    geometry, cards, thin, rows, all_screens, all_rows, depths, owners, shadow_map = bake
    screen, object_rows = all_screens[worker], all_rows[worker]
    depth, owner = depths[worker], owners[worker]
    for band in range(worker, (shadow_map.shape[0] + BAND - 1) // BAND, workers):
        depth[:] = f4(0.0)
        top = band * BAND
        for chunk in range(len(geometry.chunk_range)):
            _draw(geometry, cards, rows, geometry.chunk_range[chunk], top, screen, depth, owner)
        for i in range(len(geometry.fixture_prototype)):
            prototype = geometry.fixture_prototype[i]
            ranges = geometry.mesh_range[geometry.level_first[prototype]]
            for side in range(4 if thin[prototype] else 1):
                _set_object_rows(rows, geometry.fixture_pose[i], object_rows)
                if thin[prototype]:
                    object_rows[0, 3] += THICKER if side & 1 else -THICKER
                    object_rows[1, 3] += THICKER if side & 2 else -THICKER
                _draw(geometry, cards, object_rows, ranges, top, screen, depth, owner)
        for line in range(min(BAND, shadow_map.shape[0] - top)):
            for column in range(shadow_map.shape[1]):
                height = min(depth[line, column], f4(65535.0))
                shadow_map[top + line, column] = np.uint16(height)


@inner_kernel
def _set_object_rows(
    rows: NDArray[np.float64], pose: NDArray[np.float32], product: NDArray[np.float64]
) -> None:
    for i in range(3):
        for k in range(4):
            product[i, k] = (
                rows[i, 0] * pose[0, k] + rows[i, 1] * pose[1, k] + rows[i, 2] * pose[2, k]
            )
        product[i, 3] += rows[i, 3]


@inner_kernel
def _draw(
    geometry: Geometry,
    cards: NDArray[np.int32],
    rows: NDArray[np.float64],
    ranges: NDArray[np.int32],
    top: int,
    screen: NDArray[np.float64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
) -> None:
    """Draw one mesh from above the sun, leaves with their holes.

    Heights differ little across a leaf, so `rasterise` may use them in place of 1/w.
    """
    lowest, highest = 1e9, -1e9
    for i in range(ranges[3] - ranges[2]):
        x = geometry.positions[ranges[2] + i, 0]
        y = geometry.positions[ranges[2] + i, 1]
        z = geometry.positions[ranges[2] + i, 2]
        for k in range(3):
            screen[i, k] = rows[k, 0] * x + rows[k, 1] * y + rows[k, 2] * z + rows[k, 3]
        screen[i, 3] = geometry.uvs[ranges[2] + i, 0]
        screen[i, 4] = geometry.uvs[ranges[2] + i, 1]
        lowest, highest = min(lowest, screen[i, 1]), max(highest, screen[i, 1])
    if lowest > top + BAND or highest < top:
        return
    for triangle in range(ranges[0], ranges[1]):
        a = geometry.corners[triangle, 0] - ranges[2]
        b = geometry.corners[triangle, 1] - ranges[2]
        c = geometry.corners[triangle, 2] - ranges[2]
        material = geometry.material[triangle]
        drawn, level = cards[material], -1
        if drawn != 0:
            level = LEAF_LEVEL
            # A card has four triangles, or two. Counted in its mesh, so that the shade of a tree
            # does not change with what else stands in the map.
            if drawn < 0 or ((triangle - ranges[0]) >> 2) % drawn != 0:
                continue
        rasterise(
            screen, a, b, c, top, depth, owner, i8(0), BOTH_SIDES, geometry.texture,
            geometry.layer[material], level,
        )  # fmt: skip
