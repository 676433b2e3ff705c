"""A brush for regions of textures, in metres: lines, boxes and frames with smooth edges."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from art.cars.regions import BASE, Region
from eyas.engine.render.textures.fields import SIZE, Field
from eyas.lanes import exact

Line = Sequence[tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A region under the brush; all of it is changed in place."""

    tone: Field  # Brightness, linear, shape (H, W)
    x: Field  # Place from the left [m], shape (H, W)
    y: Field  # Place from below [m], shape (H, W)
    texel: float  # Mean size of a texel [m]

    def line(self, points: Line, width: float, tone: float, strength: float = 1.0) -> None:
        """Draw a line through points [m]."""
        away = np.full(self.x.shape, np.inf)
        for (x0, y0), (x1, y1) in pairwise(points):
            dx, dy = x1 - x0, y1 - y0
            along = ((self.x - x0) * dx + (self.y - y0) * dy) / (dx * dx + dy * dy)
            along = np.clip(along, 0.0, 1.0)
            away = np.minimum(
                away, np.square(self.x - x0 - along * dx) + np.square(self.y - y0 - along * dy)
            )
        self._over(0.5 * width - np.sqrt(away), tone, strength)

    def box(self, low: tuple[float, float], high: tuple[float, float], tone: float,
            strength: float = 1.0, round_: float = 0.02) -> None:  # fmt: skip
        """Fill a rectangle with round corners."""
        dx = np.maximum(low[0] - self.x, self.x - high[0]) + round_
        dy = np.maximum(low[1] - self.y, self.y - high[1]) + round_
        outside = np.sqrt(np.square(np.maximum(dx, 0)) + np.square(np.maximum(dy, 0)))
        self._over(round_ - outside - np.minimum(np.maximum(dx, dy), 0.0), tone, strength)

    def frame(self, low: tuple[float, float], high: tuple[float, float], width: float,
              tone: float, strength: float = 1.0) -> None:  # fmt: skip
        """Draw a frame inside a rectangle."""
        inside = np.minimum(
            np.minimum(self.x - low[0], high[0] - self.x),
            np.minimum(self.y - low[1], high[1] - self.y),
        )
        self._over(width - inside, tone, strength)

    def scale(self, factor: Field) -> None:
        """Multiply the brightness."""
        self.tone[:] *= factor

    def _over(self, inside: Field, tone: float, strength: float) -> None:
        """Blend a tone in where the distance inside of an edge is positive [m]."""
        share = strength * np.clip(0.5 + inside / self.texel, 0.0, 1.0)
        self.tone[:] += share * (tone - self.tone)


def sheet_of(tones: Field, region: Region, size: tuple[float, float]) -> Sheet:
    """Return a region with its margins of three texels, and its size [m]."""
    left, right = region.left - 3, region.right + 3
    bottom, top = region.bottom - 3, region.top + 3
    across = (np.arange(left, right) + 0.5 - region.left) / (region.right - region.left)
    up = (np.arange(bottom, top) + 0.5 - region.bottom) / (region.top - region.bottom)
    x, y = np.meshgrid(np.clip(across, 0, 1) * size[0], np.clip(up, 0, 1) * size[1])
    texel = 0.5 * (size[0] / (region.right - region.left) + size[1] / (region.top - region.bottom))
    return Sheet(tones[bottom:top, left:right], x, y, texel)


def texture_of(tones: Field) -> NDArray[np.uint8]:
    """Return brightness, linear, rows from below, as an opaque picture."""
    tone = np.clip(tones[::-1], 1e-6, 1.0)
    encoded = np.where(tone <= 0.0031308, 12.92 * tone, 1.055 * exact.power(tone, 1 / 2.4) - 0.055)
    picture = np.full((SIZE, SIZE, 4), 255, np.uint8)
    picture[..., :3] = np.round(255.0 * encoded)[..., None]
    # Seams and dark parts have no gloss.
    picture[..., 3] = np.round(255.0 * np.clip((tone - 0.1) / (0.7 * BASE), 0.0, 1.0))
    return picture
