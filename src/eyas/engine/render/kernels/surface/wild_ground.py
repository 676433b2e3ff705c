"""Ground that nobody tends: hillsides, heaths, deserts; their shores, paths and patches of snow."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.colours import Colour, blended, clip, where
from eyas.engine.render.kernels.hash_noise import seen_swing, swing
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.render.kernels.surface.texture import colour_of, texel
from eyas.engine.state.mesh import Surface
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, greater, magnitude, select, to_i4

HILLSIDE, HEATH = i4(int(Surface.HILLSIDE)), i4(int(Surface.HEATH))
DESERT, TRACK = i4(int(Surface.DESERT)), i4(int(Surface.DESERT_TRACK))
CAPPED, PATH = i4(int(Surface.DESERT_SNOW)), i4(int(Surface.HILLSIDE_PATH))
DRIFT, VERGE = i4(int(Surface.DESERT_DRIFT)), i4(int(Surface.HILLSIDE_VERGE))
GREEN_SHORE, HEATH_SHORE = i4(int(Surface.HILLSIDE_SHORE)), i4(int(Surface.HEATH_SHORE))


def bit(*surfaces: int) -> int:
    """Return the bits of some surfaces, see `wild`."""
    return sum(1 << int(surface) for surface in surfaces)


ON_GROUND = bit(*range(DESERT, max(Surface) + 1))  # Those whose texture lies on the ground
SANDY = bit(*range(DESERT, DRIFT + 1))
EDGED, TRODDEN = ON_GROUND & ~bit(DESERT), bit(TRACK, PATH)
STREWN, VERGES, SNOWY = bit(DRIFT), bit(VERGE), bit(CAPPED)
SHORES, HEATHY = bit(GREEN_SHORE, HEATH_SHORE), bit(HEATH, HEATH_SHORE)
HILLY = bit(HILLSIDE) | ON_GROUND & ~SANDY & ~HEATHY

NO_BLEND = False  # Mip levels of ridges are not blended: noise lies over where they meet

RIDGES = f4(1.0 / 54.0)
"""Repeats of the texture `sand` in a metre where its ripples are ridges of two metres and more."""

_ROCK = f4(0.75)  # Upward component of the normal below which rock shows, on average

_PER_SOIL = f4(4.0)  # About half of one over the mean green of the texture `soil`


@kernel(inline=True)
def downwind(point: Colour) -> tuple[float, float]:
    """Return a place down the desert's wind, and along the crests of ripples [m].

    The wind is that of the desert's plan, -35 degrees.
    """
    return (
        f4(0.819) * point[0] - f4(0.574) * point[1],
        f4(0.574) * point[0] + f4(0.819) * point[1],
    )


class Look(NamedTuple):
    """What is seen of a texture."""

    textures: NDArray[np.uint32]  # See `Geometry.texture`.
    layer: int  # Which of them
    detail: int  # From `detail_of`
    alpha: float  # 0 to 1


@kernel(inline=True)
def wild(
    surface: int,  # A `Surface` of each
    kinds: int,  # The bits of all of them
    look: Look,  # Of their textures
    colour: Colour,  # Of the textures
    along: float,  # u, where that is a distance [m]
    point: Colour,  # The point [m]
    rise: float,  # Upward component of its normal
    east: bool,  # Whether it faces east or west rather than north or south
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the colours of points with what grows or lies on wild ground, linear."""
    result = colour
    if kinds & HILLY != 0:
        hilly = (surface == HILLSIDE) | ((surface > DRIFT) & (surface != HEATH_SHORE))
        result = where(hilly, hillside(colour, point, rise, east, footprint), result)
    if kinds & HEATHY != 0:
        heathy = (surface == HEATH) | (surface == HEATH_SHORE)
        result = where(heathy, heath(colour, point, footprint), result)
    if kinds & SANDY != 0:
        sandy = (surface >= DESERT) & (surface <= DRIFT)
        result = where(sandy, desert(look, colour, point, rise), result)
    if kinds & EDGED != 0:
        result = _edged(surface, kinds, result, along, point, rise, footprint)
    return result


@kernel(inline=True)
def _edged(
    surface: int,
    kinds: int,
    colour: Colour,
    along: float,
    point: Colour,
    rise: float,
    footprint: float,
) -> Colour:
    """Return the colours of ground that changes along an edge, ragged by noise."""
    x, y, result = point[0], point[1], colour
    wide = seen_swing(x + f4(0.4) * y, y - f4(0.4) * x, f4(0.21), footprint)
    clump = seen_swing(x - f4(0.6) * y, y + f4(0.6) * x, f4(0.9), footprint)
    fine = seen_swing(x + f4(0.5) * y, y - f4(0.5) * x, f4(5.3), footprint)
    fine += f4(0.8) * seen_swing(x - f4(0.3) * y, y + f4(0.3) * x, f4(17.0), f4(2.0) * footprint)
    if kinds & TRODDEN != 0:
        trodden = (surface == TRACK) | (surface == PATH)
        ragged = along + f4(0.34) * clump + f4(0.3) * fine
        share = clip(f4(3.4) * ragged) * (f4(0.86) + f4(0.3) * wide)
        light = f4(0.86) + f4(0.5) * fine + f4(0.24) * clump
        earth = (f4(0.235) * light, f4(0.178) * light, f4(0.115) * light)
        # Wheels compact sand, and stir up what is darker below.
        sand = (f4(0.74) * colour[0], f4(0.72) * colour[1], f4(0.74) * colour[2])
        ground = where(surface == TRACK, sand, earth)
        result = where(trodden, blended(colour, ground, share), result)
    if kinds & STREWN != 0:
        ragged = along + f4(0.9) * wide + f4(1.2) * clump + f4(0.8) * fine
        share = clip(f4(0.9) * (ragged - f4(0.3)))
        light = f4(0.150) + f4(0.05) * fine
        result = where(
            surface == DRIFT,
            blended(result, (f4(1.03) * light, light, f4(0.94) * light), share),
            result,
        )
    if kinds & VERGES != 0:
        ragged = along + f4(0.5) * clump + f4(0.9) * fine + f4(0.2) * wide
        light = f4(0.9) + f4(0.8) * fine + f4(0.2) * clump
        gravel = (f4(0.255) * light, f4(0.225) * light, f4(0.180) * light)
        share = f4(0.95) * clip(f4(3.0) * (f4(1.0) - ragged))
        result = where(surface == VERGE, blended(result, gravel, share), result)
    if kinds & SHORES != 0:
        shore = (surface == GREEN_SHORE) | (surface == HEATH_SHORE)
        result = where(shore, _shore(colour, along, (wide, clump, fine)), result)
    if kinds & SNOWY != 0:
        # Thin snow lies in the lee of ripples and tufts first, and hardly where it is steep.
        over = f4(0.2) * (along - f4(32.0)) + f4(2.2) * wide + f4(1.3) * clump + f4(0.8) * fine
        over -= f4(2.4) * greater(f4(0.86) - rise, f4(0.0))
        share = f4(0.97) * clip(f4(0.9) * over + f4(0.1))
        light = f4(0.95) + f4(0.1) * wide + f4(0.05) * clump
        white = (f4(0.84) * light, f4(0.86) * light, f4(0.89) * light)
        result = where(surface == CAPPED, blended(colour, white, share), result)
    return result


@kernel(inline=True)
def _shore(
    colour: Colour,  # Of the land
    away: float,  # Distance from the water [m]
    noises: Colour,  # Wide, middle and fine noise, -0.5 to 0.5
) -> Colour:
    """Return the colour of a shore: wet mud, then sand and silt, then lush grass, then the land."""
    wide, clump, fine = noises
    ragged = away + f4(1.5) * wide + f4(1.0) * clump + f4(0.35) * fine
    grain = f4(0.9) + f4(0.5) * fine + f4(0.3) * clump
    lush = f4(0.75) * clip(f4(1.6) - f4(0.55) * magnitude(ragged - f4(3.4)))
    blades = f4(0.8) + f4(1.0) * fine + f4(0.4) * clump
    green = (f4(0.120) * blades, f4(0.140) * blades, f4(0.048) * blades)
    result = blended(colour, green, lush * clip(f4(0.7) + f4(2.0) * clump + f4(1.2) * fine))
    silt = (f4(0.255) * grain, f4(0.210) * grain, f4(0.150) * grain)
    result = blended(result, silt, clip(f4(1.6) * (f4(2.1) - ragged)))
    mud = (f4(0.075) * grain, f4(0.062) * grain, f4(0.046) * grain)
    return blended(result, mud, f4(0.92) * clip(f4(1.5) * (f4(0.95) - ragged)))


@kernel(inline=True)
def desert(look: Look, colour: Colour, point: Colour, rise: float) -> Colour:
    """Return the colour of a desert, linear: sand in ripples, flats of gravel, dry grass.

    Args:
        look: Of the texture of the sand: it is looked up again much larger, so its ripples are
            ridges there, and noise of many sizes costs little more than that of one.
        colour: Of the sand.
        point: The point [m].
        rise: Upward component of its normal.
    """
    half, one = f4(0.5), f4(1.0)
    down, along = downwind(point)
    wide = swing(f4(0.016) * down + f4(0.004) * along, f4(0.013) * along - f4(0.003) * down)
    coarser = to_i4(greater(look.detail - i4(811), i4(0)))
    low, high = texel(look.textures, look.layer, coarser, NO_BLEND, RIDGES * along, RIDGES * down)
    _, crest, _, patch = colour_of(low, high)
    ridge, patch, grit = crest * f4(1.908) - one, patch - half, look.alpha - half
    # Stones stay where the wind takes the sand away: on level ground, in broad stripes.
    level = clip(f4(14.0) * (rise - f4(0.93)))
    bare = f4(2.8) * wide + f4(1.4) * patch
    stony = level * clip(f4(1.6) * (bare + f4(1.6) * ridge + f4(0.8) * grit))
    light = one + (one - f4(0.75) * stony) * f4(1.15) * ridge + f4(0.42) * wide + f4(0.5) * grit
    red, green, blue = light * colour[0], light * colour[1], light * colour[2]
    pebble = f4(0.85) + f4(1.5) * grit + f4(0.3) * patch
    gravel = (f4(0.215) * pebble, f4(0.178) * pebble, f4(0.140) * pebble)
    red, green, blue = blended((red, green, blue), gravel, f4(0.75) * stony)
    # Grass finds water at the edges of the stony flats.
    dry = level * clip(f4(4.2) * (f4(0.34) - magnitude(bare + f4(0.45))))
    tuft = f4(0.2) + f4(2.6) * grit + f4(1.0) * patch
    blades = f4(0.8) + f4(1.1) * grit
    straw = (f4(0.140) * blades, f4(0.140) * blades, f4(0.066) * blades)
    return blended((red, green, blue), straw, f4(0.9) * dry * clip(tuft))


@kernel(inline=True)
def hillside(
    colour: Colour,  # Of the grass
    point: Colour,  # The point [m]
    rise: float,  # Upward component of its normal
    east: bool,  # Whether it faces east or west rather than north or south
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the colour of a hillside, linear."""
    one = f4(1.0)
    x, y, z = point
    # Each turned differently, to hide the square cells of the noise.
    wide = swing(f4(0.021) * x + f4(0.012) * y, f4(0.021) * y - f4(0.012) * x)
    tuft = seen_swing(x - f4(0.6) * y, y + f4(0.6) * x, f4(0.13), footprint)
    blade = seen_swing(x + f4(0.4) * y, y - f4(0.4) * x, f4(13.0), f4(4.0) * footprint)
    dry = clip(f4(0.12) + f4(1.5) * wide + f4(0.9) * tuft)
    bright = one + f4(0.28) * tuft + f4(0.5) * blade
    red = colour[0] * bright * (one + f4(0.62) * dry)
    green = colour[1] * bright * (one + f4(0.06) * dry)
    blue = colour[2] * bright * (one - f4(0.10) * dry)
    bare = clip((_ROCK - rise + f4(0.26) * tuft + f4(0.22) * wide) * f4(7.0))
    if any_of(bare > f4(0.0)):
        # Seen from the side that it faces, or the noise would be smeared.
        along = select(east, y, x)
        layer = seen_swing(f4(0.5) * along + z, f4(1.6) * z - f4(0.2) * along, f4(0.6), footprint)
        crack = seen_swing(along - f4(0.5) * z, z + f4(0.4) * along, f4(0.3), footprint)
        grain = seen_swing(along + f4(0.3) * z, z - f4(0.3) * along, f4(2.3), footprint)
        stone = f4(0.9) + f4(0.7) * layer + f4(0.6) * crack + f4(0.6) * grain
        # Grass keeps to the ledges.
        bare = clip(bare * (f4(1.05) - f4(0.9) * crack))
        rock = f4(0.178) * stone, f4(0.168) * stone, f4(0.152) * stone
        red, green, blue = blended((red, green, blue), rock, bare)
    return red, green, blue


@kernel(inline=True)
def heath(
    colour: Colour,  # Of the soil
    point: Colour,  # The point [m]
    footprint: float,  # Size of a pixel on the surface [m]
) -> Colour:
    """Return the colour of a heath, linear."""
    x, y = point[0], point[1]
    wide = swing(f4(0.016) * x + f4(0.009) * y, f4(0.016) * y - f4(0.009) * x)
    patch = seen_swing(x - f4(0.6) * y, y + f4(0.6) * x, f4(0.11), footprint)
    clump = seen_swing(x + f4(0.5) * y, y - f4(0.5) * x, f4(0.55), footprint)
    blade = seen_swing(x - f4(0.4) * y, y + f4(0.4) * x, f4(3.1), footprint)
    # Grass spreads from the hollows; scrub stands in it, in clumps with ragged edges.
    lush = f4(0.18) + f4(1.8) * wide + f4(1.6) * patch
    ragged = f4(0.62) * clump + f4(0.38) * blade
    cover = f4(0.8) * clip(lush + f4(2.6) * ragged + f4(0.35))
    scrub = f4(0.75) * cover * clip(lush + f4(6.0) * ragged - f4(0.96))
    # The grain of the soil shows through, and with it the size of what is seen.
    bright = (f4(0.8) + f4(0.5) * blade) * (f4(0.45) + colour[1] * _PER_SOIL)
    fresh = f4(0.055) * clip(lush + lush)
    grass = (f4(0.185) - fresh) * bright, f4(0.172) * bright, (f4(0.082) - f4(0.3) * fresh) * bright
    shrub = f4(0.056) * bright, f4(0.074) * bright, f4(0.030) * bright
    red, green, blue = blended(blended(colour, grass, cover), shrub, scrub)
    dust = f4(1.0) + f4(0.2) * wide
    return red * dust, green * dust, blue * dust
