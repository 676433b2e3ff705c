"""The body of a tracker, which meets solids and other trackers: an upright box around it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.frames import rotate
from eyas.lanes import kernel

BODY = (0.806, 0.806, 0.366)
"""Length, width, height of the original's drone [m]; its camera, a few cm below, is neglected."""

_LONG, _WIDE, _HIGH = (0.5 * size for size in BODY)


class UprightBox(NamedTuple):
    """An upright box around a body that may be tilted."""

    cosine: float  # Of its heading
    sine: float
    half_length: float  # [m]
    half_width: float
    half_height: float


@kernel(inline=True)
def body_box(orientation: NDArray[np.float64]) -> UprightBox:
    """Return the box around a body, given body to world, shape (4,)."""
    ahead = rotate(orientation, _LONG, 0.0, 0.0)
    left = rotate(orientation, 0.0, _WIDE, 0.0)
    up = rotate(orientation, 0.0, 0.0, _HIGH)
    level = math.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    cosine, sine = (ahead[0] / level, ahead[1] / level) if level > 0.0 else (1.0, 0.0)
    length = abs(cosine * ahead[0] + sine * ahead[1]) + abs(cosine * left[0] + sine * left[1])
    width = abs(cosine * ahead[1] - sine * ahead[0]) + abs(cosine * left[1] - sine * left[0])
    return UprightBox(
        cosine,
        sine,
        length + abs(cosine * up[0] + sine * up[1]),
        width + abs(cosine * up[1] - sine * up[0]),
        abs(ahead[2]) + abs(left[2]) + abs(up[2]),
    )
