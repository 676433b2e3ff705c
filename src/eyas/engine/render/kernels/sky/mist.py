"""Mist that lies on the land, and light that haze and lens scatter forward from a low sun."""

from eyas.engine.render.kernels.bundles import Illumination, Light
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.hash_noise import noise
from eyas.engine.render.kernels.light.land import land_at
from eyas.engine.render.kernels.scalars import f4
from eyas.engine.render.kernels.sky.fog import land_fog, vanishing
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser


@kernel(inline=True)
def mist_share(
    light: Light,  # Says where land is open
    lit: Illumination,  # Light and air
    eye: Colour,  # Optical centre [m]
    point: Colour,  # The point [m]
    away: float,  # Distance between them [m]
) -> float:
    """Return how much of what lies at a point the mist hides, 0 to 1.

    Its extinction falls off with height as `exp(-z / depth)`; along a ray from z1 to z2 the mean
    is `(exp(-z1 / depth) - exp(-z2 / depth)) depth / (z2 - z1)`.
    """
    zero, one, half, air = f4(0.0), f4(1.0), f4(0.5), lit.air
    ground, deep = light.ambient_frame.ground, air.per_mist_depth
    here = greater((point[2] - ground) * deep, zero)
    there = greater((eye[2] - ground) * deep, zero)
    low, climb = lesser(here, there), greater(greater(here, there) - lesser(here, there), f4(0.02))
    mean = (vanishing(low) - vanishing(low + climb)) / climb
    # Looked up in the middle of the part of the ray that lies within the layer, seen from above.
    part = half * lesser(one / climb, one)
    x, y = point[0] + part * (eye[0] - point[0]), point[1] + part * (eye[1] - point[1])
    _, open_ = land_at(light, x, y)
    _, open_here = land_at(light, point[0], point[1])
    wisps = f4(0.35) + f4(1.3) * noise(f4(0.021) * x + f4(0.011) * y, f4(0.034) * y - f4(0.012) * x)
    thickness = air.mist * mean * away * wisps * half * (open_ + open_here)
    return one - vanishing(thickness)


@kernel(inline=True)
def _toward(lit: Illumination, way: Colour) -> tuple[float, float]:
    """Return powers 8 and 64 of the cosine of the angle to the sun."""
    sun = lit.sun
    cosine = greater(way[0] * sun.x + way[1] * sun.y + way[2] * sun.z, f4(0.0))
    wide = cosine * cosine
    wide *= wide
    wide *= wide
    narrow = wide * wide
    narrow *= narrow
    return wide, narrow * narrow


@kernel(inline=True)
def glare(lit: Illumination, way: Colour) -> float:
    """Return the radiance of haze in a direction of length 1 over that of white in the sun.

    Two lobes in the place of Mie's phase function, which has its peak forward.
    """
    wide, narrow = _toward(lit, way)
    return lit.air.glare * (f4(0.22) * wide + f4(0.55) * narrow)


@kernel(inline=True)
def veil(lit: Illumination, way: Colour) -> float:
    """Return the same of the light that the lens scatters over all it sees, if the sun meets it."""
    wide, narrow = _toward(lit, way)
    return lit.air.glare * lit.air.veil * (f4(0.035) * wide + f4(0.16) * narrow)


@kernel(inline=True)
def aired(
    light: Light,  # Says where land is open
    lit: Illumination,  # Light and air
    colour: Colour,  # Radiance of the surface
    eye: Colour,  # Optical centre [m]
    point: Colour,  # The point [m]
    way: Colour,  # Unit vector from the eye
    away: float,  # Distance [m]
) -> Colour:
    """Return the radiance of a surface through air with mist and glare."""
    sun, fog, clear = lit.sun_colour, lit.fog, f4(1.0) - land_fog(light, lit, eye, point, away)
    if lit.air.mist > f4(0.0):
        clear *= f4(1.0) - mist_share(light, lit, eye, point, away)
    shine = glare(lit, way) * (f4(1.0) - clear)
    shine += veil(lit, way)
    red, green, blue = colour
    return (
        fog.x + clear * (red - fog.x) + shine * sun.x,
        fog.y + clear * (green - fog.y) + shine * sun.y,
        fog.z + clear * (blue - fog.z) + shine * sun.z,
    )
