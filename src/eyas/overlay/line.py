"""Thin lines through the air."""

import numpy as np

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
    margin = WIDTH * canvas.unit + 1.0
    low, high = np.minimum(start, end)[:2], np.maximum(start, end)[:2]
    where = canvas.window(low, high, margin)
    rows, columns = np.mgrid[where] + 0.5
    along = end[:2] - start[:2]
    length = float(np.hypot(*along))
    if length < 1e-9 or not rows.size:
        return
    right, below = columns - start[0], rows - start[1]
    share = np.clip((right * along[0] + below * along[1]) / length**2, 0.0, 1.0)
    away = np.hypot(right - share * along[0], below - share * along[1])
    # One over the depth is linear in the picture; the depth is not.
    depth = 1.0 / ((1.0 - share) / start[2] + share / end[2])
    seen = (depth <= canvas.depth[where]) * OPACITY
    half = 0.5 * WIDTH * canvas.unit
    canvas.blend(where, CASING, seen * cover(half + 0.75 * canvas.unit - away) * 0.4)
    canvas.blend(where, line.colour, seen * cover(half - away))


def _before_the_camera(canvas: Canvas, line: Line) -> np.ndarray | None:
    """Return the ends of the part beyond the near plane, shape (2, 3), or None."""
    ends = np.stack([line.start, line.end]).astype(np.float64)
    depth = (ends - canvas.position) @ canvas.rotation[:, 0]
    near = depth < NEAR
    if near.all():
        return None
    if near.any():
        share = (NEAR - depth[0]) / (depth[1] - depth[0])
        ends[int(near[1])] = ends[0] + share * (ends[1] - ends[0])
    return ends
