"""The sky: its radiance in a direction, its pixels, and what smooth surfaces mirror of it.

Clouds and hills are panoramas, pictures of the whole sky round a viewer. Their columns go round the
horizon by a measure of azimuth that needs no trigonometry: along the square |x| + |y| = 1, from 0
in the east over 1 in the north to 4. Their rows start at the horizon. The value of a column or row
is that at its centre. Stars are not painted: each cell of the sky has at most one.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Canvas, Direction, Illumination, Light
from eyas.engine.render.kernels.colours import Colour, blended
from eyas.engine.render.kernels.pixels import keys_of, write_colours
from eyas.engine.render.kernels.rays import Rays, place_in_face, ray_of, rays_of
from eyas.engine.render.kernels.samples import own_rows, pixel_row
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.sky.fog import HAZE_END, hidden_at
from eyas.engine.render.kernels.sky.mist import glare, veil
from eyas.engine.render.kernels.sky.night import azimuth, moon_face, starlight, turned_stars
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    any_of,
    bits_of,
    gather,
    greater,
    lane_numbers,
    lesser,
    like,
    load,
    own,
    root,
    select,
    splat,
    to_f4,
    to_i4,
)

CLOUD_BEND = 0.8
"""Rows of the clouds' panorama lie at `z (1 + bend) / (z + bend)`: closer near the horizon."""

CLOUDS_FROM = 0.02  # Sine of the elevation above which clouds are visible

HILL_TOP = 0.08  # Sine of the elevation at which the hills' panorama ends

HILL_FARTHEST = 14.0  # Distance of the farthest hills [km]

_BEYOND = f4(1000.0 * (HILL_FARTHEST - HAZE_END))
_HAZE_DEPTH = f4(0.25 * 150.0)
"""A quarter of the depth of the haze if it were equally thick all the way up [m]."""
_FARTHEST = f4(1000.0 * HAZE_END)
_FOOT = f4(0.012)  # Sine of the elevation over which the plain turns into hills


@kernel(inline=True)
def _panorama(
    # Shape (rows, columns, channels); the number of columns is a power of 2
    values: NDArray[np.uint8],
    row: float,  # From -0.5; below the first and above the last row it is the row's
    around: float,  # See `azimuth`
    channel: int,  # Index of the channel
) -> float:
    """Return a channel, 0 to 1, interpolated between the four nearest values."""
    rows, columns, channels = values.shape
    row = lesser(greater(row, f4(0.0)), f4(rows - 1))
    # One round on: above 0, where cutting off is rounding down.
    column = (around * f4(0.25) + f4(1.0)) * f4(columns) - f4(0.5)
    low, left = to_i4(row), to_i4(column)
    up, across = row - to_f4(low), column - to_f4(left)
    high, mask = to_i4(lesser(low + i4(1), i4(rows - 1))), i4(columns - 1)
    left, right = left & mask, (left + i4(1)) & mask
    step, first = i4(channels), i4(channel)
    low, high = low * i4(columns), high * i4(columns)
    a = to_f4(gather(values, (low + left) * step + first))
    b = to_f4(gather(values, (low + right) * step + first))
    c = to_f4(gather(values, (high + left) * step + first))
    d = to_f4(gather(values, (high + right) * step + first))
    lower, upper = a + across * (b - a), c + across * (d - c)
    return (lower + up * (upper - lower)) * f4(1.0 / 255.0)


@kernel(inline=True)
def _dot(x: float, y: float, z: float, direction: Direction) -> float:
    """Return the cosine of the angle to a direction, at least 0."""
    return greater(x * direction.x + y * direction.y + z * direction.z, f4(0.0))


@kernel(inline=True)
def _air(
    lit: Illumination,  # Light and air
    z: float,  # Upward component of the direction, of length 1
    toward_sun: float,  # Cosine of its angle to the sun, at least 0
) -> tuple[float, float, float, float]:
    """Return the radiance of a cloudless sky and the transparency of the haze.

    Paler towards the horizon, and brighter round the sun.
    """
    zenith, horizon, fog, sun = lit.zenith, lit.horizon, lit.fog, lit.sun_colour
    up = greater(z, f4(0.0))
    climb = f4(1.0) - up
    low = climb * climb
    low *= low
    glow = toward_sun * toward_sun
    glow *= glow
    wide = f4(0.07) * glow * glow
    for _ in range(6):
        glow *= glow
    # exp(-thickness / z), nearly: the path through a layer of haze.
    clear = up / (up + (lit.fog_density * _HAZE_DEPTH + f4(1e-6)))
    clear *= clear
    clear *= clear
    glow = (wide + f4(0.3) * glow) * clear
    red, green, blue = blended(zenith, horizon, low)
    red, green, blue = blended(fog, (red, green, blue), clear)
    return red + glow * sun.x, green + glow * sun.y, blue + glow * sun.z, clear


@kernel(inline=True)
def sky(
    light: Light,  # Panoramas
    lit: Illumination,  # Light and air
    x: float,  # The direction
    y: float,  # The direction
    z: float,  # The direction
    pixel: float,  # Angle that a pixel spans [rad]
) -> Colour:
    """Return the colour of a direction of length 1 in which nothing stands.

    Stars by night, air, the sun or the moon, clouds in front of them, hills in front of all, far
    land below.
    """
    zero, one = like(z, f4(0.0)), like(z, f4(1.0))
    around = azimuth(x, y)
    cover = select(z > zero, zero, one)
    hilly = (z > zero) & (z < f4(HILL_TOP))
    if any_of(hilly):
        hills = _panorama(light.hills, _hill_row(light, z), around, 0)
        cover = select(hilly, hills, cover)
    colour = (zero, zero, zero)
    if any_of(cover < one):
        colour = _open_sky(light, lit, x, y, z, around, pixel)
    if any_of(cover > zero):
        colour = blended(colour, _hills(light, lit, z, around), cover)
    if lit.air.glare > f4(0.0):
        sun, way = lit.sun_colour, (x, y, z)
        shine = glare(lit, way) * (one - f4(0.6) * cover) + veil(lit, way)
        colour = colour[0] + shine * sun.x, colour[1] + shine * sun.y, colour[2] + shine * sun.z
    return colour


@kernel(inline=True)
def _open_sky(
    light: Light, lit: Illumination, x: float, y: float, z: float, around: float, pixel: float
) -> Colour:
    """Return the radiance of stars, air, sun or moon, and clouds."""
    zero, one, horizon, sun = f4(0.0), f4(1.0), lit.horizon, lit.sun_colour
    toward_sun = _dot(x, y, z, lit.sun)
    red, green, blue, clear = _air(lit, z, toward_sun)
    if lit.air.clouds > zero:
        rows = f4(len(light.clouds))
        row = z * f4(1.0 + CLOUD_BEND) / (greater(z, zero) + f4(CLOUD_BEND)) * rows - f4(0.5)
        # Far ones are lost in the haze.
        near = lesser(greater((z - f4(CLOUDS_FROM)) * f4(11.0), zero), one)
        near *= near * (f4(3.0) - f4(2.0) * near) * clear
        cover = near * _panorama(light.clouds, row, around, 0)
        bright = near * _panorama(light.clouds, row, around, 1)
        dim = f4(0.38) * cover + f4(0.7) * bright
        shine = f4(1.1) * bright
        red += dim * horizon.x + shine * sun.x - cover * red
        green += dim * horizon.y + shine * sun.y - cover * green
        blue += dim * horizon.z + shine * sun.z - cover * blue
        clear *= (one - cover) * (one - cover)
    # A disc 0.7 degrees wide, softer than the real one, and the bright ring around it.
    disc = lesser(greater((toward_sun - f4(0.999981)) * f4(80000.0), zero), one) * f4(30.0)
    ring = toward_sun * toward_sun
    for _ in range(10):
        ring *= ring
    if lit.air.moon_lit < one:
        disc *= moon_face(lit, x, y, z)
        ring *= lit.air.moon_lit
    disc = (disc + f4(1.5) * ring) * clear
    red, green, blue = red + disc * sun.x, green + disc * sun.y, blue + disc * sun.z
    if lit.air.stars > zero:
        if lit.air.star_sine != zero:
            x, y, z = turned_stars(lit, x, y, z)
            around = azimuth(x, y)
        star, tint = starlight(x, y, z, around, pixel)
        star *= clear * lit.air.stars
        red += star * (one + tint)
        green += star
        blue += star * (one - tint)
    return red, green, blue


@kernel(inline=True)
def _hill_row(light: Light, z: float) -> float:
    return z * f4(len(light.hills) / HILL_TOP) - f4(0.5)


@kernel(inline=True)
def _hills(light: Light, lit: Illumination, z: float, around: float) -> Colour:
    """Return the colour of the hills, and below the horizon of the far plain."""
    zero, one, hills = f4(0.0), f4(1.0), light.hills
    row = _hill_row(light, z)
    rise = lesser(greater(z / _FOOT, zero), one)
    direct = lit.sun.z + rise * (_panorama(hills, row, around, 1) - lit.sun.z)
    woods = rise * _panorama(hills, row, around, 2)
    away = _FARTHEST + rise * _BEYOND * _panorama(hills, row, around, 3)
    colour = blended(light.ground, (f4(0.035), f4(0.06), f4(0.025)), woods)
    white = lit.air.snow * (one - f4(0.75) * woods)
    red, green, blue = blended(colour, (f4(0.78), f4(0.80), f4(0.83)), white)
    sun, above = lit.sun_colour, lit.above
    red *= direct * sun.x + above.x
    green *= direct * sun.y + above.y
    blue *= direct * sun.z + above.z
    hidden = hidden_at(lit, away)
    if lit.air.mist > zero:
        # The layer of mist hides the foot of the hills and the plain below.
        deep = lesser(f4(250.0) * lit.air.mist, one) * (one - rise)
        hidden += deep * (one - hidden)
    return blended((red, green, blue), lit.fog, hidden)


@kernel(inline=True)
def surroundings(lit: Illumination) -> Colour:
    """Return the mean radiance of walls and trees: half in the sun, and half of the sky above."""
    sun, above, below, share = lit.sun_colour, lit.above, lit.below, f4(0.5)
    return (
        f4(0.26) * (share * (sun.x + above.x) + below.x),
        f4(0.24) * (share * (sun.y + above.y) + below.y),
        f4(0.21) * (share * (sun.z + above.z) + below.z),
    )


@kernel(inline=True)
def reflection(
    lit: Illumination,
    ray: Colour,
    normal: Colour,
    facing: float,
    least: float,
    sunlit: float,
    hidden: float,
) -> tuple[Colour, float]:
    """Return what a smooth surface mirrors, and the share of it (Schlick's formula).

    Args:
        lit: Sky and sun.
        ray: From the eye, of length 1.
        normal: Unit normal of the surface.
        facing: Minus their dot product, 0 to 1.
        least: Share that is mirrored when looking straight at it.
        sunlit: Share of the sun that reaches the surface.
        hidden: Share of the sky's light that things around take away there: they are mirrored
            where the sky would be low.
    """
    zero, one, sun = f4(0.0), f4(1.0), lit.sun_colour
    twice = f4(2.0) * facing
    x, y, z = ray[0] + twice * normal[0], ray[1] + twice * normal[1], ray[2] + twice * normal[2]
    graze = one - facing
    square = graze * graze
    share = least + (one - least) * square * square * graze
    # In a street, upright surfaces mirror low things, not the pale horizon.
    lower = z - f4(0.12)
    red, green, blue, _ = _air(lit, lower, _dot(x, y, lower, lit.sun))
    # Clouds and haze make it paler than the clear zenith.
    red, green, blue = blended((red, green, blue), lit.horizon, f4(0.4))
    below = lesser(greater(f4(-6.0) * lower, zero), one)
    below *= below * (f4(3.0) - f4(2.0) * below)
    below *= f4(0.9) * (one - lesser(lit.fog_density * f4(400.0), one))
    red, green, blue = blended((red, green, blue), lit.below, below)
    # Around a point that gets half of the sky's light, things are some 45 degrees high.
    around = lesser(greater((f4(1.5) * hidden - z) * f4(5.0), zero), one)
    around *= f4(0.8) * (one - below)
    red, green, blue = blended((red, green, blue), surroundings(lit), around)
    shine = _dot(x, y, z, lit.sun)
    for _ in range(7):
        shine *= shine
    shine *= f4(32.0) * sunlit
    return (red + shine * sun.x, green + shine * sun.y, blue + shine * sun.z), share


@kernel(inline=True)
def sky_colour(light: Light, lit: Illumination, rays: Rays, line: float, column: float) -> Colour:
    """Return the radiance of the sky at a place of the picture [samples]."""
    x, y, z = ray_of(rays, line, column)
    unit = f4(1.0) / root(x * x + y * y + z * z)
    return sky(light, lit, x * unit, y * unit, z * unit, rays.pixel)


@kernel(inline=True)
def _own_sky(
    light: Light, lit: Illumination, rays: Rays, line: float, column: float, chosen: int
) -> Colour:
    """Return what `_sky_of` does; each thread computes its own place, if it is chosen."""
    red, green, blue = f4(0.0), f4(0.0), f4(0.0)
    if (chosen >> own(lane_numbers())) & 1:
        red, green, blue = sky_colour(light, lit, rays, own(line), own(column))
    agree()
    return splat(red), splat(green), splat(blue)


@kernel(inline=True, threads=_own_sky)
def _sky_of(
    light: Light, lit: Illumination, rays: Rays, line: float, column: float, chosen: int
) -> Colour:
    """Return the radiance of the sky at eight places, of which some are chosen, a bit each."""
    return sky_colour(light, lit, rays, line, column)


@kernel(inline=True)
def _sky_bits(band: Band, row: int, first: int) -> int:
    """Return in which of eight pixels any sample shows the sky, a bit each."""
    bits, across, down = i8(0), band.camera.across, band.camera.down
    if down == 1:
        return bits_of(keys_of(band.key, row, first, 1) == i8(0))
    for i in range(down):
        for j in range(across):
            keys = keys_of(band.key, row * down + i, first * across + j, across)
            bits |= bits_of(keys == i8(0))
    return bits


@kernel(inline=True)
def _has_sky(band: Band, row: int) -> bool:
    """Return whether any sample of a row of pixels shows the sky, whose key is 0."""
    key, down, width = band.key, band.camera.down, band.columns * band.camera.across
    less = splat(i8(0))
    for line in range(row * down, (row + 1) * down):
        for first in range(0, width, WIDTH):
            last = max(width - WIDTH, 0)  # what lies beside the picture is 0
            keys = load(key, line * key.shape[1] + min(first, last))
            less |= (keys - i8(1)) & ~keys  # below 0 for 0 alone
    return width < WIDTH or any_of(less < i8(0))


@kernel(inline=True)
def _middle(band: Band, row: int, first: int) -> tuple[float, float]:
    """Return line and column in their face of the middles of eight pixels."""
    across, down = band.camera.across, band.camera.down
    line, column = splat(f4(0.0)), splat(f4(0.0))
    for i in range(down):
        for j in range(across):
            below, right, _ = place_in_face(band.glass, row * down + i, first * across + j, across)
            line, column = line + below, column + right
    part = f4(1.0) / f4(across * down)
    return line * part, column * part


@kernel
def draw_backdrop(
    band: Band,
    canvas: Canvas,  # Its colours
) -> None:
    """Write the sky at the centre of each pixel in which any sample shows it.

    Separate from `shade_band`, so that the code that shades surfaces stays small.
    """
    view, light, lit, width = band.camera, band.light, band.lit, band.columns
    rays, across, down = rays_of(view), f4(view.across), f4(view.down)
    for k in range(*own_rows(band, 0, band.lines)):
        row = pixel_row(band, k)
        if not _has_sky(band, row):
            continue
        for first in range(0, width, WIDTH):
            chosen = _sky_bits(band, row, first)
            if width - first < WIDTH:
                chosen &= (1 << (width - first)) - 1
            if chosen == 0:
                continue
            column = to_f4(lane_numbers()) * across + (f4(first) * across + f4(0.5) * across)
            line = splat(rays.top + f4(row) * down + f4(0.5) * down)
            if band.glass.on == 1:
                line, column = _middle(band, row, first)
            colour = _sky_of(light, lit, rays, line, column, chosen)
            write_colours(canvas, light, lit.air.exposure, row, first, chosen, colour)
