"""Pixels and the level on which targets move, for a camera that is held level by its gimbal."""

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.lanes import exact

Floats = NDArray[np.float64]

_HALF_WIDTH = float(exact.tan(0.5 * 0.7854))
"""Tangent of half the horizontal field of view of all protocols; the picture is 4 to 3."""
_HALF_HEIGHT = 0.75 * _HALF_WIDTH


class Ground:
    """A pinhole camera over a level plane.

    Offsets are ahead and to the left of the drone [m], pixels column and row, from the left and
    upper edge.

    Args:
        size: Height and width of the picture [pixels].

    Attributes:
        middle: Offset of the point in the middle of the picture [m], shape (2,).
        pixels_per_metre: In the middle of the picture.
    """

    def __init__(self, settings: TrackerSettings, size: tuple[int, int]) -> None:
        self._height, self._size = settings.height, size
        self._sine, self._cosine = (float(f(settings.pitch)) for f in (exact.sin, exact.cos))
        self.middle = np.array([self._height * self._cosine / self._sine, 0.0])
        self.pixels_per_metre = 0.5 * size[1] * self._sine / (self._height * _HALF_WIDTH)

    def pixels(self, offset: Floats) -> Floats:
        """Return where offsets are in the picture or outside of it, shape (N, 2)."""
        depth = offset[:, 0] * self._cosine + self._height * self._sine
        depth = np.maximum(depth, 0.1 * self._height)  # behind the camera: far outside
        up = offset[:, 0] * self._sine - self._height * self._cosine
        column = (1.0 - offset[:, 1] / depth / _HALF_WIDTH) * 0.5 * self._size[1]
        row = (1.0 - up / depth / _HALF_HEIGHT) * 0.5 * self._size[0]
        return np.stack((column, row), axis=-1)

    def offsets(self, pixels: Floats) -> Floats:
        """Return which offsets are seen at pixels, shape (N, 2)."""
        left = (1.0 - 2.0 * pixels[:, 0] / self._size[1]) * _HALF_WIDTH
        up = (1.0 - 2.0 * pixels[:, 1] / self._size[0]) * _HALF_HEIGHT
        reach = self._height / (self._sine - up * self._cosine)
        return np.stack((reach * (self._cosine + up * self._sine), reach * left), axis=-1)
