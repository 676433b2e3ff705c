"""Falling snow, rain and leaves, drawn over a finished band.

Flakes, as all of them are called here, lie in a lattice of cells that sinks with the wind. The
position of each depends only on its cell and the time, so flakes pass the camera as real ones do,
and one instant always looks the same. Around the camera are shells, the farther with larger cells,
to limit the number of flakes.
"""

import math
from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Band, Canvas, Light, View
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.hash_noise import scrambled, tenth
from eyas.engine.render.kernels.lens.resampling import shown_at
from eyas.engine.render.kernels.light.tone import tone_bytes
from eyas.engine.render.kernels.samples import own_rows, pixel_row
from eyas.engine.render.kernels.scalars import f4, i8, u4
from eyas.engine.render.kernels.sky.falling import (
    LEAVES,
    RAIN,
    SNOW,
    Falling,
    drop_lit,
    falling_of,
    leaf_colour,
    lit_by_lamps,
    sky_lit,
    under_trees,
)
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.engine.render.kernels.wind import wave
from eyas.lanes import address_of, kernel

NEAREST = 0.7  # Distance of the first shell [m]; nearer flakes would be blurs

GROWTH = 2.6

_LONGEST = 400.0
"""Columns and rows of streaks through a lens that are longer lie at its edge, half of them outside
[pixels]."""


class Snowfall(NamedTuple):
    """A band, the air in it and its picture, into which flakes are drawn."""

    band: Band
    instant: float  # Time [s]
    falling: Falling
    white: tuple[float, float, float]  # Radiance of a flake
    bytes: tuple[int, int, int]  # Its bytes
    canvas: Canvas


@kernel(inline=True)
def bytes_of(
    light: Light, exposure: float, colour: tuple[float, float, float]
) -> tuple[int, int, int]:
    """Return the bytes of a radiance."""
    red, green, blue = tone_bytes(light, exposure, colour)
    return i8(red), i8(green), i8(blue)


@kernel
def let_flakes_fall(
    band: Band,
    instant: float,  # Time [s]
    canvas: Canvas,  # Its colours
) -> None:
    """Draw what falls into a band."""
    lit, none = band.lit, f4(0.0)
    if lit.air.flakes > none:
        _let_fall(band, instant, falling_of(SNOW, lit.air.flakes, lit), sky_lit(lit), canvas)
    if lit.air.rain > none:
        _let_fall(band, instant, falling_of(RAIN, lit.air.rain, lit), drop_lit(lit), canvas)
    if lit.air.leaves > none:
        _let_fall(band, instant, falling_of(LEAVES, lit.air.leaves, lit), sky_lit(lit), canvas)


@kernel
def _let_fall(
    band: Band, instant: float, falling: Falling, white: tuple[float, float, float], canvas: Canvas
) -> None:
    """Draw one thing that falls; `white` is the radiance of a white flake."""
    pale = bytes_of(band.light, band.lit.air.exposure, white)
    snowfall = Snowfall(band, instant, falling, white, pale, canvas)
    begin, focal = NEAREST, band.camera.focal
    for shell in range(falling.kind.shells):
        end = begin * GROWTH
        if _radius(falling, 1.0, begin) * focal / begin > falling.kind.smallest:
            _fill_shell(shell, begin, end, address_of(snowfall))
        begin = end


@kernel(inline=True)
def _radius(falling: Falling, size: float, distance: float) -> float:
    """Return the radius of a flake [m]; a distant flake represents several."""
    return (0.4 + 0.6 * size) * (falling.kind.radius + falling.kind.growth * distance)


@kernel(inline=True)
def _cells(
    ahead: float,  # How far the camera's optical axis goes along that axis; then left and up
    left: float,
    up: float,
    end: float,  # Distance up to which the view reaches [m]
    side: float,  # Side of a cell [m]
    origin: float,  # The eye in the lattice [m]
    view: View,  # Says where the camera looks
) -> tuple[int, int]:
    """Return the first cell along a world axis that the view reaches, and that after the last."""
    aside = abs(left) * 0.5 * view.width / view.focal_x
    aside += abs(up) * 0.5 * view.height / view.focal_y
    first = math.floor((origin + end * min(ahead - aside, 0.0)) / side)
    last = math.floor((origin + end * max(ahead + aside, 0.0)) / side)
    return i8(first) - 1, i8(last) + 2


@kernel
def _fill_shell(shell: int, begin: float, end: float, snowfall: Snowfall) -> None:
    """Draw the flakes of all cells that the band may show."""
    view, instant, side = snowfall.band.camera, snowfall.instant, end / snowfall.falling.kind.cells
    ahead, left, up, falling = view.ahead, view.left, view.up, snowfall.falling
    x = view.eye.x - falling.wind_x * instant
    y = view.eye.y - falling.wind_y * instant
    z = view.eye.z + falling.kind.sinking * instant
    high = (0.5 * view.height - view.top) / view.focal_y
    low = high - view.rows / view.focal_y
    ball = 0.87 * end / falling.kind.cells + max(0.1, 1.5 * falling.kind.sway)
    first_x, last_x = _cells(ahead.x, left.x, up.x, end, side, x, view)
    first_y, last_y = _cells(ahead.y, left.y, up.y, end, side, y, view)
    first_z, last_z = _cells(ahead.z, left.z, up.z, end, side, z, view)
    for i in range(first_x, last_x):
        for j in range(first_y, last_y):
            for k in range(first_z, last_z):
                middle = (i + 0.5) * side - x, (j + 0.5) * side - y, (k + 0.5) * side - z
                if not _in_band(middle, begin, end, low, high, ball, view):
                    continue
                cell = scrambled(u4(u4(i + 32768) * u4(0x9E3779B1)) ^ u4(j + 32768))
                cell = scrambled(cell ^ u4(u4(k + 32768) * u4(0x85EBCA77)) ^ u4(shell << 28))
                for flake in range(falling.most):
                    number = scrambled(u4(cell + u4(flake)))
                    _draw_flake(number, middle, begin, end, snowfall)


@kernel(inline=True)
def seen_from(view: View, x: float, y: float, z: float) -> tuple[float, float, float]:
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
    ball: float,
    view: View,
) -> bool:
    """Return whether a ball round a cell and the sway of its flakes, of a radius, may be seen."""
    wide = 0.5 * view.width / view.focal_x
    ahead, left, up = seen_from(view, middle[0], middle[1], middle[2])
    if ahead < begin - ball or ahead > end + ball:
        return False
    if abs(left) > wide * ahead + ball * math.sqrt(1.0 + wide * wide):
        return False
    if up > high * ahead + ball * math.sqrt(1.0 + high * high):
        return False
    return bool(up >= low * ahead - ball * math.sqrt(1.0 + low * low))


class Streak(NamedTuple):
    """A flake on the screen."""

    column: float  # Column of its end [pixels]
    row: float  # Row of its end in the band [pixels]
    to_column: float  # Columns from there to its start [pixels]
    to_row: float  # Rows from there to its start [pixels]
    radius: float  # Half its width [pixels]
    inverse: float  # One over its distance [1/m]


@kernel
def _draw_flake(
    number: int, middle: tuple[float, float, float], begin: float, end: float, snowfall: Snowfall
) -> None:
    """Draw the flake of a number in a cell whose middle lies there from the eye [m]."""
    view, instant, falling = snowfall.band.camera, snowfall.instant, snowfall.falling
    other, side = scrambled(number), end / falling.kind.cells
    size = tenth(other, 20) ** 2
    if _radius(falling, size, begin) * view.focal < falling.kind.smallest * begin:
        return
    turn = tenth(other, 0) + instant * (0.22 + 0.25 * tenth(other, 10))
    eye = view.eye
    if falling.kind.coloured and not under_trees(
        snowfall.band.light, eye.x + middle[0], eye.y + middle[1], eye.z + middle[2],
        tenth(other, 5),
    ):  # fmt: skip
        return
    x = middle[0] + (tenth(number, 0) - 0.5) * side + falling.kind.sway * wave(turn)
    y = middle[1] + (tenth(number, 10) - 0.5) * side + falling.kind.sway * wave(turn + 0.25)
    z = middle[2] + (tenth(number, 20) - 0.5) * side
    ahead, left, up = seen_from(view, x, y, z)
    if ahead < begin or ahead > end:
        return
    # From its position at the start of the exposure.
    exposed = falling.kind.exposed
    _, aside, above = seen_from(
        view, -falling.wind_x * exposed, -falling.wind_y * exposed, falling.kind.sinking * exposed
    )
    tumbling = 0.35 + 0.65 * abs(wave(2.7 * turn)) if falling.kind.coloured else 1.0
    real = _radius(falling, size, ahead)
    radius = real * view.focal / ahead
    if falling.kind.coloured:
        radius *= tumbling
    if radius < falling.kind.smallest:
        return
    across = view.focal_x / (ahead * view.across)
    down = view.focal_y / (ahead * view.down)
    column = 0.5 * view.width / view.across - left * across
    row = (0.5 * view.height - view.top) / view.down - up * down
    streak = Streak(column, row, -aside * across, -above * down, radius, 1.0 / ahead)
    if snowfall.band.glass.on == 1:
        moved = aside, above
        streak = _bent_streak((ahead, left, up), moved, real * tumbling, snowfall)
        if streak.radius < falling.kind.smallest:
            return
    colour, pale = snowfall.white, snowfall.bytes
    if falling.kind.coloured:
        colour = leaf_colour(colour, tenth(number ^ other, 5))
    if falling.kind.lit and snowfall.band.lit.air.lamps > f4(0.0):
        place = eye.x + x, eye.y + y, eye.z + z
        colour = lit_by_lamps(colour, snowfall.band, place)
    if falling.kind.coloured or falling.kind.lit:
        pale = bytes_of(snowfall.band.light, snowfall.band.lit.air.exposure, colour)
    _smear(streak, colour, pale, snowfall)


@kernel(inline=True)
def _bent_streak(
    place: tuple[float, float, float],  # Forward, left and up in its face [m]
    moved: tuple[float, float],  # How far it moves left and up while the picture is exposed [m]
    radius: float,  # [m]
    snowfall: Snowfall,  # Band to draw into
) -> Streak:
    """Return a flake as a lens shows it; of radius 0 if it would cross the picture's edge."""
    glass, (ahead, left, up) = snowfall.band.glass, place
    column, row = shown_at(glass, ahead, left, up)
    to_column, to_row = shown_at(glass, ahead, left + moved[0], up + moved[1])
    edge_column, edge_row = shown_at(glass, ahead, left - radius, up)
    wide = math.sqrt((edge_column - column) ** 2 + (edge_row - row) ** 2)
    if abs(to_column - column) + abs(to_row - row) > _LONGEST:
        wide = 0.0
    return Streak(column, row, to_column - column, to_row - row, wide, 1.0 / ahead)


@kernel
def _smear(
    streak: Streak,  # Where it is
    colour: Colour,  # Its radiance
    pale: tuple[int, int, int],  # Its bytes
    snowfall: Snowfall,  # Band to draw into
) -> None:
    """Draw a soft streak."""
    column, row, to_column, to_row, radius, inverse = streak
    drawn = max(radius, 0.6)
    soft = 0.5 + 0.35 * drawn
    reach = drawn + soft
    band, key = snowfall.band, snowfall.band.key
    across, down = band.camera.across, band.camera.down
    first = max(i8(math.floor(min(row, row + to_row) - reach)), 0)
    last = min(i8(math.ceil(max(row, row + to_row) + reach)), band.lines)
    start = max(i8(math.floor(min(column, column + to_column) - reach)), 0)
    stop = min(i8(math.ceil(max(column, column + to_column) + reach)), band.columns)
    if first >= last or start >= stop:
        return
    length = math.sqrt(to_column * to_column + to_row * to_row)
    # A small flake covers part of a pixel; a moving one is in each pixel part of the time.
    share = radius / drawn
    if not snowfall.falling.kind.thin:
        share *= share
    strength = share * min(1.0, 2.6 * drawn / (drawn + length))
    strength *= snowfall.falling.kind.cover / (1.0 + 0.09 * max(radius - 2.0, 0.0))
    for k in range(*own_rows(band, first, last)):
        i = pixel_row(band, k)
        for j in range(start, stop):
            shown = key[i * down, j * across]
            if shown < i8(0) or distance_inverse(shown) > inverse:
                continue
            y, x = i + 0.5 - row, j + 0.5 - column
            share = (x * to_column + y * to_row) / (length * length + 1e-9)
            share = min(max(share, 0.0), 1.0)
            x, y = x - share * to_column, y - share * to_row
            cover = (reach - math.sqrt(x * x + y * y)) / (2.0 * soft)
            cover = strength * min(max(cover, 0.0), 1.0)
            _blend(snowfall.canvas, i, j, cover, colour, pale, snowfall.falling.kind.thin)


@kernel(inline=True)
def _blend(
    canvas: Canvas,
    i: int,
    j: int,
    cover: float,
    colour: Colour,
    pale: tuple[int, int, int],
    thin: bool,
) -> None:
    """Let a flake cover a share of a pixel. What is thin covers little of one: of its light, not of
    its byte, or it would be lost in the dark. Snow keeps the bytes that it has always had.
    """
    if len(canvas.red) > 0:
        red, green, blue = colour
        canvas.red[i, j] += f4(cover) * (red - canvas.red[i, j])
        canvas.green[i, j] += f4(cover) * (green - canvas.green[i, j])
        canvas.blue[i, j] += f4(cover) * (blue - canvas.blue[i, j])
        return
    pixels, (red_byte, green_byte, blue_byte) = canvas.pixels, pale
    if thin:
        pixels[i, j, 0] = _mixed_light(pixels[i, j, 0], red_byte, cover)
        pixels[i, j, 1] = _mixed_light(pixels[i, j, 1], green_byte, cover)
        pixels[i, j, 2] = _mixed_light(pixels[i, j, 2], blue_byte, cover)
        return
    pixels[i, j, 0] = i8(pixels[i, j, 0] + cover * (red_byte - pixels[i, j, 0]) + 0.5)
    pixels[i, j, 1] = i8(pixels[i, j, 1] + cover * (green_byte - pixels[i, j, 1]) + 0.5)
    pixels[i, j, 2] = i8(pixels[i, j, 2] + cover * (blue_byte - pixels[i, j, 2]) + 0.5)


@kernel(inline=True)
def _mixed_light(before: int, over: int, cover: float) -> int:
    """Return the byte of a mixture of light, which is about the square of its byte."""
    below = float(before) * float(before)
    return i8(math.sqrt(below + cover * (float(over) * float(over) - below)) + 0.5)
