"""Small bodies of flat faces."""

import numpy as np
from numpy.typing import NDArray

from eyas.overlay.canvas import CASING, NEAR, Canvas
from eyas.overlay.items import Solid

__all__ = ["paint_solid"]

SIDE = 4
"""Number of samples along each side of a pixel."""

OUTLINE = 1.25
"""Width of the outline, which lies outside the body, in strokes of the canvas."""

TOWARDS_LIGHT = np.array([0.36, 0.48, 0.8])
SHADE = 0.55
"""Brightness of a face that is turned away from the light; a face towards it has 1."""


def paint_solid(canvas: Canvas, solid: Solid) -> None:
    """Paint a body, unless a part of it is at or behind the camera."""
    vertices = canvas.project(solid.positions)
    if (vertices[:, 2] < NEAR).any():
        return
    outline = OUTLINE * canvas.unit
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    where = canvas.window(low, high, outline + 1.0)
    height, width = (part.stop - part.start for part in where)
    if not height * width:
        return
    near, face = _sample(vertices, solid.triangles, where)
    scene = np.repeat(np.repeat(canvas.depth[where], SIDE, 0), SIDE, 1)
    body = face >= 0
    # The outline has the depth of the body's nearest point; else the ground would cut it off.
    edge = _grown(body, round(outline * SIDE)) & ~body & (scene > vertices[:, 2].min())
    body &= near >= 1.0 / scene
    colours = _shaded(solid)[np.where(body, face, -1)] * body[..., None]
    share = _averaged(body.astype(np.float64))
    canvas.blend(where, CASING, _averaged((edge | body).astype(np.float64)))
    colour = _averaged(colours) / np.maximum(share, 1e-9)[..., None]
    canvas.blend(where, colour, share)


def _sample(
    vertices: NDArray[np.float64], triangles: NDArray[np.int32], where: tuple[slice, slice]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return one over the depth, and the triangle (or -1), of each sample of a window.

    Args:
        vertices: Column, row [pixels] and depth [m], shape (V, 3).
        triangles: Shape (T, 3).
        where: Rows and columns.
    """
    rows, columns = where
    shape = (rows.stop - rows.start) * SIDE, (columns.stop - columns.start) * SIDE
    near, face = np.zeros(shape), np.full(shape, -1, np.int64)
    on_grid = np.array([columns.start, rows.start])
    corners = (vertices[:, :2] - on_grid) * SIDE - 0.5  # sample k is at k
    for t, triangle in enumerate(triangles):
        (ax, ay), (bx, by), (cx, cy) = corners[triangle]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0.0:  # rows grow downwards: the front is clockwise in the picture
            continue
        low = np.clip(np.ceil(corners[triangle].min(axis=0)), 0, shape[::-1]).astype(int)
        high = np.clip(np.floor(corners[triangle].max(axis=0)) + 1, 0, shape[::-1]).astype(int)
        part = np.s_[low[1] : high[1], low[0] : high[0]]
        x, y = np.arange(low[0], high[0]), np.arange(low[1], high[1])[:, None]
        b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        a = 1.0 - b - c
        depths = 1.0 / vertices[triangle, 2]
        value = a * depths[0] + b * depths[1] + c * depths[2]
        hit = (a >= 0.0) & (b >= 0.0) & (c >= 0.0) & (value > near[part])
        near[part][hit] = value[hit]
        face[part][hit] = t
    return near, face


def _shaded(solid: Solid) -> NDArray[np.float64]:
    """Return the colour of each face in the light, sRGB 0 to 1, shape (T, 3)."""
    a, b, c = np.moveaxis(solid.positions[solid.triangles], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    light = 0.5 + 0.5 * normal @ TOWARDS_LIGHT
    shaded: NDArray[np.float64] = solid.colours * (SHADE + (1.0 - SHADE) * light)[:, None]
    return shaded


def _grown(mask: NDArray[np.bool_], radius: int) -> NDArray[np.bool_]:
    """Return which samples are at most `radius` away from a sample in a mask."""
    height, width = mask.shape
    padded = np.pad(mask, radius)
    grown = np.zeros_like(mask)
    for dy in range(-radius, radius + 1):
        reach = int((radius**2 - dy**2) ** 0.5)
        row = padded[radius + dy : radius + dy + height]
        # Runs in a row are found with cumulative sums.
        sums = np.pad(np.cumsum(row, axis=1), ((0, 0), (1, 0)))
        grown |= (
            sums[:, radius + reach + 1 : radius + reach + 1 + width]
            > sums[:, radius - reach : radius - reach + width]
        )
    return grown


def _averaged(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of each pixel's samples."""
    height, width = samples.shape[0] // SIDE, samples.shape[1] // SIDE
    blocks = samples.reshape(height, SIDE, width, SIDE, *samples.shape[2:])
    mean: NDArray[np.float64] = blocks.mean(axis=(1, 3))
    return mean
