"""Convex areas, painted on the ground that a picture shows.

Ground pixels are found by their depth: their surface is about as high as the ground. So walls and
cars hide the paint. A line on the ground and the optical centre span a plane, so the line is
straight in the picture too, and a pixel's distance from it is that plane's equation over the length
of its gradient. This makes lines smooth and of constant width at any distance and angle.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.overlay.canvas import CASING, NEAR, Canvas, cover
from eyas.engine.overlay.items import GroundArea
from eyas.engine.state.terrain import Plane, height_over
from eyas.lanes import exact, interpreted

_height_over = interpreted(height_over)

RISE = 0.3
"""Tolerance in height within which a surface counts as ground [m]: roads and kerbs are higher."""

WIDTH = 0.14  # Width of the line [m]
THINNEST = 1.75  # Smallest width of the line, in strokes of the canvas

Window = tuple[slice, slice]
Floats = NDArray[np.float32]


def paint_area(canvas: Canvas, area: GroundArea) -> None:
    """Paint an area: casing, line and casing inside its edge, then its fill."""
    if len(area.corners) < 3 or _height_over(area.ground, *canvas.position) <= RISE:
        return
    where = _window(canvas, area.corners)
    outer, inner = _inside(canvas, area.corners, where)
    casing = canvas.unit
    shape, fill = cover(outer), cover(inner - 2.0 * casing)
    line = cover(outer - casing) - cover(inner - casing)
    on = _on_ground(canvas, area.ground, where)
    canvas.blend(where, area.colour, on * fill * area.fill)
    canvas.blend(where, CASING, on * (shape - fill - line) * 0.6)
    canvas.blend(where, area.colour, on * line)


def _window(canvas: Canvas, corners: NDArray[np.float64]) -> Window:
    """Return the rows and columns of the area; all if a part is behind the camera, or bent."""
    places = canvas.project(corners)
    if (places[:, 2] < NEAR).any() or canvas.lens is not None:  # edges may bend out of their box
        return slice(0, canvas.height), slice(0, canvas.width)
    return canvas.window(places[:, :2].min(axis=0), places[:, :2].max(axis=0), 1.0)


def _on_ground(canvas: Canvas, ground: Plane, where: Window) -> NDArray[np.bool_]:
    """Return which pixels of a window show a surface about as high as the ground."""
    upwards = (
        canvas.rotation[2]
        - ground.rise_east * canvas.rotation[0]
        - ground.rise_north * canvas.rotation[1]
    )
    falling = canvas.plane(upwards, where)
    with np.errstate(invalid="ignore"):  # infinity * 0 for sky pixels at the horizon
        rise = canvas.depth[where] * falling + np.float32(_height_over(ground, *canvas.position))
    on: NDArray[np.bool_] = np.abs(rise) < RISE
    return on


def _inside(canvas: Canvas, corners: NDArray[np.float64], where: Window) -> tuple[Floats, Floats]:
    """Return how far pixels are inside the edge, and inside the line along it [pixels]; corners (K,
    3) are counter-clockwise seen from above.
    """
    outer = inner = np.full((1, 1), np.inf, np.float32)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = end - start
        length = float(exact.hypot(along[0], along[1]))
        if length < 1e-9:
            continue
        inwards = np.array([-along[1], along[0], 0.0]) / length
        edge = _beyond(canvas, start, along, where)
        line = _beyond(canvas, start + WIDTH * inwards, along, where)
        outer = np.minimum(outer, edge)
        thinnest = np.float32(THINNEST * canvas.unit)
        inner = np.minimum(inner, np.minimum(line, edge - thinnest))
    return outer, inner


def _beyond(
    canvas: Canvas, point: NDArray[np.float64], along: NDArray[np.float64], where: Window
) -> Floats:
    """Return how far pixels are to the left of a line on the ground, in the picture [pixels]."""
    offset = point - canvas.position
    normal = exact.product(canvas.rotation.T, np.cross(along, offset))
    return canvas.distance(normal, where)
