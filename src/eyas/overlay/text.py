"""Text in the picture."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from eyas.overlay.canvas import CASING, NEAR, Canvas
from eyas.overlay.items import Label

__all__ = ["paint_labels"]

SMALLEST, OF_HEIGHT = 9, 0.042
"""Size of letters: a share of the picture's height, but at least this many pixels."""


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
        canvas.blend(where, CASING, around[part] * 0.85)
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
