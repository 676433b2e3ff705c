"""Small bodies of flat faces."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.overlay.canvas import CASING, NEAR, Canvas
from eyas.engine.overlay.items import Solid
from eyas.lanes import exact

SIDE = 4  # Number of samples along each side of a pixel
OUTLINE = 1.25  # Width of the outline, which lies outside the body, in strokes of the canvas
TOWARDS_LIGHT = np.array([0.36, 0.48, 0.8])  # World frame, of length 1
SHADE = 0.55  # Brightness of a face that is turned away from the light; a face towards it has 1


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
    """Return one over the depth [1/m], and the triangle (or -1), of each sample of a window, from
    vertices (V, 3): column, row [pixels], depth [m].
    """
    rows, columns = where
    shape = (rows.stop - rows.start) * SIDE, (columns.stop - columns.start) * SIDE
    near, face = np.zeros(shape[0] * shape[1]), np.full(shape[0] * shape[1], -1, np.int64)
    on_grid = np.array([columns.start, rows.start])
    corners = ((vertices[:, :2] - on_grid) * SIDE - 0.5)[triangles]  # sample k is at k
    first, last, row, of = _spans(corners, shape)
    count, x = last - first, _counted(first, last)
    shares = _shares(corners[of], row, count, x)
    inside = np.flatnonzero(np.logical_and.reduce([share >= 0.0 for share in shares]))
    span = np.repeat(np.arange(len(of)), count)[inside]
    t, sample = of[span], (row * shape[1])[span] + x[inside]
    value = np.zeros(len(t))
    for share, corner in zip(shares, triangles.T, strict=True):
        value += share[inside] * (1.0 / vertices[corner, 2])[t]
    np.maximum.at(near, sample, value)
    nearest = np.flatnonzero(value == near[sample])[::-1]  # of equals, the first stays
    face[sample[nearest]] = t[nearest]
    return near.reshape(shape), face.reshape(shape)


def _spans(
    corners: NDArray[np.float64], shape: tuple[int, int]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return the spans of triangles (T, 3, 2) that face the camera, one for each of their rows of
    samples: first and last column (excluded; one too many at each end), row, and triangle.
    """
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(corners, 0, -1)
    # Rows grow downwards: the front is clockwise in the picture.
    front = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) < 0.0
    low = np.clip(np.ceil(corners.min(axis=1)), 0, shape[::-1]).astype(np.int64)
    high = np.clip(np.floor(corners.max(axis=1)) + 1, 0, shape[::-1]).astype(np.int64)
    height = np.where(front, np.maximum(high - low, 0)[:, 1], 0)
    of = np.repeat(np.arange(len(corners)), height)
    row = _counted(low[:, 1], low[:, 1] + height)
    left, right = np.full(len(of), np.inf), np.full(len(of), -np.inf)
    for k in range(3):
        (ax, ay), (bx, by) = corners[of, k].T, corners[of, k - 1].T
        crossed = ((row - ay) * (row - by) <= 0.0) & (ay != by)
        at = ax + (row - ay) * (bx - ax) / np.where(crossed, by - ay, 1.0)
        left = np.minimum(left, np.where(crossed, at, np.inf))
        right = np.maximum(right, np.where(crossed, at, -np.inf))
    # Where nothing is crossed, there is no sample either.
    first = np.clip(np.floor(left), low[of, 0], high[of, 0]).astype(np.int64)
    last = np.clip(np.ceil(right) + 1.0, first, high[of, 0]).astype(np.int64)
    return first, last, row, of


def _counted(first: NDArray[np.int64], last: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the numbers from each first to each last (excluded), one after the other."""
    count = last - first
    begin = np.cumsum(count) - count
    counted: NDArray[np.int64] = np.arange(count.sum()) + np.repeat(first - begin, count)
    return counted


def _shares(
    corners: NDArray[np.float64],
    row: NDArray[np.int64],
    count: NDArray[np.int64],
    x: NDArray[np.int64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the barycentric coordinates of samples, three arrays: of K spans with the corners (K,
    3, 2) of their triangles, their rows and numbers of samples, and `x`, the columns of all
    samples.
    """
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(corners, 0, -1)
    area = np.repeat((bx - ax) * (cy - ay) - (by - ay) * (cx - ax), count)
    right = x - np.repeat(ax, count)
    b = (right * np.repeat(cy - ay, count) - np.repeat((row - ay) * (cx - ax), count)) / area
    c = (np.repeat((bx - ax) * (row - ay), count) - np.repeat(by - ay, count) * right) / area
    return 1.0 - b - c, b, c


def _shaded(solid: Solid) -> NDArray[np.float64]:
    """Return the colour of each face in the light, sRGB 0 to 1, shape (T, 3)."""
    a, b, c = np.moveaxis(solid.positions[solid.triangles], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    light = 0.5 + exact.product(0.5 * normal, TOWARDS_LIGHT)
    shaded: NDArray[np.float64] = solid.colours * (SHADE + (1.0 - SHADE) * light)[:, None]
    return shaded


def _grown(mask: NDArray[np.bool_], radius: int) -> NDArray[np.bool_]:
    """Return which samples are at most `radius` away from a sample in a mask."""
    height, width = mask.shape
    padded = np.pad(mask, radius)
    grown = np.zeros_like(mask)
    for dy in range(-radius, radius + 1):
        reach = math.isqrt(radius * radius - dy * dy)
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
