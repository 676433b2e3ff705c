"""What falls: snow, rain and leaves, how each moves and looks."""

import math
from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Band, Illumination, Light
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.light.lamps import night_light
from eyas.engine.render.kernels.light.land import land_at
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel

_CROWN = 16.0  # Height above the ground up to which leaves fall [m]


class FallingKind(NamedTuple):
    """How one kind of thing falls and looks."""

    shells: int  # Shells around the camera; each reaches `GROWTH` times as far as the one before
    cells: float  # Cells from the camera to the end of a shell
    flakes: float  # Largest number of flakes in a cell where they are densest
    calm_x: float  # Velocity eastwards in calm air [m/s]
    calm_y: float  # Velocity northwards in calm air [m/s]
    sinking: float  # Velocity downwards [m/s]
    sway: float  # Amplitude [m]
    exposed: float  # Exposure time of the picture, which turns flakes into streaks [s]
    radius: float  # Radius of the largest flake at the camera [m]
    growth: float  # Growth of that with distance: a distant flake represents several
    smallest: float  # Radius below which flakes are invisible [pixels]
    cover: float  # Opacity of a flake that covers its pixels
    thin: bool  # Whether it is a streak however small it is: half as wide hides half as much
    lit: bool  # Whether street lamps light each of it
    coloured: bool  # Whether each has a colour of its own


SNOW = FallingKind(
    shells=3,
    cells=6.0,
    flakes=10.0,
    calm_x=0.55,
    calm_y=0.3,
    sinking=1.25,
    sway=0.06,
    exposed=1.0 / 110.0,
    radius=0.0042,
    growth=0.00045,
    smallest=0.35,
    cover=0.8,
    thin=False,
    lit=True,
    coloured=False,
)

# Drops of 2 to 3 mm fall at 6.5 to 8 m/s (Gunn and Kinzer, Journal of Meteorology 6, 1949).
RAIN = FallingKind(
    shells=3,
    cells=4.0,
    flakes=13.0,
    calm_x=1.3,
    calm_y=0.7,
    sinking=7.5,
    sway=0.0,
    exposed=1.0 / 60.0,
    radius=0.0018,
    growth=0.0008,
    smallest=0.24,
    cover=0.8,
    thin=True,
    lit=True,
    coloured=False,
)

LEAVES = FallingKind(
    shells=3,
    cells=4.0,
    flakes=3.0,
    calm_x=1.5,
    calm_y=0.8,
    sinking=0.85,
    sway=0.22,
    exposed=1.0 / 110.0,
    radius=0.026,
    growth=0.0,
    smallest=0.4,
    cover=1.0,
    thin=False,
    lit=False,
    coloured=True,
)


class Falling(NamedTuple):
    """What falls in a picture."""

    kind: FallingKind
    most: int  # Largest number of flakes in a cell
    wind_x: float  # Velocity eastwards [m/s]
    wind_y: float  # Velocity northwards [m/s]


@kernel(inline=True)
def drift(lit: Illumination, calm_x: float, calm_y: float) -> tuple[float, float]:
    """Return the horizontal velocity of what falls [m/s]: the wind's, or its own in calm air."""
    x, y = calm_x, calm_y
    if lit.air.windy > f4(0.0):
        x, y = float(lit.wind.x), float(lit.wind.y)
    return x, y


@kernel(inline=True)
def falling_of(kind: FallingKind, density: float, lit: Illumination) -> Falling:
    """Return how a kind of thing falls at a density, 0 to 1."""
    most = math.ceil(kind.flakes * density)
    wind_x, wind_y = drift(lit, kind.calm_x, kind.calm_y)
    return Falling(kind, most, wind_x, wind_y)


@kernel(inline=True)
def sky_lit(lit: Illumination) -> tuple[float, float, float]:
    """Return a flake's radiance: sky and lit streets light it, and some sunlight shines through."""
    above, sun, streets = lit.above, lit.sun_colour, lit.tinge
    return (
        f4(1.1) * above.x + f4(0.25) * sun.x + f4(0.35) * streets.x,
        f4(1.1) * above.y + f4(0.25) * sun.y + f4(0.35) * streets.y,
        f4(1.1) * above.z + f4(0.25) * sun.z + f4(0.35) * streets.z,
    )


@kernel(inline=True)
def drop_lit(lit: Illumination) -> tuple[float, float, float]:
    """Return a drop's radiance: it refracts a wide part of the sky and of the ground (Garg and
    Nayar, Vision and rain, International Journal of Computer Vision 75, 2007).
    """
    zenith, horizon, below, share = lit.zenith, lit.horizon, lit.below, f4(0.62)
    return (
        share * (zenith.x + horizon.x) + below.x,
        share * (zenith.y + horizon.y) + below.y,
        share * (zenith.z + horizon.z) + below.z,
    )


@kernel(inline=True)
def under_trees(
    light: Light,  # Says where trees are
    x: float,  # The point [m]
    y: float,  # The point [m]
    z: float,  # The point [m]
    chance: float,  # Of the leaf, 0 to 1
) -> bool:
    """Return whether a leaf falls at a point: near trees, or now and then where wind blows it."""
    if z > light.ambient_frame.ground + _CROWN:
        return False
    under, _ = land_at(light, f4(x), f4(y))
    return bool(under > f4(0.9 * chance) or chance < 0.06)


@kernel(inline=True)
def leaf_colour(white: Colour, tone: float) -> Colour:
    """Return the radiance of a yellow to brown leaf, for that of a white one."""
    red, brown = f4(0.80 - 0.45 * tone), f4(tone)
    return (
        red * white[0],
        red * (f4(0.62) - f4(0.22) * brown) * white[1],
        f4(0.16) * red * white[2],
    )


@kernel(inline=True)
def lit_by_lamps(colour: Colour, band: Band, place: tuple[float, float, float]) -> Colour:
    """Return the radiance of a drop with the light of street lamps there."""
    up, none = (f4(0.0), f4(0.0), f4(1.0)), f4(0.0)
    point = f4(place[0]), f4(place[1]), f4(place[2])
    red, green, blue = night_light(band.light, band.lit.air.lamps, point, up, none, none)
    return colour[0] + red, colour[1] + green, colour[2] + blue
