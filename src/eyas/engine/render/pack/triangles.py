"""Data of each triangle for shading, computed once."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import LOOK_COLUMNS, SHADING_COLUMNS
from eyas.engine.render.pack.materials import MaterialTable
from eyas.lanes import exact

_SLIVER = 1e-12
"""Squared sine of the least angle between sides: thousands of times the rounding of a float64."""


def solid_triangles(
    corners: NDArray[np.float32],  # [m], shape (T, 3, 3)
) -> NDArray[np.bool_]:
    """Return which triangles have an area, shape (T,)."""
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    e1, e2 = b - a, c - a
    solid: NDArray[np.bool_] = exact.lengths(exact.cross(e1, e2)) > 1e-10
    # `gradients` divides by this difference, in which the rounding of its terms remains: of a long
    # sliver nothing else may be left, although its area is not 0.
    whole = _dot(e1, e1) * _dot(e2, e2)
    square = whole - np.square(_dot(e1, e2))
    return solid & (square > _SLIVER * whole)[:, 0]


def gradients(
    corners: NDArray[np.float32],  # Of triangles with an area [m], shape (T, 3, 3)
    normals: NDArray[np.float32],  # Unit normals there, shape (T, 3, 3)
    uvs: NDArray[np.float32],  # Texture coordinates there [tiles], shape (T, 3, 2)
) -> NDArray[np.float32]:
    """Return how texture coordinates and normals change on triangles, shape (T, 24): a corner;
    then gradient and value at that corner of u and of v; normal at the corner; gradients of the
    three components of the normal; texture tiles in a metre, negative where the normal is bent.

    A linear quantity on a triangle is `value + gradient @ (point - corner)`, with a gradient in
    the triangle's plane.
    """
    corner, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    e1, e2 = b - corner, c - corner
    d11, d12, d22 = _dot(e1, e1), _dot(e1, e2), _dot(e2, e2)
    square = d11 * d22 - d12 * d12
    toward_b = (d22 * e1 - d12 * e2) / square
    toward_c = (d11 * e2 - d12 * e1) / square

    uv = uvs.astype(np.float64)
    # Whole repeats have no effect, and small numbers keep their precision; a shift of 64 repeats
    # does not change the choice of lit windows either.
    uv -= 64.0 * np.floor(uv[:, :1] / 64.0)
    normal = normals.astype(np.float64)
    du1, du2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    dn1, dn2 = normal[:, 1] - normal[:, 0], normal[:, 2] - normal[:, 0]

    table = np.empty((len(corners), 24))
    table[:, 0:3] = corner
    for k in range(2):
        table[:, 3 + 4 * k : 6 + 4 * k] = du1[:, k, None] * toward_b + du2[:, k, None] * toward_c
        table[:, 6 + 4 * k] = uv[:, 0, k]
    table[:, 11:14] = normal[:, 0]
    for k in range(3):
        table[:, 14 + 3 * k : 17 + 3 * k] = dn1[:, k, None] * toward_b + dn2[:, k, None] * toward_c
    tiles = np.abs(du1[:, 0] * du2[:, 1] - du2[:, 0] * du1[:, 1])
    table[:, 23] = np.sqrt(tiles / np.sqrt(square[:, 0]))
    bent = np.abs(table[:, 14:23]).max(axis=1) > 0.0
    table[bent, 23] = -np.maximum(table[bent, 23], 1e-12)
    return table.astype(np.float32)


def shading_rows(
    slopes: NDArray[np.float32],  # From `gradients`
    objects: NDArray[np.int32],  # Object ids, shape (T,)
    materials: NDArray[np.int32],  # Shape (T,)
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return `Geometry.shading`, one cache line for each triangle, and `Geometry.bent`."""
    rows = np.empty((len(slopes), SHADING_COLUMNS), np.float32)
    whole = rows.view(np.int32)
    rows[:, :14] = slopes[:, :14]
    rows[:, 14] = slopes[:, 23]
    whole[:, 15] = (objects << 16) | materials
    bent = np.flatnonzero(slopes[:, 23] < 0.0)
    whole[bent, 11] = np.arange(len(bent))
    return rows, np.concatenate([slopes[bent, 14:23], slopes[bent, 11:14]], axis=1)


def looks_of(materials: MaterialTable) -> NDArray[np.float32]:
    """Return `Geometry.look`."""
    rows = np.zeros((len(materials.layer), LOOK_COLUMNS), np.float32)
    whole = rows.view(np.int32)
    whole[:, 0] = materials.layer
    whole[:, 1] = materials.surface | (materials.snow_bed << 8)
    rows[:, 2:5] = materials.tint
    rows[:, 5] = materials.emission
    rows[:, 6] = materials.crown_middle
    return rows


def materials_of(shading: NDArray[np.float32]) -> NDArray[np.int32]:
    """Return the material of each triangle from `Geometry.shading`, shape (T,)."""
    return shading.view(np.int32)[:, 15] & np.int32(0xFFFF)


def _dot(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    product: NDArray[np.float64] = exact.dot(a, b)
    return product[:, None]
