"""Falling snow, drawn over a finished band.

Flakes lie in a lattice of cells that sinks with the wind. The position of each depends only on
its cell and the time, so flakes pass the camera as real ones do, and one instant always looks the
same. Around the camera are shells, the farther with larger cells, to limit the number of flakes.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import address_of, kernel
from eyas.render.kernels.bundles import Illumination, Light, View
from eyas.render.kernels.chance import scrambled, tenth
from eyas.render.kernels.light.tone import tone_bytes
from eyas.render.kernels.scalars import f4, i8, u4
from eyas.render.kernels.sky.streaks import Snowfall, smear

__all__ = ["let_flakes_fall"]

SHELLS = 3
"""Shells around the camera; each reaches `GROWTH` times as far as the one before."""

NEAREST = 0.7
"""Distance of the first shell [m]; nearer flakes would be blurs."""

GROWTH = 2.6
CELLS, MOST = 6.0, 10.0
"""Cells from the camera to the end of a shell; largest number of flakes in a cell."""

WIND_X, WIND_Y, SINKING, SWAY = 0.55, 0.3, 1.25, 0.06
"""Velocity of flakes [m/s], and amplitude of their sway [m]."""

EXPOSED = 1.0 / 110.0
"""Exposure time of the picture, which turns flakes into streaks [s]."""

SMALLEST = 0.35
"""Radius below which flakes are invisible [pixels]."""


@kernel(inline=True)
def _wave(turn: float) -> float:
    """Return approximately the sine of an angle given in turns, made of parabolas."""
    part = turn - math.floor(turn) - 0.5
    return float(16.0 * part * (abs(part) - 0.5))


@kernel(inline=True)
def _white(light: Light, lit: Illumination) -> tuple[int, int, int]:
    """Return a flake's bytes: it is lit by the sky and, a little, by sunlight shining through."""
    above, sun = lit.above, lit.sun_colour
    colour = (
        f4(1.1) * above.x + f4(0.35) * sun.x,
        f4(1.1) * above.y + f4(0.35) * sun.y,
        f4(1.1) * above.z + f4(0.35) * sun.z,
    )
    red, green, blue = tone_bytes(light, lit.air.exposure, colour)
    return i8(red), i8(green), i8(blue)


@kernel
def let_flakes_fall(
    view: View,
    light: Light,
    lit: Illumination,
    instant: float,
    key: NDArray[np.int64],
    pixels: NDArray[np.uint8],
) -> None:
    """Draw flakes into a band.

    Args:
        view: The band.
        light: Its tone curve.
        lit: Light and air.
        instant: Time [s].
        key: See `Scratch`, shape (rows, columns).
        pixels: sRGB, shape (rows, columns, 3).
    """
    most = math.ceil(MOST * lit.air.flakes)
    snowfall = Snowfall(view, instant, most, _white(light, lit), key, pixels)
    begin = NEAREST
    for shell in range(SHELLS):
        end = begin * GROWTH
        if _radius(1.0, begin) * view.focal / begin > SMALLEST:
            _fill_shell(shell, begin, end, address_of(snowfall))
        begin = end


@kernel(inline=True)
def _radius(size: float, distance: float) -> float:
    """Return the radius of a flake [m]; a distant flake represents several."""
    return (0.4 + 0.6 * size) * (0.0035 + 0.0007 * distance)


@kernel(inline=True)
def _cells(
    ahead: float, left: float, up: float, end: float, origin: float, view: View
) -> tuple[int, int]:
    """Return the first cell along an axis of the world that the view reaches, and after the last.

    Args:
        ahead: How far the camera's optical axis goes along that axis; then left and up.
        left: The same.
        up: The same.
        end: Distance up to which the view reaches [m].
        origin: The eye in the lattice [m].
        view: Says where the camera looks.
    """
    side = end / CELLS
    aside = abs(left) * 0.5 * view.width / view.focal_x
    aside += abs(up) * 0.5 * view.height / view.focal_y
    first = math.floor((origin + end * min(ahead - aside, 0.0)) / side)
    last = math.floor((origin + end * max(ahead + aside, 0.0)) / side)
    return i8(first) - 1, i8(last) + 2


@kernel
def _fill_shell(shell: int, begin: float, end: float, snowfall: Snowfall) -> None:
    """Draw the flakes of all cells that the band may show."""
    view, instant, side = snowfall.band, snowfall.instant, end / CELLS
    ahead, left, up = view.ahead, view.left, view.up
    x = view.eye.x - WIND_X * instant
    y = view.eye.y - WIND_Y * instant
    z = view.eye.z + SINKING * instant
    high = (0.5 * view.height - view.top) / view.focal_y
    low = high - view.rows / view.focal_y
    first_x, last_x = _cells(ahead.x, left.x, up.x, end, x, view)
    first_y, last_y = _cells(ahead.y, left.y, up.y, end, y, view)
    first_z, last_z = _cells(ahead.z, left.z, up.z, end, z, view)
    for i in range(first_x, last_x):
        for j in range(first_y, last_y):
            for k in range(first_z, last_z):
                middle = (i + 0.5) * side - x, (j + 0.5) * side - y, (k + 0.5) * side - z
                if not _in_band(middle, begin, end, low, high, view):
                    continue
                cell = scrambled(u4(u4(i + 32768) * u4(0x9E3779B1)) ^ u4(j + 32768))
                cell = scrambled(cell ^ u4(u4(k + 32768) * u4(0x85EBCA77)) ^ u4(shell << 28))
                for flake in range(snowfall.most):
                    number = scrambled(u4(cell + u4(flake)))
                    _draw_flake(number, middle, begin, end, snowfall)


@kernel(inline=True)
def _seen_from(view: View, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return how far a direction goes forward, left and up."""
    ahead, left, up = view.ahead, view.left, view.up
    return (
        ahead.x * x + ahead.y * y + ahead.z * z,
        left.x * x + left.y * y + left.z * z,
        up.x * x + up.y * y + up.z * z,
    )


@kernel(inline=True)
def _in_band(
    middle: tuple[float, float, float],
    begin: float,
    end: float,
    low: float,
    high: float,
    view: View,
) -> bool:
    """Return whether a ball round a cell and the sway of its flakes may be seen."""
    ball = 0.87 * end / CELLS + 0.1
    wide = 0.5 * view.width / view.focal_x
    ahead, left, up = _seen_from(view, middle[0], middle[1], middle[2])
    if ahead < begin - ball or ahead > end + ball:
        return False
    if abs(left) > wide * ahead + ball * math.sqrt(1.0 + wide * wide):
        return False
    if up > high * ahead + ball * math.sqrt(1.0 + high * high):
        return False
    return bool(up >= low * ahead - ball * math.sqrt(1.0 + low * low))


@kernel
def _draw_flake(
    number: int, middle: tuple[float, float, float], begin: float, end: float, snowfall: Snowfall
) -> None:
    """Draw the flake of a number in a cell whose middle lies there from the eye [m]."""
    view, instant = snowfall.band, snowfall.instant
    other, side = scrambled(number), end / CELLS
    size = tenth(other, 20) ** 2
    if _radius(size, begin) * view.focal < SMALLEST * begin:
        return
    turn = tenth(other, 0) + instant * (0.22 + 0.25 * tenth(other, 10))
    x = middle[0] + (tenth(number, 0) - 0.5) * side + SWAY * _wave(turn)
    y = middle[1] + (tenth(number, 10) - 0.5) * side + SWAY * _wave(turn + 0.25)
    z = middle[2] + (tenth(number, 20) - 0.5) * side
    ahead, left, up = _seen_from(view, x, y, z)
    if ahead < begin or ahead > end:
        return
    # From its position at the start of the exposure.
    _, aside, above = _seen_from(view, -WIND_X * EXPOSED, -WIND_Y * EXPOSED, SINKING * EXPOSED)
    radius = _radius(size, ahead) * view.focal / ahead
    if radius < SMALLEST:
        return
    across = view.focal_x / (ahead * view.samples)
    down = view.focal_y / (ahead * view.samples)
    column = 0.5 * view.width / view.samples - left * across
    row = (0.5 * view.height - view.top) / view.samples - up * down
    smear(column, row, -aside * across, -above * down, radius, 1.0 / ahead, snowfall)
