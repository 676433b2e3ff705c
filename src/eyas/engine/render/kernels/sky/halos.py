"""Glare of lamps at night: the light that a lens scatters round what is far too bright.

A halo belongs to the lens, and would lie over everything. Here what stands in front of a lamp has
none of it: then a lamp that is hidden has no halo, and no band need know what others show.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Canvas
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.light.caster import Caster, caster_of, has_lamps
from eyas.engine.render.kernels.light.lamps import DARK_SKY
from eyas.engine.render.kernels.pixels import keys_of, pack, write_pixels, write_plane
from eyas.engine.render.kernels.samples import own_rows, pixel_row
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.sky.flakes import seen_from
from eyas.engine.render.kernels.sky.plumes import on_screen
from eyas.engine.render.kernels.surface.signalling import BRAKING
from eyas.engine.render.kernels.visibility.cull import sphere_is_visible
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.engine.render.kernels.visibility.scene_iterator import end_of_thing, next_thing
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.lanes import address_of, kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    bits_of,
    gather,
    greater,
    lane_numbers,
    lesser,
    magnitude,
    root,
    select,
    to_f4,
    to_i4,
    to_u4,
)

_FILM = 0.38  # Share of a wet road under a film that mirrors, see `surface.wet`

_GLOSS = (14.0, 60.0)
"""How much brighter the mirror images of head and tail lamps on such a road are than their halos:
all their light, not the little that a lens scatters, but drawn out."""

_STREAK = (0.35, 4.0)  # Half the width of such an image [m], and its height over its width

_FARTHEST = 140.0  # Distance beyond which lamps have no halo [m]

_ANGLE = 0.042  # Angle from a lamp at which its halo ends [rad]

_CORE = 0.005
"""Angle at which it has half its peak [rad]; beyond, it falls with the square of the angle, as
disability glare does (CIE 146:2002)."""

_HEAD, _TAIL, _BRAKE = 700.0, 9.0, 36.0
"""Peak radiance times the square of the distance [m^2]: as thousands of candela of a dipped beam,
and the 12 and 60 of UN Regulation 7, through a lens that scatters some thousandth of the light."""

_STREET = 2500.0
"""The same of a street lamp in the middle of its beam; out of it, where its cover hides the light
source, `_ASTRAY` of that."""

_ASTRAY = 0.22  # By eye, beside photographs from drones

_BRIGHTEST = 3.0  # Largest peak: nearer lamps are larger than the core

_NOWHERE = -1e9  # z that stands for no road

_FAINTEST = 0.02  # Peak below which there is nothing to see

_WHITE: Colour = (f4(1.0), f4(0.94), f4(0.82))
_WARM: Colour = (f4(1.0), f4(0.80), f4(0.52))
_RED: Colour = (f4(1.0), f4(0.06), f4(0.035))


@kernel
def draw_halos(
    band: Band,
    canvas: Canvas,  # Its colours
) -> None:
    """Add the halos of street lamps, and of vehicles' lamps that face the camera, to a band."""
    _of_street_lamps(band, canvas)
    movers, world, eye = band.movers, band.world, band.camera.eye
    slots, lamps = movers.part.shape[1], movers.lamps
    first = next_thing(band, 0)
    while first < slots:
        last = end_of_thing(band, first)
        pose = movers.pose[world, first]
        x, y, z = float(pose[0, 3]), float(pose[1, 3]), float(pose[2, 3])
        away = math.sqrt((x - eye.x) ** 2 + (y - eye.y) ** 2 + (z - eye.z) ** 2)
        near = movers.object_id[world, first] >= ACTOR_OBJECT and away < _FARTHEST
        if near and sphere_is_visible(band.camera.planes, x, y, z, 4.0 + away * _ANGLE):
            if has_lamps(band, first, last):
                brakes = lamps.shape[1] > 0 and (lamps[world, first] & BRAKING) == BRAKING
                _of_vehicle(band, address_of(caster_of(band, first, last)), brakes, canvas)
        first = next_thing(band, last)


@kernel(inline=True)
def _of_street_lamps(band: Band, canvas: Canvas) -> None:
    eye, lamps = band.camera.eye, band.light.lamp
    if band.lit.zenith.y > DARK_SKY:
        return
    for index in range(len(lamps)):
        lamp = lamps[index]
        x, y, z = float(lamp[0]), float(lamp[1]), float(lamp[2])
        over_x, over_y, over_z = eye.x - x, eye.y - y, eye.z - z
        square = over_x * over_x + over_y * over_y + over_z * over_z + 1.0
        if square < _FARTHEST * _FARTHEST:
            away = math.sqrt(square)
            if sphere_is_visible(band.camera.planes, x, y, z, away * _ANGLE):
                facing = (lamp[3] * over_x + lamp[4] * over_y + lamp[5] * over_z) / away
                peak = _STREET * max(facing, _ASTRAY) / square
                _draw(band, (x, y, z), peak, _NOWHERE, _WARM, canvas)


@kernel(inline=True)
def _of_vehicle(band: Band, body: Caster, brakes: bool, canvas: Canvas) -> None:
    """Draw the halos of those lamps of a vehicle that face the camera."""
    eye, rear = band.camera.eye, _BRAKE if brakes else _TAIL
    for which in range(4):
        end = 1.0 if which < 2 else -1.0
        side = 0.72 * body.width * (1.0 if which & 1 else -1.0)
        reach = end * body.length
        x = body.x + reach * body.along_x - side * body.along_y
        y = body.y + reach * body.along_y + side * body.along_x
        z = body.bottom + (0.68 if which < 2 else 0.85)
        over_x, over_y, over_z = eye.x - x, eye.y - y, eye.z - z
        square = over_x * over_x + over_y * over_y + over_z * over_z + 1.0
        facing = end * (over_x * body.along_x + over_y * body.along_y) / math.sqrt(square)
        if facing <= 0.0:
            continue
        wet, peak = float(band.lit.air.wet), (_HEAD if which < 2 else rear) * facing / square
        if wet > 0.0 and band.glass.on == 0:
            # The road mirrors it as far below as it is above, by Schlick's formula.
            graze = 1.0 - (over_z + 2.0 * (z - body.bottom)) / math.sqrt(square)
            share = _FILM * wet * (0.02 + 0.98 * graze * graze * graze * graze * graze)
            share *= _GLOSS[0] if which < 2 else _GLOSS[1]
            below, tint = 2.0 * body.bottom - z, _WHITE if which < 2 else _RED
            _draw(band, (x, y, below), min(share * peak, 0.5), body.bottom, tint, canvas)
        # A dipped beam is cut off above the lamps: some of its light still goes up.
        facing *= facing
        if which < 2:
            facing *= facing * max(1.0 - 2.2 * over_z * over_z / square, 0.12)
        peak = (_HEAD if which < 2 else rear) * facing / square
        _draw(band, (x, y, z), peak, _NOWHERE, _WHITE if which < 2 else _RED, canvas)


@kernel
def _draw(
    band: Band,
    place: tuple[float, float, float],  # Of the lamp [m], or of its mirror image
    peak: float,
    road: float,  # z of the road that mirrors it, or `_NOWHERE`
    tint: Colour,
    canvas: Canvas,
) -> None:
    """Draw the halo of a lamp, or its image in a wet road."""
    mirrored, air = road > _NOWHERE, band.lit.air
    power = max(air.lamps, 0.3 * air.daytime_lamps) if mirrored else air.lamps
    if peak * power < _FAINTEST:
        return
    view, eye, (x, y, z) = band.camera, band.camera.eye, place
    ahead, left, up = seen_from(view, x - eye.x, y - eye.y, z - eye.z)
    if ahead < 0.5:
        return
    row, column, tall, wide = on_screen(
        band, ahead, left, up, _STREAK[0] + 0.01 * ahead if mirrored else _ANGLE * ahead
    )
    if mirrored:
        tall *= _STREAK[1]
    top = i8(view.top // view.down) if band.glass.on == 0 else i8(band.glass.top)
    first = max(i8(math.floor(row - tall)) - top, 0)
    last = min(i8(math.ceil(row + tall)) - top, band.lines)
    start = max(i8(math.floor(column - wide)), 0)
    stop = min(i8(math.ceil(column + wide)), band.columns)
    if first >= last or start >= stop:
        return
    strength = f4(min(peak, _BRIGHTEST) * power)
    colour = strength * tint[0], strength * tint[1], strength * tint[2]
    exposed = f4(band.lit.air.exposure)
    # A pixel cannot show a core that is smaller than itself.
    core = f4((_CORE / _ANGLE) ** 2 + 0.16 / (tall * wide))
    for k in range(*own_rows(band, first, last)):
        i = pixel_row(band, k)
        y = (i + top + 0.5 - row) / tall
        for j in range(start // WIDTH * WIDTH, stop, WIDTH):
            x = (to_f4(lane_numbers()) + f4(j + 0.5 - column)) * f4(1.0 / wide)
            away = f4(y * y) + x * x
            share = _seen(band, i, j, away, core, f4(ahead))
            if mirrored:
                share = _on_road(band, i, j, away, road)
            if any_of(share > f4(0.0)):
                _add(canvas, i, j, share, colour, exposed)


@kernel(inline=True)
def _seen(
    band: Band,
    i: int,  # Row of the pixels
    j: int,  # Column of the first
    away: float,  # Squared distances from the middle; 1 is the edge
    core: float,  # The same where half of the peak is left
    ahead: float,  # Distance of the lamp [m]
) -> float:
    """Return the shares of the peak in eight pixels."""
    zero, one, across = f4(0.0), f4(1.0), band.camera.across
    keys = keys_of(band.key, i * band.camera.down, j * across, across)
    inside = (away < one) & (keys >= i8(0))
    depth = one / greater(distance_inverse(keys), f4(1e-6))
    behind = lesser(greater((depth - ahead) * f4(0.8) + f4(1.6), zero), one)
    share = core / (core + away) - core / (core + one)
    return select(inside, behind * share, zero)


@kernel(inline=True)
def _on_road(band: Band, i: int, j: int, away: float, road: float) -> float:
    """Return the shares of the peak of a mirror image in eight pixels that show the road."""
    view, zero, one = band.camera, f4(0.0), f4(1.0)
    keys = keys_of(band.key, i * view.down, j * view.across, view.across)
    depth = one / greater(distance_inverse(keys), f4(1e-6))
    rise = view.up.z * (0.5 * view.height - view.top - (i + 0.5) * view.down) / view.focal_y
    aside = f4(0.5 * view.width - (j + 0.5) * view.across) - to_f4(lane_numbers()) * f4(view.across)
    slope = f4(view.ahead.z + rise) + f4(view.left.z / view.focal_x) * aside
    level = greater(one - f4(5.0) * magnitude(slope * depth + f4(view.eye.z - road)), zero)
    fade = one - away
    return select((away < one) & (keys > i8(0)), fade * fade * level, zero)


@kernel(inline=True)
def _add(canvas: Canvas, i: int, j: int, share: float, colour: Colour, exposed: float) -> None:
    """Add light to eight pixels: to their bytes' squares, which are about light."""
    if len(canvas.red) > 0:
        _add_plane(canvas.red, i, j, share * colour[0])
        _add_plane(canvas.green, i, j, share * colour[1])
        _add_plane(canvas.blue, i, j, share * colour[2])
        return
    pixels = canvas.pixels
    width = pixels.shape[1]
    inside = to_f4(lane_numbers()) < f4(width - j)
    at = (lane_numbers() + i4(i * width + j)) * i4(3)
    at = select(inside, at, i4(0))
    light = share * exposed
    red = _brighter(gather(pixels, at), light * colour[0])
    green = _brighter(gather(pixels, at + i4(1)), light * colour[1])
    blue = _brighter(gather(pixels, at + i4(2)), light * colour[2])
    write_pixels(pixels, i, j, bits_of(inside), pack(red, green, blue))


@kernel(inline=True)
def _brighter(before: int, light: float) -> int:
    """Return bytes with light added."""
    below = to_f4(before)
    square = lesser(below * below + light * f4(65025.0), f4(65025.0))
    return to_u4(to_i4(root(square) + f4(0.5)))


@kernel(inline=True)
def _add_plane(plane: NDArray[np.float32], i: int, j: int, light: float) -> None:
    """Add radiance."""
    width, numbers = plane.shape[1], lane_numbers()
    inside = to_f4(numbers) < f4(width - j)
    at = select(inside, numbers + i4(i * width + j), i4(0))
    write_plane(plane, i, j, bits_of(inside), gather(plane, at) + light)
