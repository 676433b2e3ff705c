"""Light that the two boxes of a moving thing block."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel

__all__ = ["darken"]

_UNDER = 0.88
"""Share of the sky's light that a car blocks on the ground under it."""

_INSET = 0.3
"""Distance from the edge of a body inwards at which the blocking begins [m]."""


@inlined_kernel
def _between(start: float, step: float, low: float, high: float) -> tuple[float, float]:
    """Return when a point that moves by `step` in each unit of time enters and leaves a range."""
    speed = step if abs(step) > 1e-4 else 1e-4
    first, last = (low - start) / speed, (high - start) / speed
    return min(first, last), max(first, last)


@inlined_kernel
def _through(
    at: tuple[float, float, float],
    way: tuple[float, float, float],
    ends: tuple[float, float, float, float],
    bottom: float,
    top: float,
) -> float:
    """Return the length [m] inside a box of the ray from a point to the sun."""
    front, back = _between(at[0], way[0], ends[0], ends[1])
    right, left = _between(at[1], way[1], ends[2], ends[3])
    low, high = _between(at[2], way[2], bottom, top)
    return float(max(min(back, left, high) - max(front, right, low, 0.0), 0.0))


@inner_kernel
def darken(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    x: float,
    y: float,
    z: float,
) -> tuple[float, float]:
    """Return the shares of sun and sky light that a thing lets through to a point."""
    dx, dy = x - caster[0], y - caster[1]
    px, py = dx * caster[2] + dy * caster[3], dy * caster[2] - dx * caster[3]
    sx, sy = sun[0] * caster[2] + sun[1] * caster[3], sun[1] * caster[2] - sun[0] * caster[3]
    way = (float(sx), float(sy), max(float(sun[2]), 1e-3))
    # The longer the ray through it, the darker the shadow: this gives a soft edge.
    body = (-caster[4], caster[4], caster[13], caster[14])
    cabin = (caster[9], caster[10], caster[11], caster[12])
    inside = _through((px, py, z), way, body, caster[6], caster[8])
    inside += _through((px, py, z), way, cabin, caster[8], caster[7])
    deep = min(inside * 2.2, 1.0)
    # Little light of the sky reaches the ground under a body and beside it.
    half, side = 0.5 * (caster[14] - caster[13]), py - 0.5 * (caster[14] + caster[13])
    out_x = max(abs(px) - caster[4] + _INSET, 0.0)
    out_y = max(abs(side) - half + min(_INSET, half), 0.0)
    near = max(1.0 - math.sqrt(out_x * out_x + out_y * out_y) / (caster[15] + _INSET), 0.0)
    if abs(z - caster[6]) > 0.3:
        near = 0.0
    most = _UNDER * min(half + 0.35, 1.0)  # light comes under a motorbike from both sides
    return 1.0 - deep, 1.0 - most * near * near * (3.0 - 2.0 * near)
