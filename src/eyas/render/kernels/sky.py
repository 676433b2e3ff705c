"""The sky in a direction, and the air between the camera and things."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4

__all__ = ["fog_share", "reflection", "sky"]


@inlined_kernel
def sky(light: Light, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the radiance of the sky in a direction of length 1.

    Paler towards the horizon, brighter round the sun, and below the horizon soft to the colour
    of far ground.
    """
    one = f4(1.0)
    climb = one - min(max(z, f4(0.0)), one)
    low = climb * climb
    low *= low
    toward_sun = max(x * light.sun[0] + y * light.sun[1] + z * light.sun[2], f4(0.0))
    glow = toward_sun * toward_sun
    glow *= glow
    wide = f4(0.07) * glow * glow
    for _ in range(6):
        glow *= glow
    glow = wide + f4(0.35) * glow
    below = min(max(f4(-6.0) * z, f4(0.0)), one)
    below = below * below * (f4(3.0) - f4(2.0) * below)
    # Thick air hides the sky too, most near the horizon.
    veil = min(light.air[0] * f4(400.0), one) * (one - min(max(z, f4(0.0)) * f4(1.5), one))
    glow *= one - veil
    red = light.zenith[0] + low * (light.horizon[0] - light.zenith[0])
    green = light.zenith[1] + low * (light.horizon[1] - light.zenith[1])
    blue = light.zenith[2] + low * (light.horizon[2] - light.zenith[2])
    red += veil * (light.fog[0] - red) + glow * light.sun_colour[0]
    green += veil * (light.fog[1] - green) + glow * light.sun_colour[1]
    blue += veil * (light.fog[2] - blue) + glow * light.sun_colour[2]
    ground = f4(0.6) * below * (one - veil)
    return (
        red + ground * (light.ambient_down[0] - red),
        green + ground * (light.ambient_down[1] - green),
        blue + ground * (light.ambient_down[2] - blue),
    )


@inlined_kernel
def fog_share(light: Light, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1."""
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
        normal: Of the surface, of length 1.
        facing: Minus their dot product, 0 to 1.
        least: Share that is mirrored when looking straight at it.
        sunlit: How much of the sun reaches the surface.
    """
    x = ray[0] + f4(2.0) * facing * normal[0]
    y = ray[1] + f4(2.0) * facing * normal[1]
    z = ray[2] + f4(2.0) * facing * normal[2]
    graze = f4(1.0) - facing
    square = graze * graze
    share = least + (f4(1.0) - least) * square * square * graze
    # Low things, not the pale horizon, are what upright surfaces mirror in a street.
    red, green, blue = sky(light, x, y, z - f4(0.12))
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
