"""Clouds as a panorama: rays from the ground through heaps of cloud with flat bases."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, u4
from eyas.lanes import kernel, parallel
from eyas.lanes.elementary import exp

DEEPEST = 0.9  # Height of the highest heaps over their base [km]

_BASE = f4(1.1)  # Height of all bases [km]
_TOP = f4(1.1 + DEEPEST)

_VEIL = f4(8.0)  # Height of the thin clouds above them [km]
_CURVE = f4(0.5 / 6371.0)  # One over the diameter of the earth [1/km]
_TILE, _FINE, _THIN = f4(256.0 / 9.0), f4(256.0 / 2.1), f4(256.0 / 60.0)
"""Texels in a km: of heaps, of their details, of the thin clouds."""
_DENSE = f4(50.0)  # Extinction inside a heap [1/km]
_BUMP = f4(0.15)  # Depth by which details reduce a heap [km]


@kernel(inline=True)
def _smooth(field: NDArray[np.float32], x: float, y: float, channel: int) -> float:
    """Return a value of a field that repeats, shape (256, 256, .), at texel (x, y)."""
    # Moved to where cutting digits off is rounding down: no ray comes as far.
    x, y = x + f4(8192.0), y + f4(8192.0)
    left, low = u4(x), u4(y)
    across, up = x - f4(left), y - f4(low)
    i, j = left & u4(255), low & u4(255)
    k, m = (left + u4(1)) & u4(255), (low + u4(1)) & u4(255)
    lower = field[j, i, channel] + across * (field[j, k, channel] - field[j, i, channel])
    upper = field[m, i, channel] + across * (field[m, k, channel] - field[m, i, channel])
    return f4(lower + up * (upper - lower))


@kernel(inline=True)
def _reach(climb: float, height: float) -> float:
    """Return how far away [km] a ray is at a height [km] over the round earth.

    From `height = climb s + s^2 / diameter`; `climb` is its slope at the start.
    """
    root = f4(math.sqrt(climb * climb + f4(4.0) * _CURVE * height))
    return f4(2.0) * height / (climb + root)


class CloudRays(NamedTuple):
    """Input and output of `cloud_rays`."""

    field: NDArray[np.float32]
    """Height of the heaps' tops over their base, or minus the distance to the next heap, and height
    of the clouds' sunlit surface [km], details 0 to 1, and opacity of the thin clouds, 0 to 1; it
    repeats; shape (256, 256, 4)."""
    sines: NDArray[np.float32]  # Sine of the elevation of each row
    directions: NDArray[np.float32]  # Horizontal unit vector of each column, shape (., 2).
    output: NDArray[np.uint8]
    """Opacity, and brightness times opacity, 0 to 255, shape (rows, columns, 2)."""


@parallel
def cloud_rays(worker: int, workers: int, rays: CloudRays) -> None:
    """Fill the panorama.

    Multiply scattered light falls off as `1 / (1 + depth)`, not exponentially; `depth` is the
    distance of a point below the sunlit surface of the clouds.
    """
    sines = rays.sines
    # Far clouds take longest, so they are spread over all workers.
    for row in range(worker, len(sines), workers):
        climb = sines[row] / math.sqrt(max(f4(1.0) - sines[row] * sines[row], f4(1e-6)))
        _cloud_row(rays.field, climb, rays.directions, rays.output[row])


@kernel
def _cloud_row(
    field: NDArray[np.float32],
    climb: float,
    directions: NDArray[np.float32],
    output: NDArray[np.uint8],
) -> None:
    one = f4(1.0)
    thin_at = _reach(climb, _VEIL) * _THIN
    for column in range(len(directions)):
        x, y = directions[column, 0], directions[column, 1]
        clear, bright = _heaps(field, x, y, climb)
        thin = _smooth(field, x * thin_at, y * thin_at, 3)
        bright += clear * thin
        clear *= one - thin
        output[column, 0] = u4(f4(255.0) * (one - clear) + f4(0.5))
        output[column, 1] = u4(f4(255.0) * min(bright, one) + f4(0.5))


@kernel(inline=True)
def _heaps(field: NDArray[np.float32], x: float, y: float, climb: float) -> tuple[float, float]:
    """Return the share of light that passes the heaps along a ray, and their brightness.

    Steps are long outside clouds, and short from one step before the first heap.
    """
    one, zero = f4(1.0), f4(0.0)
    first, last = _reach(climb, _BASE), _reach(climb, _TOP)
    long = min(max((last - first) * f4(1.0 / 20.0), f4(0.05)), f4(0.2))
    short = max(f4(0.2) * long, f4(0.003) * first)
    path = short * math.sqrt(one + climb * climb)
    last = min(last, first + f4(10.0))
    clear, bright, away, near = one, zero, first, 0
    while away < last and clear > f4(0.015):
        height = away * climb + away * away * _CURVE - _BASE
        top = _smooth(field, x * away * _TILE, y * away * _TILE, 0)
        if top <= height:
            # Negative: minus the distance to the next heap.
            away += max(short if near > 0 else long, -top)
            near -= 1
            continue
        if near <= 0:
            away = max(away - long + short, first)
            near = 8
            continue
        near = 8
        # Sampled at a slant, and in two ways; otherwise details would form vertical folds.
        fine_x, fine_y, lean = x * away * _FINE, y * away * _FINE, f4(90.0) * height
        bump = f4(2.2) * _smooth(field, fine_x + lean, fine_y - lean, 2)
        bump = max(bump * _smooth(field, fine_y - lean, f4(128.0) - fine_x, 2), f4(0.25))
        inside = min((top - _BUMP * bump - height) * f4(20.0), one)
        inside *= min(max(height * f4(20.0), zero), one)
        if inside > zero:
            depth = _smooth(field, x * away * _TILE, y * away * _TILE, 1) - height
            depth = max(depth, zero) + f4(0.06) * bump
            passed = f4(exp(-_DENSE * inside * path))
            bright += clear * (one - passed) / (one + f4(7.5) * depth)
            clear *= passed
        away += short
    return clear, bright
