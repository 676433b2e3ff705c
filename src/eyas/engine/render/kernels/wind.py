"""Wind: gusts that travel with it, how plants lean, and how their leaves turn.

All of it is a function of place and time, so that an instant always looks the same.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Illumination, Light, Wind
from eyas.engine.render.kernels.colours import Vector
from eyas.engine.render.kernels.scalars import f4
from eyas.engine.render.kernels.surface.texture import fraction
from eyas.lanes import kernel
from eyas.lanes.vector import greater, lesser, like, magnitude, root

FARTHEST_LEAN = 0.08  # More than a plant ever leans, as the sine of the angle

_MOST = 0.06
_PER_SPEED = 0.0008
"""Lean by a speed of 1 m/s; it grows with the power 1.5, not 2, since crowns yield (Vogel, Drag and
reconfiguration of broad leaves in high winds, Journal of Experimental Botany 40, 1989)."""


@kernel(inline=True)
def wave(turn: float) -> float:
    """Return approximately the sine of an angle given in turns, made of parabolas."""
    part = turn - math.floor(turn) - 0.5
    return float(16.0 * part * (abs(part) - 0.5))


@kernel(inline=True)
def in_wind(lit: Illumination, x: float, y: float, instant: float) -> Illumination:
    """Return light and air of a view in a wind [m/s] at an instant [s]."""
    speed = f4(math.sqrt(x * x + y * y))
    return Illumination(
        lit.sun, lit.sun_colour, lit.zenith, lit.horizon, lit.above, lit.below, lit.tinge,
        lit.fog, lit.fog_density, lit.air, Wind(f4(x), f4(y), speed, f4(instant)),
    )  # fmt: skip


@kernel(inline=True)
def _gust(wind: Wind, x: float, y: float) -> float:
    """Return how much stronger than on average the wind is at a place, -1 to 1.

    Gusts travel with the mean wind (Taylor, The spectrum of turbulence, Proceedings of the Royal
    Society A 164, 1938).
    """
    part = 1.0 / max(wind.speed, 0.1)
    east, north = wind.x * part, wind.y * part
    along, aside = x * east + y * north - wind.speed * wind.instant, y * east - x * north
    return 0.6 * wave(along / 73.0 + aside / 190.0) + 0.4 * wave(along / 27.0 - aside / 61.0)


@kernel(inline=True)
def _lean(wind: Wind, x: float, y: float, rate: float, gain: float) -> tuple[float, float]:
    """Return how far a plant at a place leans east and north: sines of angles.

    It leans with the wind and its gusts, and sways to and fro with its own frequency, most along
    the wind (de Langre, Effects of wind on plants, Annual Review of Fluid Mechanics 40, 2008).
    """
    speed = float(wind.speed)
    strength = gain * min(_PER_SPEED * speed * math.sqrt(speed), _MOST)
    phase, turn = 0.618 * x + 0.414 * y, rate * wind.instant
    along = strength * (0.55 + 0.45 * _gust(wind, x, y) + 0.22 * wave(turn + phase))
    aside = 0.2 * strength * wave(0.91 * turn + 1.7 * phase)
    part = 1.0 / max(speed, 0.1)
    east, north = wind.x * part, wind.y * part
    return along * east - aside * north, along * north + aside * east


@kernel(inline=True)
def sways(light: Light, fixture: int) -> bool:
    """Return whether a fixture moves in the wind."""
    return len(light.sway) > 0 and light.sway[fixture, 1] > f4(0.0)


@kernel
def leaned(
    light: Light,  # How fast and how far fixtures sway
    wind: Wind,
    fixture: int,  # Which of them it is
    pose: NDArray[np.float32],  # Its pose when it stands upright, shape (3, 4)
    output: NDArray[np.float32],  # Written, shape (3, 4)
) -> None:
    """Write the pose of a plant that leans about its foot, a rotation and a scale as before."""
    rate, gain = float(light.sway[fixture, 0]), float(light.sway[fixture, 1])
    a, b = _lean(wind, float(pose[0, 3]), float(pose[1, 3]), rate, gain)
    c = math.sqrt(1.0 - a * a - b * b)
    # The rotation that turns the vertical into (a, b, c) the short way.
    share = 1.0 / (1.0 + c)
    for column in range(3):
        x, y, z = float(pose[0, column]), float(pose[1, column]), float(pose[2, column])
        output[0, column] = f4(x - share * a * (a * x + b * y) + a * z)
        output[1, column] = f4(y - share * b * (a * x + b * y) + b * z)
        output[2, column] = f4(c * z - a * x - b * y)
    for row in range(3):
        output[row, 3] = pose[row, 3]


@kernel(inline=True)
def _ripple(turn: float) -> float:
    """Return `wave` of lanes, of float32."""
    part = fraction(turn) - f4(0.5)
    return f4(16.0) * part * (magnitude(part) - f4(0.5))


@kernel(inline=True)
def shimmer(
    wind: Wind,
    point: Vector,  # Where [m]
    normal: Vector,  # Unit normal in calm air
    size: float,  # Width of a pixel there [m]; if it shows many leaves, they look still
) -> Vector:
    """Return the normal of leaves that flutter."""
    one, time = f4(1.0), wind.instant
    sharp = lesser(greater(f4(1.5) - size, f4(0.0)), one)
    strength = f4(0.035) * lesser(like(size, wind.speed), f4(10.0)) * sharp
    x, y, z = point
    a = strength * _ripple(f4(0.43) * x + f4(0.29) * y + f4(0.37) * z - f4(1.9) * time)
    b = strength * _ripple(f4(0.31) * y - f4(0.47) * x + f4(0.53) * z - f4(2.3) * time)
    x, y, z = normal[0] + a, normal[1] + b, normal[2]
    scale = one / root(x * x + y * y + z * z + f4(1e-12))
    return x * scale, y * scale, z * scale
