"""Draws an overlay over finished pictures; nearer surfaces hide it, by their depths."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from eyas.engine.overlay.canvas import CASING, NEAR, Canvas, cover
from eyas.engine.overlay.items import GroundArea, Label, Overlay, ThinLine
from eyas.engine.overlay.solid import paint_solid
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.terrain import Plane, height_over
from eyas.lanes import exact, interpreted

# Convex areas, painted on the ground that a picture shows.
#
# Ground pixels are found by their depth: their surface is about as high as the ground. So walls and
# cars hide the paint. A line on the ground and the optical centre span a plane, so the line is
# straight in the picture too, and a pixel's distance from it is that plane's equation over the
# length of its gradient. So lines are smooth and as wide at any distance and angle.

_height_over = interpreted(height_over)

RISE = 0.3
"""Tolerance in height within which a surface counts as ground [m]: roads and kerbs are higher."""

_EDGE = 0.14  # Width of the line [m]
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
        line = _beyond(canvas, start + _EDGE * inwards, along, where)
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


SMALLEST, OF_HEIGHT = 9, 0.042
"""Size of letters: a share of the picture's height, but at least this many pixels."""

OUTLINE = 0.85  # Opacity of the outline of letters: legible on black and on white (WCAG 2.2, 1.4.3)


def paint_labels(canvas: Canvas, labels: Sequence[Label]) -> None:
    """Paint labels beside their points, moved if needed to be fully inside the picture."""
    size = max(SMALLEST, round(OF_HEIGHT * canvas.height))
    gap = 0.5 * size
    for label in labels:
        letters, around = _masks(label.text, size)
        height, width = letters.shape
        column, row, depth = canvas.project(label.anchor)
        inside = depth >= NEAR and 0 <= column < canvas.width and 0 <= row < canvas.height
        if inside:
            beside = label.clear * canvas.across / depth
            left, top = column + beside + gap, row - 0.5 * height
        elif label.always:
            left, top = float(gap), float(gap)
        else:
            continue
        left = int(np.clip(round(left), 0, max(canvas.width - width, 0)))
        top = int(np.clip(round(top), 0, max(canvas.height - height, 0)))
        bottom, right = min(top + height, canvas.height), min(left + width, canvas.width)
        where = slice(top, bottom), slice(left, right)
        part = np.s_[: bottom - top, : right - left]
        canvas.blend(where, CASING, around[part] * OUTLINE)
        canvas.blend(where, label.colour, letters[part])


@lru_cache(maxsize=64)
def _masks(text: str, size: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the share of each pixel that letters cover, without and with an outline."""
    from PIL import Image, ImageDraw, ImageFont  # only where there are labels

    font = ImageFont.load_default(size)
    stroke = max(1, round(size / 8))
    left, top, right, bottom = font.getbbox(text)
    box = math.ceil(right - left) + 2 * stroke, math.ceil(bottom - top) + 2 * stroke
    at = stroke - left, stroke - top
    masks = []
    for width in (0, stroke):
        image = Image.new("L", box)
        ImageDraw.Draw(image).text(at, text, fill=255, font=font, stroke_width=width)
        masks.append(np.asarray(image, np.float32) / np.float32(255.0))
    return masks[0], masks[1]


WIDTH = 1.5  # Width of a line, in strokes of the canvas
OPACITY = 0.85  # Opacity of a line
BENT_PIECES = 24  # Straight pieces of a line that is seen through a lens


def paint_line(canvas: Canvas, line: ThinLine) -> None:
    """Paint the part of a line that is in front of the camera and of the picture's surfaces."""
    ends = _before_the_camera(canvas, line)
    if ends is None:
        return
    pieces = 1 if canvas.lens is None else BENT_PIECES
    places = canvas.project(np.linspace(ends[0], ends[1], pieces + 1))
    for start, end in pairwise(places):
        _paint_piece(canvas, line, start, end)


def _paint_piece(
    canvas: Canvas, line: ThinLine, start: NDArray[np.float64], end: NDArray[np.float64]
) -> None:
    """Paint a piece of a line, from one place to another: column, row [pixels] and depth [m]."""
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
    casing = seen * cover(half + 0.75 * canvas.unit - away) * 0.4  # our choice
    canvas.blend_pixels(rows, columns, CASING, casing)
    canvas.blend_pixels(rows, columns, line.colour, seen * cover(half - away))


def _near(
    canvas: Canvas, start: NDArray[np.float64], end: NDArray[np.float64], margin: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return rows and columns of the pixels within `margin` [pixels] of a line between two places
    (column, row, ...).
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


def _before_the_camera(canvas: Canvas, line: ThinLine) -> np.ndarray | None:
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


def with_depth(picture: Picture) -> Picture:
    """Return the picture with an array for depths; the other arrays are shared.

    Raises:
        ValueError: The picture has no colours to draw over.
    """
    if picture.rgb is None:
        raise ValueError("picture: rgb is needed; the overlay is drawn over it")
    if picture.depth is not None:
        return picture
    return replace(picture, depth=np.empty(picture.rgb.shape[:3], np.float32))


def paint_overlays(
    views: Views,  # The V cameras with which the picture was drawn
    overlays: Sequence[Overlay],  # One for each view
    picture: Picture,  # With colours and depths
) -> None:
    """Draw over the colours of a picture; its other arrays do not change."""
    assert picture.rgb is not None
    assert picture.depth is not None
    for v, overlay in enumerate(overlays):
        canvas = Canvas(views, v, picture.rgb[v], picture.depth[v])
        for area in overlay.areas:
            paint_area(canvas, area)
        for line in overlay.lines:
            paint_line(canvas, line)
        for solid in overlay.solids:
            paint_solid(canvas, solid)
        paint_labels(canvas, overlay.labels)
        picture.rgb[v] = canvas.finished()
