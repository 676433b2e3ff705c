"""The colour of one point of a surface: texture, paint, water, snow, light, mirrors, air."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band
from eyas.engine.render.kernels.colours import Colour, Vector, blended, where
from eyas.engine.render.kernels.light.ambient import openness
from eyas.engine.render.kernels.light.lamps import DARK_SKY, night_light, window_light
from eyas.engine.render.kernels.light.sunlight import sunlight
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.engine.render.kernels.sky.fog import bank_light, land_fog
from eyas.engine.render.kernels.sky.mist import aired
from eyas.engine.render.kernels.sky.radiance import reflection
from eyas.engine.render.kernels.surface.attributes import attributes_of, instance_frame
from eyas.engine.render.kernels.surface.litter import littered
from eyas.engine.render.kernels.surface.signalling import signalled
from eyas.engine.render.kernels.surface.snow import snowed
from eyas.engine.render.kernels.surface.texture import colour_of, detail_of, texel
from eyas.engine.render.kernels.surface.wet import wetted
from eyas.engine.render.kernels.surface.wild_ground import (
    DESERT,
    DRIFT,
    GREEN_SHORE,
    HEATH,
    HEATH_SHORE,
    HILLSIDE,
    ON_GROUND,
    SANDY,
    SHORES,
    Look,
    bit,
    downwind,
    wild,
)
from eyas.engine.render.kernels.wind import shimmer
from eyas.engine.state.mesh import MARGIN, Surface
from eyas.lanes import kernel
from eyas.lanes.vector import (
    any_bits,
    any_of,
    greater,
    lesser,
    like,
    magnitude,
    root,
    select,
    to_f4,
    to_i4,
)

PAINT = i4(int(Surface.PAINT))
GLASS = i4(int(Surface.GLASS))
FOLIAGE = i4(int(Surface.FOLIAGE))
CROWN = i4(int(Surface.CROWN))
FACADE = i4(int(Surface.FACADE))
WATER = i4(int(Surface.WATER))
SIGNAL = i4(int(Surface.SIGNAL))
MARKING = i4(int(Surface.MARKING))

WET, MARKED, PAINTED, LEAFY = bit(WATER), bit(MARKING), bit(PAINT), bit(FOLIAGE)
SIGNALS, WINDOWS, LEAVES = bit(SIGNAL), bit(FACADE), bit(FOLIAGE, CROWN)
SMOOTH = bit(PAINT, WATER, FACADE, GLASS)  # What mirrors
LEVEL, UNTENDED = MARKED | ON_GROUND, bit(HILLSIDE, HEATH) | ON_GROUND

SHARP = f4(0.004)
"""Mip levels are blended if a pixel spans less [rad]. In smaller pictures, each level lies in a few
rows of pixels, and a blend would cost a tenth of the shading to hide what is hardly seen."""

TILES = f4(1.0 / 8.0)  # Repeats of the texture in a metre where u is something else, see `Surface`

SAND = f4(1.0 / 6.0)  # The same of sand

_WIDEST = f4(2.0 * MARGIN)

_FAINT = f4(0.013)  # Radiance at which half of the colour is lost


@kernel(inline=True)
def water_slope(
    textures: NDArray[np.uint32], layer: int, detail: int, blend: bool, u: float, v: float
) -> tuple[float, float]:
    """Return the slope of the waves eastwards and northwards, see the texture `water`.

    Two sizes of waves that share no period, the smaller ones turned by a right angle, so that
    no repeat is seen.
    """
    low, high = texel(textures, layer, detail, blend, u, v)
    large_u, large_v, _, _ = colour_of(low, high)
    finer = to_i4(lesser(detail + i4(256), i4(2048)))
    low, high = texel(textures, layer, finer, blend, f4(2.31) * v + f4(0.37), f4(-2.31) * u)
    small_u, small_v, _, _ = colour_of(low, high)
    half = f4(0.5)
    # The small waves' own v runs west, their u north.
    return ((large_u - half) - half * (small_v - half), (large_v - half) + half * (small_u - half))


@kernel(inline=True)
def painted_share(
    across: float,  # u, see `Surface.MARKING`
    slope: Vector,  # Gradient of u [1/m]
    scale: float,  # Its length: one over half the width of the line [1/m]
    way: Vector,  # Unit vector from the eye
    cosine: float,  # Of the angle between the normal and the way to the eye
    size: float,  # Width of the pixel at the point, seen from the front [m]
) -> float:
    """Return the share of a pixel that a line covers, 0 to 1.

    The pixel is a strip along the line, as wide as the pixel reaches across it, but not wider than
    the margins let be seen: lines farther away are as bright on average, but less steady.
    """
    one = f4(1.0)
    # A pixel is a circle seen from the front; on the ground it is longer along the view.
    lean = (slope[0] * way[0] + slope[1] * way[1] + slope[2] * way[2]) / greater(cosine, f4(0.05))
    wide = lesser(size * root(scale * scale + lean * lean), _WIDEST * scale)
    half = greater(f4(0.5) * wide, f4(1e-3))
    away = magnitude(across - f4(32.0))
    shown = lesser(away + half, one) - greater(away - half, f4(-1.0))
    return greater(shown, f4(0.0)) / (half + half)


@kernel(inline=True)
def _byte(word: int, at: int) -> float:
    return to_f4(to_i4((word >> u4(at)) & u4(255)))


@kernel(inline=True)
def _dot(a: Colour, b: Colour) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel(inline=True)
def _wavy(
    textures: NDArray[np.uint32],
    layer: int,
    detail: int,
    blend: bool,
    uv: tuple[float, float],
    normal: Colour,
    cosine: float,
) -> tuple[Colour, float]:
    """Return the normal of water with waves, and how much light they gather."""
    slope_x, slope_y = water_slope(textures, layer, detail, blend, uv[0], uv[1])
    # Seen at a grazing angle, the far sides of waves are hidden: none mirrors the ground.
    calm = lesser(greater(f4(1.5) * cosine, f4(0.1)), f4(1.0))
    slope_x *= calm
    slope_y *= calm
    x, y, z = normal[0] - slope_x, normal[1] - slope_y, normal[2]
    scale = f4(1.0) / root(x * x + y * y + z * z + f4(1e-12))
    return (x * scale, y * scale, z * scale), f4(1.0) + f4(0.8) * (slope_x + slope_y)


@kernel(inline=True)
def _smoothness(surface: int, alpha: float) -> float:
    """Return the share of light that a surface mirrors at normal incidence."""
    zero = f4(0.0)
    painted = select(surface == PAINT, f4(0.05) * alpha, zero)  # cloth has none
    glassy = select(surface == GLASS, like(alpha, f4(0.09)), zero)
    wet = select(surface == WATER, like(alpha, f4(0.04)), zero)
    return painted + glassy + wet + select(surface == FACADE, f4(0.16) * (f4(1.0) - alpha), zero)


@kernel(inline=True)
def shade_point(
    band: Band,
    row: int,
    triangle: int,
    eye: Colour,
    ray: Colour,
    distance: float,
    pixel: float,
    shade: int,
) -> Colour:
    """Return the linear radiance of a point, air included.

    Args:
        band: The band.
        row: The fixture or part that it belongs to, a row of `Band.drawn`, or -1 for the static
            mesh; the same for all lanes.
        triangle: Index of the triangle.
        eye: Optical centre [m].
        ray: From the eye, of length 1 along the optical axis.
        distance: Along the optical axis [m].
        pixel: Angle that a pixel spans [rad].
        shade: Effect of moving things on its light, four bytes, see `Scratch.shade`.
    """
    geometry, light, lit, air = band.geometry, band.light, band.lit, band.lit.air
    one, zero = f4(1.0), f4(0.0)
    point = (eye[0] + ray[0] * distance, eye[1] + ray[1] * distance, eye[2] + ray[2] * distance)
    at = attributes_of(band, row, triangle, point)
    normal, surface = at.normal, at.surface
    # Of which kinds any point is: a number tells it faster than masks do, one for each kind.
    kinds = any_bits(to_i4(like(surface, i4(1)) << surface))
    stretch = root(_dot(ray, ray))
    shrink = one / stretch
    way = (ray[0] * shrink, ray[1] * shrink, ray[2] * shrink)
    cosine = -_dot(normal, way)
    if air.windy > zero and kinds & LEAVES != 0:
        leaves = (surface == FOLIAGE) | (surface == CROWN)
        turned = shimmer(lit.wind, point, normal, distance * pixel)
        normal = where(leaves, turned, normal)

    u, v, density = at.u, at.v, at.density
    if kinds & LEVEL != 0:
        level = (surface == MARKING) | (surface >= DESERT)
        u, v = select(level, TILES * point[0], u), select(level, TILES * point[1], v)
        density = select(level, like(density, TILES), density)
        if kinds & SANDY != 0:  # its ripples lie across the wind
            sandy = (surface >= DESERT) & (surface <= DRIFT)
            down, along = downwind(point)
            u, v = select(sandy, SAND * along, u), select(sandy, SAND * down, v)
            density = select(sandy, like(density, SAND), density)
    span = f4(256.0) * density * distance * pixel
    lean = one / greater(magnitude(cosine), f4(0.1))
    detail = detail_of(span * span * lean)
    blend = pixel < SHARP
    bright = like(span, one)
    if kinds & WET != 0:
        waves, bright = _wavy(
            geometry.texture, at.layer, detail, blend, (at.u, at.v), normal, cosine
        )
        normal = where(surface == WATER, waves, normal)
        cosine = -_dot(normal, way)

    # What lies anywhere in memory is read in one go, so that one wait for it covers the others.
    unit = f4(1.0 / 255.0)
    sun_share, sky_share = _byte(shade, 0) * unit, _byte(shade, 8) * unit
    direct, reaching = like(sun_share, zero), like(sun_share, zero)
    if lit.sun_colour.x > zero:  # not below a closed sky
        direct, reaching = sunlight(
            light, lit.sun, air.offset, point, normal, sun_share,
            surface == FOLIAGE, kinds & LEAFY != 0,
        )  # fmt: skip
    worn_here = row < 0 and any_of(normal[2] > f4(0.2))
    x, y, z = point
    open_share, worn = openness(light, x, y, z, normal[0], normal[1], worn_here)
    low, high = texel(geometry.texture, at.layer, detail, blend, u, v)
    asphalt_r, asphalt_g, asphalt_b, alpha = colour_of(low, high)
    red, green, blue = asphalt_r * at.tint[0], asphalt_g * at.tint[1], asphalt_b * at.tint[2]
    if kinds & MARKED != 0:
        share = painted_share(at.u, at.u_slope, at.density, way, cosine, distance * pixel)
        paint, rest = share * alpha, one - share
        marked = (
            paint * at.tint[0] + rest * asphalt_r,
            paint * at.tint[1] + rest * asphalt_g,
            paint * at.tint[2] + rest * asphalt_b,
        )
        red, green, blue = where(surface == MARKING, marked, (red, green, blue))
    if row >= 0 and kinds & PAINTED != 0:
        frame = instance_frame(band, row)
        coat = red * frame.red, green * frame.green, blue * frame.blue
        red, green, blue = where(surface == PAINT, coat, (red, green, blue))
    if kinds & WET != 0:
        water = at.tint[0] * bright, at.tint[1] * bright, at.tint[2] * bright
        red, green, blue = where(surface == WATER, water, (red, green, blue))
    if kinds & UNTENDED != 0:
        footprint = distance * pixel / greater(magnitude(cosine), f4(0.1))
        look = Look(geometry.texture, at.layer, detail, alpha)
        east = magnitude(normal[0]) > magnitude(normal[1])
        red, green, blue = wild(
            surface, kinds, look, (red, green, blue), at.u, point, normal[2], east, footprint
        )
    if worn_here:  # ground and roofs are nowhere alike, less so far away, where that would flicker
        close = lesser(greater(f4(2.0) - distance * pixel * lean, f4(0.4)), one)
        worn *= close * select(normal[2] > f4(0.2), normal[2], zero)  # each lane by itself
        red *= one + f4(1.12) * worn
        green *= one + worn
        blue *= one + f4(0.85) * worn
    if air.snow > zero:
        footprint = distance * pixel / greater(magnitude(cosine), f4(0.1))
        bare_r, bare_g, bare_b = red, green, blue
        red, green, blue = snowed(
            (red, green, blue), light, air.snow, at.bed, at.crown_middle, point, at.own,
            normal[2], footprint,
        )  # fmt: skip
        if kinds & SHORES != 0:  # it melts where the water wets it
            shore = (surface == GREEN_SHORE) | (surface == HEATH_SHORE)
            melted = select(shore, lesser(greater(f4(1.5) - at.u, zero), one), zero)
            red, green, blue = blended((red, green, blue), (bare_r, bare_g, bare_b), melted)
    if air.litter > zero:
        footprint = distance * pixel / greater(magnitude(cosine), f4(0.1))
        red, green, blue = littered(
            (red, green, blue), light, air.litter, at.bed, point, normal[2], footprint
        )

    tilt = f4(0.5) * normal[2]
    if kinds & LEAFY != 0:  # leaves get light through those above
        tilt = select(surface == FOLIAGE, f4(0.2) + f4(0.5) * tilt, tilt)
    up, down = (f4(0.5) + tilt) * sky_share, (f4(0.5) - tilt) * sky_share * open_share
    # Where walls hide the sky, what they and the ground throw back is not blue.
    seen, thrown = up * open_share, up * (one - open_share)
    sun, above, below, tinge = lit.sun_colour, lit.above, lit.below, lit.tinge
    light_r = direct * sun.x + seen * above.x + thrown * tinge.x + down * below.x
    light_g = direct * sun.y + seen * above.y + thrown * tinge.y + down * below.y
    light_b = direct * sun.z + seen * above.z + thrown * tinge.z + down * below.z
    if kinds & SIGNALS != 0:
        glow = select(surface == SIGNAL, at.emission, zero)
        light_r, light_g, light_b = light_r + glow, light_g + glow, light_b + glow
    if air.lamps > zero:
        head, tail = _byte(shade, 16), _byte(shade, 24)
        lamp_r, lamp_g, lamp_b = night_light(light, air.lamps, point, normal, head, tail)
        glow = air.lamps * select(surface == SIGNAL, zero, at.emission)
        light_r += lamp_r + glow
        light_g += lamp_g + glow
        light_b += lamp_b + glow
    elif air.daytime_lamps > zero:
        glow = air.daytime_lamps * select(surface == SIGNAL, zero, at.emission)
        light_r, light_g, light_b = light_r + glow, light_g + glow, light_b + glow
    if air.windows > zero and kinds & WINDOWS != 0:
        shown = select(surface == FACADE, one - alpha, zero)
        window_r, window_g, window_b = window_light(air.windows, at.building, detail, at.u, at.v)
        # Blinds and curtains are paler than dark rooms, so more light comes out through them.
        red, green, blue = (
            red * light_r + window_r * shown * (f4(0.35) + shown * red),
            green * light_g + window_g * shown * (f4(0.35) + shown * green),
            blue * light_b + window_b * shown * (f4(0.35) + shown * blue),
        )
    else:
        red, green, blue = red * light_r, green * light_g, blue * light_b
    if lit.zenith.y < DARK_SKY:  # a camera's grain leaves no colour to what is hardly lit
        bright = greater(red, green)
        faint = _FAINT / (_FAINT + bright)
        red += faint * (bright - red)
        green += faint * (bright - green)
        blue += faint * (bright - blue)
    if row >= 0:
        shining = instance_frame(band, row).lamps
        if shining != i4(0):
            red, green, blue = signalled((red, green, blue), surface, shining)
    if kinds & SMOOTH != 0:
        mirror = _smoothness(surface, alpha)
        if any_of(mirror > zero):
            facing = lesser(greater(cosine, zero), one)
            # Panes are flat: all of one would glint at once.
            glint = reaching * select(surface == GLASS, like(mirror, f4(0.12)), one)
            mirrored, share = reflection(lit, way, normal, facing, mirror, glint, one - open_share)
            # Clear coat is no perfect mirror, even at a grazing angle.
            coat = select(surface == PAINT, like(alpha, f4(0.85)), one)
            share *= select(surface == FACADE, one - alpha, coat)
            share = select(mirror > zero, share, zero)
            red, green, blue = blended((red, green, blue), mirrored, share)
    if air.wet > zero:
        unblocked = _byte(shade, 8) * unit
        footprint = distance * pixel / greater(magnitude(cosine), f4(0.1))
        red, green, blue = wetted(
            light, lit, (red, green, blue), at.bed, point, normal, way, open_share, unblocked,
            footprint,
        )  # fmt: skip
    if air.mist > zero or air.glare > zero:
        colour = red, green, blue
        red, green, blue = aired(light, lit, colour, eye, point, way, distance * stretch)
    elif lit.fog_density > zero:
        hidden = land_fog(light, lit, eye, point, distance * stretch)
        if air.banks > zero:
            shine = bank_light(lit, way[2])
            haze = shine * lit.fog.x, shine * lit.fog.y, shine * lit.fog.z
            red, green, blue = blended((red, green, blue), haze, hidden)
        else:
            red, green, blue = blended((red, green, blue), lit.fog, hidden)
    return red, green, blue
