"""Thin lines through the air."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact
from eyas.overlay.canvas import CASING, NEAR, Canvas, cover
from eyas.overlay.items import Line

__all__ = ["paint_line"]

WIDTH = 1.5
"""Width, in strokes of the canvas."""

OPACITY = 0.85


def paint_line(canvas: Canvas, line: Line) -> None:
    """Paint the part of a line that is in front of the camera and of the picture's surfaces."""
    ends = _before_the_camera(canvas, line)
    if ends is None:
        return
    start, end = canvas.project(ends)
    along = end[:2] - start[:2]
    length = float(exact.hypot(*along))
    if length < 1e-9:
        return
    rows, columns = _near(canvas, start, end, WIDTH * canvas.unit + 1.0)
    right, below = columns + 0.5 - start[0], rows + 0.5 - start[1]
    share = np.clip((right * along[0] + below * along[1]) / np.square(length), 0.0, 1.0)
    away = exact.hypot(right - share * along[0], below - share * along[1])
    # One over the depth is linear in the picture; the depth is not.
    depth = 1.0 / ((1.0 - share) / start[2] + share / end[2])
    seen = (depth <= canvas.depth[rows, columns]) * OPACITY
    half = 0.5 * WIDTH * canvas.unit
    casing = seen * cover(half + 0.75 * canvas.unit - away) * 0.4
    canvas.blend_pixels(rows, columns, CASING, casing)
    canvas.blend_pixels(rows, columns, line.colour, seen * cover(half - away))


def _near(
    canvas: Canvas, start: NDArray[np.float64], end: NDArray[np.float64], margin: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return rows and columns of the pixels in a box around a line that lie near it.

    Args:
        canvas: The picture.
        start: Column and row of one end, and whatever else [pixels].
        end: Of the other.
        margin: How far around the ends the box reaches, and how near pixels are at least [pixels].
    """
    low, high = np.minimum(start, end)[:2], np.maximum(start, end)[:2]
    where = canvas.window(low, high, margin)
    along = end[:2] - start[:2]
    major = int(abs(along[1]) > abs(along[0]))  # 0: columns are counted, 1: rows
    steps, cross = where[1 - major], where[major]
    k = np.arange(steps.start, steps.stop)
    slope = along[1 - major] / along[major]
    middle = start[1 - major] + slope * (k + 0.5 - start[major])
    reach = math.ceil(1.5 * margin) + 1  # measured across the axis, a line is up to 1.42 as wide
    other = np.floor(middle).astype(np.int64)[:, None] + np.arange(-reach, reach + 1)
    inside = (other >= cross.start) & (other < cross.stop)
    counted = np.broadcast_to(k[:, None], other.shape)[inside]
    return (counted, other[inside]) if major else (other[inside], counted)


def _before_the_camera(canvas: Canvas, line: Line) -> np.ndarray | None:
    """Return the ends of the part beyond the near plane, shape (2, 3), or None."""
    ends = np.stack([line.start, line.end]).astype(np.float64)
    depth = exact.product(ends - canvas.position, canvas.rotation[:, 0])
    near = depth < NEAR
    if near.all():
        return None
    if near.any():
        share = (NEAR - depth[0]) / (depth[1] - depth[0])
        ends[int(near[1])] = ends[0] + share * (ends[1] - ends[0])
    return ends
