"""Draws an overlay over finished pictures; nearer surfaces hide it, by their depths."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from eyas.overlay.area import paint_area
from eyas.overlay.canvas import Canvas
from eyas.overlay.items import Overlay
from eyas.overlay.line import paint_line
from eyas.overlay.solid import paint_solid
from eyas.overlay.text import paint_labels
from eyas.state.draw import Picture, Views

__all__ = ["paint_overlays", "with_depth"]


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


def paint_overlays(views: Views, overlays: Sequence[Overlay], picture: Picture) -> None:
    """Draw over the colours of a picture; its other arrays do not change.

    Args:
        views: The V cameras with which the picture was drawn.
        overlays: One for each view.
        picture: With colours and depths.
    """
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
