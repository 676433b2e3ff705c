"""The sky in a direction, and the air between the camera and things."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.sky.panorama import azimuth, panorama

__all__ = [
    "CLOUDS_FROM",
    "CLOUD_BEND",
    "HAZE_END",
    "HILL_FARTHEST",
    "HILL_TOP",
    "fog_share",
    "reflection",
    "sky",
]

CLOUD_BEND = 0.8
"""Rows of the clouds' panorama lie at `z (1 + bend) / (z + bend)`: closer near the horizon."""

CLOUDS_FROM = 0.02
"""Sine of the elevation above which clouds are visible."""

HILL_TOP = 0.08
"""Sine of the elevation at which the hills' panorama ends."""

HAZE_END = 4.0
"""Distance beyond which land gets no hazier, and at which the hills begin [km]. So the foot of
the hills matches the end of the land, however high the viewer is."""

HILL_FARTHEST = 14.0
"""Distance of the farthest hills [km]."""

_BEYOND = f4(1000.0 * (HILL_FARTHEST - HAZE_END))
_HAZE_DEPTH = f4(0.25 * 150.0)
"""A quarter of the depth of the haze if it were equally thick all the way up [m]."""
_FOOT = f4(0.012)
"""Sine of the elevation over which the plain turns into hills."""


@inlined_kernel
def _air(light: Light, x: float, y: float, z: float) -> tuple[float, float, float, float, float]:
    """Return the radiance of a cloudless sky, the transparency of the haze, and the sun's glow.

    Paler towards the horizon, and brighter round the sun.
    """
    zero, one = f4(0.0), f4(1.0)
    up = max(z, zero)
    climb = one - up
    low = climb * climb
    low *= low
    toward_sun = max(x * light.sun[0] + y * light.sun[1] + z * light.sun[2], zero)
    glow = toward_sun * toward_sun
    glow *= glow
    wide = f4(0.07) * glow * glow
    for _ in range(6):
        glow *= glow
    # exp(-thickness / z), nearly: the path through a layer of haze.
    clear = up / (up + light.air[0] * _HAZE_DEPTH + f4(1e-6))
    clear *= clear
    clear *= clear
    glow = (wide + f4(0.3) * glow) * clear
    red = light.zenith[0] + low * (light.horizon[0] - light.zenith[0])
    green = light.zenith[1] + low * (light.horizon[1] - light.zenith[1])
    blue = light.zenith[2] + low * (light.horizon[2] - light.zenith[2])
    return (
        light.fog[0] + clear * (red - light.fog[0]) + glow * light.sun_colour[0],
        light.fog[1] + clear * (green - light.fog[1]) + glow * light.sun_colour[1],
        light.fog[2] + clear * (blue - light.fog[2]) + glow * light.sun_colour[2],
        clear,
        toward_sun,
    )


@inlined_kernel
def sky(light: Light, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the colour of a direction of length 1 in which nothing stands.

    Air, the sun or the moon, clouds in front of them, hills in front of all, far land below.
    """
    around = azimuth(x, y)
    cover = f4(1.0)
    if z > f4(0.0):
        cover = f4(0.0)
        if z < f4(HILL_TOP):
            cover = panorama(light.hills, _hill_row(light, z), around, 0)
    red, green, blue = f4(0.0), f4(0.0), f4(0.0)
    if cover < f4(1.0):
        red, green, blue = _open_sky(light, x, y, z, around)
    if cover > f4(0.0):
        front = _hills(light, z, around)
        red += cover * (front[0] - red)
        green += cover * (front[1] - green)
        blue += cover * (front[2] - blue)
    return red, green, blue


@inlined_kernel
def _open_sky(
    light: Light, x: float, y: float, z: float, around: float
) -> tuple[float, float, float]:
    """Return the radiance of air, sun or moon, and clouds."""
    red, green, blue, clear, toward_sun = _air(light, x, y, z)
    if light.air[7] > f4(0.0):
        row = z * f4(1.0 + CLOUD_BEND) / (z + f4(CLOUD_BEND)) * f4(len(light.clouds)) - f4(0.5)
        # Far ones are lost in the haze.
        near = min(max((z - f4(CLOUDS_FROM)) * f4(11.0), f4(0.0)), f4(1.0))
        near *= near * (f4(3.0) - f4(2.0) * near) * clear
        cover = near * panorama(light.clouds, row, around, 0)
        bright = near * panorama(light.clouds, row, around, 1)
        dim = f4(0.38) * cover + f4(0.7) * bright
        lit = f4(1.1) * bright
        red += dim * light.horizon[0] + lit * light.sun_colour[0] - cover * red
        green += dim * light.horizon[1] + lit * light.sun_colour[1] - cover * green
        blue += dim * light.horizon[2] + lit * light.sun_colour[2] - cover * blue
        clear *= (f4(1.0) - cover) * (f4(1.0) - cover)
    # A disc 0.7 degrees wide, softer than the real one, and the bright ring around it.
    disc = min(max((toward_sun - f4(0.999981)) * f4(80000.0), f4(0.0)), f4(1.0)) * f4(30.0)
    ring = toward_sun * toward_sun
    for _ in range(10):
        ring *= ring
    disc = (disc + f4(1.5) * ring) * clear
    return (
        red + disc * light.sun_colour[0],
        green + disc * light.sun_colour[1],
        blue + disc * light.sun_colour[2],
    )


@inlined_kernel
def _hill_row(light: Light, z: float) -> float:
    return z * f4(len(light.hills) / HILL_TOP) - f4(0.5)


@inlined_kernel
def _hills(light: Light, z: float, around: float) -> tuple[float, float, float]:
    """Return the colour of the hills, and below the horizon of the far plain."""
    one = f4(1.0)
    red, green, blue = light.ground[0], light.ground[1], light.ground[2]
    direct, away, white = light.sun[2], f4(1000.0 * HAZE_END), light.air[4]
    if z > f4(0.0):
        row = _hill_row(light, z)
        rise = min(z / _FOOT, one)
        direct += rise * (panorama(light.hills, row, around, 1) - direct)
        woods = rise * panorama(light.hills, row, around, 2)
        away += rise * _BEYOND * panorama(light.hills, row, around, 3)
        red += woods * (f4(0.035) - red)
        green += woods * (f4(0.06) - green)
        blue += woods * (f4(0.025) - blue)
        white *= one - f4(0.75) * woods
    red += white * (f4(0.78) - red)
    green += white * (f4(0.80) - green)
    blue += white * (f4(0.83) - blue)
    hidden = _hidden(light, away)
    sun, above, air = light.sun_colour, light.ambient_up, light.fog
    red *= direct * sun[0] + above[0]
    green *= direct * sun[1] + above[1]
    blue *= direct * sun[2] + above[2]
    return (
        red + hidden * (air[0] - red),
        green + hidden * (air[1] - green),
        blue + hidden * (air[2] - blue),
    )


@inlined_kernel
def _hidden(light: Light, distance: float) -> float:
    thickness = distance * light.air[0]
    if light.air[1] > f4(1.5):
        thickness *= thickness
    # 1 - exp(-t) as (1 + t/8 + (t/8)^2 / 2)^-8: within 0.003 of it, and several times as fast.
    eighth = f4(0.125) * thickness
    power = f4(1.0) + eighth * (f4(1.0) + f4(0.5) * eighth)
    power *= power
    power *= power
    return f4(f4(1.0) - f4(1.0) / (power * power))


@inlined_kernel
def fog_share(light: Light, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1; see `HAZE_END`."""
    return _hidden(light, min(distance, f4(1000.0 * HAZE_END)))


@inlined_kernel
def reflection(
    light: Light,
    ray: tuple[float, float, float],
    normal: tuple[float, float, float],
    facing: float,
    least: float,
    sunlit: float,
) -> tuple[float, float, float, float]:
    """Return what a smooth surface mirrors, and the share of it (Schlick's formula).

    Args:
        light: Sky and sun.
        ray: From the eye, of length 1.
        normal: Unit normal of the surface.
        facing: Minus their dot product, 0 to 1.
        least: Share that is mirrored when looking straight at it.
        sunlit: Share of the sun that reaches the surface.
    """
    x = ray[0] + f4(2.0) * facing * normal[0]
    y = ray[1] + f4(2.0) * facing * normal[1]
    z = ray[2] + f4(2.0) * facing * normal[2]
    graze = f4(1.0) - facing
    square = graze * graze
    share = least + (f4(1.0) - least) * square * square * graze
    # In a street, upright surfaces mirror low things, not the pale horizon.
    z -= f4(0.12)
    red, green, blue, _, _ = _air(light, x, y, z)
    below = min(max(f4(-6.0) * z, f4(0.0)), f4(1.0))
    below *= below * (f4(3.0) - f4(2.0) * below)
    below *= f4(0.6) * (f4(1.0) - min(light.air[0] * f4(400.0), f4(1.0)))
    red += below * (light.ambient_down[0] - red)
    green += below * (light.ambient_down[1] - green)
    blue += below * (light.ambient_down[2] - blue)
    z += f4(0.12)
    shine = max(x * light.sun[0] + y * light.sun[1] + z * light.sun[2], f4(0.0))
    for _ in range(6):
        shine *= shine
    shine *= f4(6.0) * sunlit
    return (
        red + shine * light.sun_colour[0],
        green + shine * light.sun_colour[1],
        blue + shine * light.sun_colour[2],
        share,
    )
