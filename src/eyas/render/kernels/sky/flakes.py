"""Falling snow, drawn over a finished band.

Flakes lie in a lattice of cells that sinks with the wind. The position of each depends only on
its cell and the time, so flakes pass the camera as real ones do, and one instant always looks the
same. Around the camera are shells, the farther with larger cells, to limit the number of flakes.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.chance import scrambled, tenth
from eyas.render.kernels.light.tone import tone_byte
from eyas.render.kernels.scalars import f4, i8, u4

__all__ = ["FlakeView", "let_flakes_fall"]

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


class FlakeView(NamedTuple):
    """A view and its picture, into which flakes are drawn."""

    samples: int
    """Samples along a side of each pixel."""
    top: int
    """Row of the picture that is row 0 of `output`."""
    light: Light
    """Light of the view; contains the strength of the snowfall."""
    instant: float
    """Time [s]."""
    eye: NDArray[np.float64]
    axes: NDArray[np.float64]
    lens: NDArray[np.float64]
    """These three: see `Job`."""
    depth: NDArray[np.float32]
    """See `Scratch`."""
    output: NDArray[np.uint8]
    """sRGB, shape (rows, columns, 3)."""


@inlined_kernel
def _wave(turn: float) -> float:
    """Return approximately the sine of an angle given in turns, made of parabolas."""
    part = turn - math.floor(turn) - 0.5
    return float(16.0 * part * (abs(part) - 0.5))


@inlined_kernel
def _white(light: Light, k: int) -> int:
    """Return a flake's byte: it is lit by the sky and, a little, by sunlight shining through."""
    return tone_byte(light, f4(1.1) * light.ambient_up[k] + f4(0.35) * light.sun_colour[k])


@inner_kernel
def let_flakes_fall(view: FlakeView) -> None:
    """Draw flakes into a band."""
    begin = NEAREST
    for shell in range(SHELLS):
        end = begin * GROWTH
        if _radius(1.0, begin) * view.lens[3] / begin > SMALLEST:
            _fill_shell(shell, begin, end, view)
        begin = end


@inlined_kernel
def _radius(size: float, distance: float) -> float:
    """Return the radius of a flake [m]; a distant flake represents several."""
    return (0.4 + 0.6 * size) * (0.0035 + 0.0007 * distance)


@inner_kernel
def _cells(axis: int, end: float, origin: float, view: FlakeView) -> tuple[int, int]:
    """Return the first cell along an axis of the world that the view reaches, and after the last.

    Args:
        axis: 0 to 2.
        end: Distance up to which the view reaches [m].
        origin: The eye in the lattice [m].
        view: Says where the camera looks.
    """
    axes, lens = view.axes, view.lens
    middle, side = axes[0, axis], end / CELLS
    aside = abs(axes[1, axis]) * 0.5 * lens[1] / lens[0]
    aside += abs(axes[2, axis]) * 0.5 * lens[2] / lens[4]
    first = math.floor((origin + end * min(middle - aside, 0.0)) / side)
    last = math.floor((origin + end * max(middle + aside, 0.0)) / side)
    return i8(first) - 1, i8(last) + 2


@inner_kernel
def _fill_shell(shell: int, begin: float, end: float, view: FlakeView) -> None:
    """Draw the flakes of all cells that the band may show."""
    lens, eye, side = view.lens, view.eye, end / CELLS
    flakes = math.ceil(MOST * view.light.air[8])
    x = eye[0] - WIND_X * view.instant
    y = eye[1] - WIND_Y * view.instant
    z = eye[2] + SINKING * view.instant
    high = (0.5 * lens[2] - view.top * view.samples) / lens[4]
    low = high - view.output.shape[0] * view.samples / lens[4]
    first_x, last_x = _cells(0, end, x, view)
    first_y, last_y = _cells(1, end, y, view)
    first_z, last_z = _cells(2, end, z, view)
    for i in range(first_x, last_x):
        for j in range(first_y, last_y):
            for k in range(first_z, last_z):
                middle = (i + 0.5) * side - x, (j + 0.5) * side - y, (k + 0.5) * side - z
                if not _in_band(middle, begin, end, low, high, view):
                    continue
                cell = scrambled(u4(u4(i + 32768) * u4(0x9E3779B1)) ^ u4(j + 32768))
                cell = scrambled(cell ^ u4(u4(k + 32768) * u4(0x85EBCA77)) ^ u4(shell << 28))
                for flake in range(flakes):
                    _draw_flake(scrambled(u4(cell + u4(flake))), middle, begin, end, view)


@inlined_kernel
def _seen_from(
    axes: NDArray[np.float64], x: float, y: float, z: float
) -> tuple[float, float, float]:
    """Return how far a direction goes forward, left and up."""
    return (
        axes[0, 0] * x + axes[0, 1] * y + axes[0, 2] * z,
        axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z,
        axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z,
    )


@inlined_kernel
def _in_band(
    middle: tuple[float, float, float],
    begin: float,
    end: float,
    low: float,
    high: float,
    view: FlakeView,
) -> bool:
    """Return whether a ball round a cell and the sway of its flakes may be seen."""
    ball = 0.87 * end / CELLS + 0.1
    wide = 0.5 * view.lens[1] / view.lens[0]
    ahead, left, up = _seen_from(view.axes, middle[0], middle[1], middle[2])
    if ahead < begin - ball or ahead > end + ball:
        return False
    if abs(left) > wide * ahead + ball * math.sqrt(1.0 + wide * wide):
        return False
    if up > high * ahead + ball * math.sqrt(1.0 + high * high):
        return False
    return bool(up >= low * ahead - ball * math.sqrt(1.0 + low * low))


@inner_kernel
def _draw_flake(
    number: int, middle: tuple[float, float, float], begin: float, end: float, view: FlakeView
) -> None:
    """Draw the flake of a number in a cell whose middle lies there from the eye [m]."""
    other, side, axes, lens = scrambled(number), end / CELLS, view.axes, view.lens
    size = tenth(other, 20) ** 2
    if _radius(size, begin) * lens[3] < SMALLEST * begin:
        return
    turn = tenth(other, 0) + view.instant * (0.22 + 0.25 * tenth(other, 10))
    x = middle[0] + (tenth(number, 0) - 0.5) * side + SWAY * _wave(turn)
    y = middle[1] + (tenth(number, 10) - 0.5) * side + SWAY * _wave(turn + 0.25)
    z = middle[2] + (tenth(number, 20) - 0.5) * side
    ahead, left, up = _seen_from(axes, x, y, z)
    if ahead < begin or ahead > end:
        return
    # From its position at the start of the exposure.
    _, aside, above = _seen_from(axes, -WIND_X * EXPOSED, -WIND_Y * EXPOSED, SINKING * EXPOSED)
    radius = _radius(size, ahead) * lens[3] / ahead
    if radius < SMALLEST:
        return
    across = lens[0] / (ahead * view.samples)
    down = lens[4] / (ahead * view.samples)
    column = 0.5 * lens[1] / view.samples - left * across
    row = 0.5 * lens[2] / view.samples - up * down
    _smear(column, row, -aside * across, -above * down, radius, 1.0 / ahead, view)


@inner_kernel
def _smear(
    column: float,
    row: float,
    to_column: float,
    to_row: float,
    radius: float,
    inverse: float,
    view: FlakeView,
) -> None:
    """Draw a soft streak.

    Args:
        column: Column of its end [pixels].
        row: Row of its end [pixels].
        to_column: Columns from there to its start [pixels].
        to_row: Rows from there to its start [pixels].
        radius: Half its width [pixels].
        inverse: One over its distance, as in `Scratch.depth` [1/m].
        view: View to draw into.
    """
    drawn = max(radius, 0.6)
    soft = 0.5 + 0.35 * drawn
    reach = drawn + soft
    light, output, step = view.light, view.output, view.samples
    first = max(i8(math.floor(min(row, row + to_row) - reach)) - view.top, 0)
    last = min(i8(math.ceil(max(row, row + to_row) + reach)) - view.top, output.shape[0])
    start = max(i8(math.floor(min(column, column + to_column) - reach)), 0)
    stop = min(i8(math.ceil(max(column, column + to_column) + reach)), output.shape[1])
    if first >= last or start >= stop:
        return
    length = math.sqrt(to_column * to_column + to_row * to_row)
    # A small flake covers part of a pixel; a moving one is in each pixel part of the time.
    strength = (radius / drawn) ** 2 * min(1.0, 2.6 * drawn / (drawn + length))
    strength *= 0.9 / (1.0 + 0.09 * max(radius - 2.0, 0.0))
    red, green, blue = _white(light, 0), _white(light, 1), _white(light, 2)
    for i in range(first, last):
        for j in range(start, stop):
            if view.depth[i * step, j * step] > inverse:
                continue
            y, x = i + view.top + 0.5 - row, j + 0.5 - column
            share = (x * to_column + y * to_row) / (length * length + 1e-9)
            share = min(max(share, 0.0), 1.0)
            x, y = x - share * to_column, y - share * to_row
            cover = (reach - math.sqrt(x * x + y * y)) / (2.0 * soft)
            cover = strength * min(max(cover, 0.0), 1.0)
            output[i, j, 0] = i8(output[i, j, 0] + cover * (red - output[i, j, 0]) + 0.5)
            output[i, j, 1] = i8(output[i, j, 1] + cover * (green - output[i, j, 1]) + 0.5)
            output[i, j, 2] = i8(output[i, j, 2] + cover * (blue - output[i, j, 2]) + 0.5)
