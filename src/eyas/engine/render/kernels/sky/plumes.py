"""Smoke over chimneys and spray behind vehicles: soft puffs over a finished band.

A puff leaves its source at a multiple of a short time. What it does then depends on its number and
its age only, so an instant always looks the same.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Canvas
from eyas.engine.render.kernels.colours import Colour, Vector
from eyas.engine.render.kernels.hash_noise import scrambled, tenth
from eyas.engine.render.kernels.lens.resampling import shown_at
from eyas.engine.render.kernels.pixels import keys_of, pack, write_pixels, write_plane
from eyas.engine.render.kernels.samples import own_rows, pixel_row
from eyas.engine.render.kernels.scalars import f4, i4, i8, u4
from eyas.engine.render.kernels.sky.falling import drift, lit_by_lamps, sky_lit
from eyas.engine.render.kernels.sky.flakes import bytes_of, seen_from
from eyas.engine.render.kernels.sky.fog import fog_share
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.engine.render.kernels.wind import wave
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    bits_of,
    gather,
    greater,
    lane_numbers,
    lesser,
    root,
    select,
    to_f4,
    to_i4,
    to_u4,
)

_REACH = 2.0  # Radius of a puff, in its widths

_SMOKE_EVERY, _SMOKE_PUFFS = 0.45, 32  # Time from a puff to the next [s], and how many there are

_SPRAY_EVERY, _SPRAY_PUFFS = 0.19, 5
_SPRAY_FROM, _SPRAY_FULL = 8.0, 20.0
"""Speed from which water is thrown up, and at which there is most: it grows with the square of the
speed (Weir, Strange and Heffley, Reduction of adverse aerodynamic effects of large trucks,
FHWA-RD-79-84, 1978) [m/s]."""
_SPRAY_TRAIL = 12.0  # Speed from which its trail grows no longer [m/s]
_SPRAY_FARTHEST = 90.0  # Distance beyond which spray is not drawn [m]


class Puff(NamedTuple):
    """A soft ball."""

    place: Vector  # Its middle, world frame [m]
    width: float  # [m]
    thickness: float  # Optical, through its middle


@kernel
def draw_plumes(
    band: Band,
    instant: float,  # Time [s]
    canvas: Canvas,  # Its colours
) -> None:
    """Draw smoke and spray into a band."""
    for source in range(len(band.light.smoke)):
        _draw_smoke(band, source, instant, canvas)
    spray = band.movers.spray
    if len(spray) > 0 and band.lit.air.spray > f4(0.0):
        for source in range(spray.shape[1]):
            _draw_spray(band, source, instant, canvas)


@kernel(inline=True)
def _scaled(share: float, colour: Colour) -> Colour:
    return f4(share) * colour[0], f4(share) * colour[1], f4(share) * colour[2]


@kernel
def _draw_smoke(band: Band, source: int, instant: float, canvas: Canvas) -> None:
    """Draw the plume of a chimney, which the wind bends over.

    It rises with about the power 2/3 of its age, and widens with its rise (Briggs, Plume Rise,
    U.S. Atomic Energy Commission, 1969).
    """
    from_x, from_y = float(band.light.smoke[source, 0]), float(band.light.smoke[source, 1])
    from_z, grey = float(band.light.smoke[source, 2]), float(band.light.smoke[source, 3])
    wind_x, wind_y = drift(band.lit, 1.3, 0.7)
    colour = _scaled(grey, sky_lit(band.lit))
    count, part = _emitted(instant, _SMOKE_EVERY)
    for k in range(_SMOKE_PUFFS):
        chance = scrambled(u4(u4(count - k) * u4(0x9E3779B1)) ^ u4(source + 7))
        age = (k + part) * _SMOKE_EVERY
        rise = 9.0 * (math.sqrt(1.0 + 0.35 * age) - 1.0)
        width = (0.7 + 0.42 * rise) * (0.8 + 0.4 * tenth(chance, 0))
        aside = 0.12 * rise * (tenth(chance, 10) - 0.5)
        place = (
            from_x + wind_x * age + aside + 0.3 * wave(0.11 * (count - k)) * rise,
            from_y + wind_y * age - aside + 0.3 * wave(0.13 * (count - k)) * rise,
            from_z + rise,
        )
        # A puff keeps its mass: the wider, the thinner; the oldest vanish, the newest appear.
        last = min(4.0 * (1.0 - age / (_SMOKE_EVERY * _SMOKE_PUFFS)), 1.0)
        thickness = (1.5 * min(3.0 * age, 1.0) * last) / (0.4 + 0.7 * width)
        _draw_puff(band, Puff(place, width, thickness), colour, canvas)


@kernel
def _draw_spray(band: Band, source: int, instant: float, canvas: Canvas) -> None:
    """Draw what the rear wheels of a vehicle throw up, see `DrawList.spray`."""
    row = band.movers.spray[band.world, source]
    x, y, z = float(row[0]), float(row[1]), float(row[2])
    over_x, over_y, half = float(row[3]), float(row[4]), float(row[5])
    square = over_x * over_x + over_y * over_y
    strength = (square - _SPRAY_FROM**2) / (_SPRAY_FULL**2 - _SPRAY_FROM**2)
    eye = band.camera.eye
    away = math.sqrt((x - eye.x) ** 2 + (y - eye.y) ** 2 + (z - eye.z) ** 2)
    if strength <= 0.0 or away > _SPRAY_FARTHEST:
        return
    strength = min(strength, 1.0) * min(4.0 * (1.0 - away / _SPRAY_FARTHEST), 1.0)
    strength *= float(band.lit.air.spray)
    part = 1.0 / math.sqrt(square)
    slowed = min(part * _SPRAY_TRAIL, 1.0)
    left_x, left_y = -over_y * part, over_x * part
    wind_x, wind_y = drift(band.lit, 0.0, 0.0)
    colour = _scaled(0.9, sky_lit(band.lit))
    count, begun = _emitted(instant, _SPRAY_EVERY)
    for k in range(_SPRAY_PUFFS):
        chance = scrambled(u4(u4(count - k) * u4(0x85EBCA77)) ^ u4(int(row[6])))
        age = (k + begun) * _SPRAY_EVERY
        aside = half * (1.5 * tenth(chance, 0) - 0.75)
        width = 0.35 + 0.3 * half + (0.5 + 0.4 * tenth(chance, 10)) * age
        # The wake draws it along at first.
        behind = 0.75 * age * slowed
        place = (
            x - behind * over_x + aside * left_x + 0.1 * age * wind_x,
            y - behind * over_y + aside * left_y + 0.1 * age * wind_y,
            z + 0.25 + 0.55 * width,
        )
        fade = min(1.0 - age / (_SPRAY_EVERY * _SPRAY_PUFFS), 1.0) * min(8.0 * age + 0.2, 1.0)
        thickness = 1.9 * strength * fade * half / (0.5 + width)
        _draw_puff(band, Puff(place, width, thickness), colour, canvas)


@kernel(inline=True)
def _emitted(instant: float, every: float) -> tuple[int, float]:
    """Return the number of the last puff, and how old it is, as a share of the time to the next."""
    turn = instant / every
    number = math.floor(turn)
    return i8(number) + i8(1 << 20), turn - number


@kernel
def _draw_puff(band: Band, puff: Puff, colour: Colour, canvas: Canvas) -> None:
    """Draw a puff in a light; what lies in front of it hides it, softly."""
    view, eye, (x, y, z) = band.camera, band.camera.eye, puff.place
    ahead, left, up = seen_from(view, x - eye.x, y - eye.y, z - eye.z)
    reach = _REACH * puff.width
    thickness = puff.thickness * min((ahead - 0.4) / puff.width, 1.0)
    if thickness < 0.01:
        return
    row, column, tall, wide = on_screen(band, ahead, left, up, reach)
    top = i8(view.top // view.down) if band.glass.on == 0 else i8(band.glass.top)
    first = max(i8(math.floor(row - tall)) - top, 0)
    last = min(i8(math.ceil(row + tall)) - top, band.lines)
    start = max(i8(math.floor(column - wide)), 0)
    stop = min(i8(math.ceil(column + wide)), band.columns)
    if first >= last or start >= stop:
        return
    lit = band.lit
    if lit.air.lamps > f4(0.0):
        colour = lit_by_lamps(colour, band, puff.place)
    fog, hidden = lit.fog, fog_share(lit, f4(ahead))
    colour = (
        colour[0] + hidden * (fog.x - colour[0]),
        colour[1] + hidden * (fog.y - colour[1]),
        colour[2] + hidden * (fog.z - colour[2]),
    )
    pale = bytes_of(band.light, lit.air.exposure, colour)
    soft = f4(0.5 / puff.width)
    for k in range(*own_rows(band, first, last)):
        i = pixel_row(band, k)
        # Counted from the top of the picture, so that bands agree to the last bit.
        y = (i + top + 0.5 - row) / tall
        half = wide * math.sqrt(max(1.0 - y * y, 0.0))
        begin = max(i8(math.floor(column - half)), start) // WIDTH * WIDTH
        end = min(i8(math.ceil(column + half)), stop)
        for j in range(begin, end, WIDTH):
            x = (to_f4(lane_numbers()) + f4(j + 0.5 - column)) * f4(1.0 / wide)
            round_ = f4(1.0 - y * y) - x * x
            cover = _cover(band, i, j, round_, f4(thickness), f4(ahead), soft)
            if any_of(cover > f4(0.0)):
                _mix(canvas, i, j, cover, colour, pale)


@kernel(inline=True)
def _cover(
    band: Band,
    i: int,  # Row of the pixels
    j: int,  # Column of the first
    round_: float,  # 1 in the middle of the puff, 0 at its edge
    thickness: float,  # Optical, through its middle
    ahead: float,  # Its distance [m]
    soft: float,  # What lies by more than half of one over this behind it is behind all of it [1/m]
) -> float:
    """Return how much of eight pixels a puff covers, 0 to 1."""
    zero, one, across = f4(0.0), f4(1.0), band.camera.across
    keys = keys_of(band.key, i * band.camera.down, j * across, across)
    inside = (round_ > zero) & (keys >= i8(0))
    away = one / greater(distance_inverse(keys), f4(1e-6))
    deep = lesser(greater(f4(0.5) + (away - ahead) * soft, zero), one)
    thick = select(inside, thickness * round_ * round_ * deep, zero)
    # 1 - exp(-t), nearly.
    thick *= one + f4(0.5) * thick
    return thick / (one + thick)


@kernel(inline=True)
def _mix(
    canvas: Canvas, i: int, j: int, cover: float, colour: Colour, pale: tuple[int, int, int]
) -> None:
    """Let a puff cover shares of eight pixels: of their light, which is about their bytes'
    squares.
    """
    if len(canvas.red) > 0:
        _mix_plane(canvas.red, i, j, cover, colour[0])
        _mix_plane(canvas.green, i, j, cover, colour[1])
        _mix_plane(canvas.blue, i, j, cover, colour[2])
        return
    pixels = canvas.pixels
    width = pixels.shape[1]
    inside = to_f4(lane_numbers()) < f4(width - j)
    at = (lane_numbers() + i4(i * width + j)) * i4(3)
    at = select(inside, at, i4(0))
    red = _mixed(gather(pixels, at), pale[0], cover)
    green = _mixed(gather(pixels, at + i4(1)), pale[1], cover)
    blue = _mixed(gather(pixels, at + i4(2)), pale[2], cover)
    write_pixels(pixels, i, j, bits_of(inside), pack(red, green, blue))


@kernel(inline=True)
def _mixed(before: int, over: int, cover: float) -> int:
    """Return the bytes of mixtures of light."""
    below, above = to_f4(before), f4(over)
    below *= below
    return to_u4(to_i4(root(below + cover * (above * above - below)) + f4(0.5)))


@kernel(inline=True)
def _mix_plane(plane: NDArray[np.float32], i: int, j: int, cover: float, colour: float) -> None:
    """Mix radiance."""
    width = plane.shape[1]
    numbers = lane_numbers()
    inside = to_f4(numbers) < f4(width - j)
    at = select(inside, numbers + i4(i * width + j), i4(0))
    before = gather(plane, at)
    write_plane(plane, i, j, bits_of(inside), before + cover * (colour - before))


@kernel(inline=True)
def on_screen(
    band: Band, ahead: float, left: float, up: float, reach: float
) -> tuple[float, float, float, float]:
    """Return row and column of a ball's middle, half its height and half its width [pixels]."""
    view = band.camera
    across = view.focal_x / (ahead * view.across)
    down = view.focal_y / (ahead * view.down)
    column = 0.5 * view.width / view.across - left * across
    row = 0.5 * view.height / view.down - up * down
    tall, wide = max(reach * down, 0.5), max(reach * across, 0.5)
    if band.glass.on == 1:
        column, row = shown_at(band.glass, ahead, left, up)
        aside, beside = shown_at(band.glass, ahead, left - reach, up)
        wide = math.sqrt((aside - column) ** 2 + (beside - row) ** 2)
        aside, beside = shown_at(band.glass, ahead, left, up - reach)
        tall = math.sqrt((aside - column) ** 2 + (beside - row) ** 2)
        wide, tall, row = max(wide, 0.5), max(tall, 0.5), row + band.glass.top
    return row, column, tall, wide
