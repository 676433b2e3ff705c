"""The air between the camera and things."""

from eyas.engine.render.kernels.bundles import Illumination, Light
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.hash_noise import noise
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser

HAZE_END = 4.0
"""Distance beyond which land gets no hazier, and at which the hills begin [km]. So the foot of
the hills matches the end of the land, however high the viewer is."""

_FARTHEST = f4(1000.0 * HAZE_END)


@kernel(inline=True)
def vanishing(x: float) -> float:
    """Return exp(-x), for x from 0 up, as (1 + x/8 + (x/8)^2 / 2)^-8: within 0.003 of it, and
    several times as fast.
    """
    eighth = f4(0.125) * x
    power = f4(1.0) + eighth * (f4(1.0) + f4(0.5) * eighth)
    power *= power
    power *= power
    return f4(1.0) / (power * power)


@kernel(inline=True)
def hidden_at(lit: Illumination, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1."""
    thickness = distance * lit.fog_density
    if lit.air.power > f4(1.5):
        thickness *= thickness
    return f4(1.0) - vanishing(thickness)


@kernel(inline=True)
def fog_share(lit: Illumination, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1; see `HAZE_END`."""
    return hidden_at(lit, lesser(distance, _FARTHEST))


@kernel(inline=True)
def bank_light(lit: Illumination, rise: float) -> float:
    """Return how bright fog is in a direction, over the same at the horizon, given its upward part.

    Droplets scatter forward: seen from above, against dark ground, fog is darker than against the
    sky.
    """
    return f4(1.0) + lit.air.banks * f4(0.6) * lesser(rise, f4(0.0))


@kernel(inline=True)
def land_fog(
    light: Light,  # Says where the ground is
    lit: Illumination,  # Light and air
    eye: Colour,  # Optical centre [m]
    point: Colour,  # The point [m]
    away: float,  # Distance between them [m]
) -> float:
    """Return how much of what lies at a point the air hides, 0 to 1; fog lies in banks.

    It is thicker low down and in banks of some eighty metres with gaps between them, and on average
    about as thick as without: the mean of the noise is a half, and that of the heights is about
    7 m. Seen over a long way, banks and gaps even out.
    """
    away = lesser(away, _FARTHEST)
    if lit.air.banks == f4(0.0):
        return hidden_at(lit, away)
    one, share = f4(1.0), f4(0.6)
    x = eye[0] + share * (point[0] - eye[0])
    y = eye[1] + share * (point[1] - eye[1])
    cell, turn = f4(0.0115), f4(0.0045)
    bank = noise(cell * x + turn * y, cell * y - turn * x)
    uneven = f4(2.2) * (bank - f4(0.47)) / (one + f4(0.0015) * away)
    high = f4(0.5) * (eye[2] + point[2]) - light.ambient_frame.ground
    low = greater(lesser(f4(1.14) - f4(0.02) * high, f4(1.14)), f4(0.8))
    return hidden_at(lit, away * low * greater(one + uneven, f4(0.1)))
