"""Light of street lamps, windows and other sources."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4, u4

__all__ = ["night_light", "window_light"]

_HEAD = f4(0.95 / 255.0)
"""Brightest light of head lamps, for each step of `Scratch.shade`."""

_TAIL = f4(0.16 / 255.0)
"""The same for tail lamps."""

_FULL = f4(0.4536)
"""Cosine of the angle up to which a beam is even: the original's 1.1 rad."""

_BAYS = f4(4.0)
"""Windows along a side of one repeat of a facade's texture."""


@inlined_kernel
def night_light(
    light: Light,
    x: float,
    y: float,
    z: float,
    normal: tuple[float, float, float],
    shade: NDArray[np.uint8],
) -> tuple[float, float, float]:
    """Return the light of street lamps and vehicles on a surface; paper in the sun gets 1.

    Args:
        light: Its lamps.
        x: The point [m].
        y: The point [m].
        z: The point [m].
        normal: Unit normal of the surface.
        shade: Light of vehicles there, see `Scratch.shade`.
    """
    on = light.air[5]
    street = on * _street_light(light, x, y, z, normal)
    head = on * f4(shade[2]) * _HEAD
    tail = on * f4(shade[3]) * _TAIL
    return (
        street + head + tail,
        f4(0.86) * street + f4(0.93) * head + f4(0.06) * tail,
        f4(0.62) * street + f4(0.78) * head + f4(0.04) * tail,
    )


@inlined_kernel
def _street_light(
    light: Light, x: float, y: float, z: float, normal: tuple[float, float, float]
) -> float:
    """Return how much light of street lamps a surface gets.

    A lamp is a spot without shadow, as in the original: even to 1.1 rad off its axis, nothing
    from the cut-off on, and less with the square of the distance.
    """
    zero, total = f4(0.0), f4(0.0)
    rows, columns, most = light.lamp_cell.shape
    across = (x - light.lamp_frame[0]) * light.lamp_frame[2]
    down = (y - light.lamp_frame[1]) * light.lamp_frame[2]
    if not (across >= zero and down >= zero and across < f4(columns) and down < f4(rows)):
        return total
    column, row = u4(across), u4(down)
    cut = light.lamp_frame[3]
    for k in range(most):
        which = light.lamp_cell[row, column, k]
        if which < 0:
            break
        lamp = light.lamp[which]
        dx, dy, dz = lamp[0] - x, lamp[1] - y, lamp[2] - z
        lean = normal[0] * dx + normal[1] * dy + normal[2] * dz
        if lean <= zero:
            continue
        square = dx * dx + dy * dy + dz * dz + f4(0.25)
        inverse = f4(1.0) / math.sqrt(square)
        cosine = -(lamp[3] * dx + lamp[4] * dy + lamp[5] * dz) * inverse
        spot = min((cosine - cut) / (_FULL - cut), f4(1.0))
        if spot > zero:
            total += spot * spot * lean * inverse * lamp[6] / square
    return total


@inlined_kernel
def _hashed(a: int, b: int, c: int) -> int:
    """Return 32 bits that look random."""
    mixed = u4(u4(a) * u4(0x9E3779B1)) ^ u4(u4(b) * u4(0x85EBCA77)) ^ u4(u4(c) * u4(0xC2B2AE3D))
    mixed = u4((mixed ^ (mixed >> u4(15))) * u4(0x2C1B3C6D))
    mixed = u4((mixed ^ (mixed >> u4(12))) * u4(0x297A2D39))
    return u4(mixed ^ (mixed >> u4(15)))


@inlined_kernel
def window_light(
    light: Light,
    object_ids: NDArray[np.int32],
    triangle: int,
    level: int,
    u: float,
    v: float,
) -> tuple[float, float, float]:
    """Return the light behind the window at (u, v) of a facade: dark, or one of a few lights.

    The building and the position of the window determine which rooms are lit, so the result is
    the same in every picture. For windows smaller than a pixel, their mean is returned.

    Args:
        light: Its share of lit windows.
        object_ids: Object ids of static triangles.
        triangle: Index of the triangle.
        level: Mip level of the facade's texture; a window has 64 texels along a side.
        u: Texture coordinates [tiles].
        v: Texture coordinates [tiles].
    """
    share = light.air[6]
    if level > 5:
        mean = f4(0.55) * share
        return mean, f4(0.72) * mean, f4(0.46) * mean
    # Moved so that cells have numbers above 0: 64 whole repeats, see `gradients`.
    column, row = u4(_BAYS * u + f4(1024.0)) & u4(255), u4(_BAYS * v + f4(1024.0)) & u4(255)
    bits = _hashed(column, row, object_ids[triangle])
    # Whole storeys are busier than others, as offices are.
    storey = _hashed(row, u4(7), object_ids[triangle])
    odds = share * (f4(0.5) + f4(storey & u4(0xFFFF)) * f4(1.0 / 65535.0))
    if f4(bits & u4(0xFFFF)) * f4(1.0 / 65535.0) >= odds:
        return f4(0.0), f4(0.0), f4(0.0)
    bright = f4(0.25) + f4((bits >> u4(16)) & u4(63)) * f4(0.7 / 63.0)
    kind = (bits >> u4(22)) & u4(15)
    if kind < u4(9):  # lamps in homes
        return bright, f4(0.68) * bright, f4(0.36) * bright
    if kind < u4(14):  # tubes in offices
        return bright, f4(0.92) * bright, f4(0.74) * bright
    return f4(0.35) * bright, f4(0.5) * bright, f4(0.8) * bright  # a screen
