"""How warm surfaces are: what a thermal camera sees.

A surface is as warm as the air, plus what the sun of the last hours has left in it, minus what it
radiates to a clear sky. The first decays over the hours that the material stores heat, so that a
road is warmest after noon and still warmer than the lawn at midnight, and a wall that has had the
morning's sun cools in the afternoon. Numbers are those of midsummer; a low sun gives less.

Asphalt some 25 K above the air in the sun, and warmer than soil all night: Asaeda, Ca and Wake,
"Heat storage of pavement and its effect on the lower atmosphere", Atmospheric Environment 30
(1996).
Leaves stay within a few kelvins of the air: Gates, "Transpiration and leaf temperature", Annual
Review of Plant Physiology 19 (1968).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.hours import sun_at
from eyas.lanes import exact, kernel

DIRECTIONS = 31
"""Rows and columns of a map of directions, see `direction_of`; odd, so that up has a cell."""


class Warmth(NamedTuple):
    """How a surface warms up and cools down."""

    sun: float  # Above the air after long, steady and vertical sunshine [K]
    hours: float  # Time in which two thirds of that are reached, or lost
    sky: float  # Below the air, facing a clear night sky [K]


_WARMTH = {
    ObjectClass.GROUND: Warmth(12.0, 1.5, 4.0),
    ObjectClass.ROAD: Warmth(30.0, 3.0, 2.0),
    ObjectClass.MARKING: Warmth(22.0, 3.0, 2.0),
    ObjectClass.PAVEMENT: Warmth(22.0, 2.5, 2.5),
    ObjectClass.BUILDING: Warmth(20.0, 2.5, 3.0),
    ObjectClass.TREE: Warmth(4.0, 0.3, 1.0),
    ObjectClass.STRUCTURE: Warmth(18.0, 1.0, 4.0),
    ObjectClass.POLE: Warmth(12.0, 0.5, 4.0),
    ObjectClass.WATER: Warmth(2.0, 12.0, 0.0),
    ObjectClass.CAR: Warmth(22.0, 0.4, 6.0),
    ObjectClass.SKY: Warmth(0.0, 1.0, 0.0),
    ObjectClass.TRUCK: Warmth(18.0, 0.4, 5.0),
    ObjectClass.BUS: Warmth(18.0, 0.4, 5.0),
    ObjectClass.MOTORCYCLE: Warmth(12.0, 0.3, 3.0),
    ObjectClass.PERSON: Warmth(6.0, 0.1, 1.0),
    ObjectClass.ROBOT: Warmth(14.0, 0.3, 4.0),
    ObjectClass.BICYCLE: Warmth(6.0, 0.1, 1.0),
    ObjectClass.BOAT: Warmth(16.0, 0.5, 3.0),
    ObjectClass.TRAIN: Warmth(18.0, 0.6, 5.0),
}

_WARM, _COLD = 22.0, -3.0  # Mean temperature of the air in summer, and while snow lies [Celsius]
_SWING, _WARMEST = 5.0, 15.0
"""Half of the difference between day and night [K], and the hour at which it is warmest."""
_DAY_HOUR, _NIGHT_HOUR = 14.0, 23.0  # Hours that stand for weathers without one
_CLEAR_SUN = 1.49  # Luminance of the light of a clear day's sun, in the units of `Lighting`
_STEP, _BACK = 0.5, 12.0  # Steps back in time, and how far [h]


class MoverHeat(NamedTuple):
    """What warms a moving thing from inside [K above the air]."""

    engine: float  # At its hottest spot, on the body's skin
    wheels: float  # Tyres that roll


ENGINE_HEAT = {
    ObjectClass.CAR: MoverHeat(18.0, 9.0),
    ObjectClass.TRUCK: MoverHeat(24.0, 14.0),
    ObjectClass.BUS: MoverHeat(24.0, 14.0),
    ObjectClass.MOTORCYCLE: MoverHeat(30.0, 10.0),
    ObjectClass.ROBOT: MoverHeat(10.0, 4.0),
}
"""Of vehicles that have been driven for a while. Bonnets of 15 to 25 K and tyres of some 10 K above
the air are what thermograms of traffic show."""

SKIN, CLOTHES = 33.0, 28.0
"""Temperature of skin, and of clothes in air of 22 degrees [Celsius]: Fanger, "Thermal comfort"
(1970), of people who sit or walk slowly."""


def air_temperature(lighting: Lighting, hour: float) -> float:
    """Return the temperature of the air at an hour [Celsius]."""
    mean = _WARM + (_COLD - _WARM) * min(max(lighting.snow, 0.0), 1.0)
    turn = math.radians(15.0 * (hour - _WARMEST))
    return float(mean + _SWING * exact.cos(turn))


class SurfaceTemperatures:
    """Temperatures in a weather.

    Attributes:
        air: Of the air [Celsius].
        sky: Of the zenith, as a thermal camera sees it [Celsius].
        table: Of a surface of each class that faces each direction, see `direction_of` [Celsius],
            shape (classes, DIRECTIONS, DIRECTIONS).

    Args:
        lighting: Light and air.
        hour: Hour of the day; None: the weather's own.
    """

    def __init__(self, lighting: Lighting, hour: float | None) -> None:
        dark = lighting.lamps > 0.0
        at = hour if hour is not None else _NIGHT_HOUR if dark else _DAY_HOUR
        self.air = air_temperature(lighting, at)
        clear = 1.0 - min(max(lighting.clouds, 0.0), 1.0)
        # A clear sky is some 40 K colder than the air at the zenith, a closed one nearly as warm.
        self.sky = self.air - 5.0 - 40.0 * clear
        suns = _past_suns(at, None if hour is not None or dark else lighting.sun_direction)
        shine = _shine(lighting, dark=dark)
        normals = _normals()
        self.table = np.empty((len(ObjectClass), DIRECTIONS, DIRECTIONS), np.float32)
        for kind in ObjectClass:
            warmth = _WARMTH[kind]
            gained = shine * warmth.sun * _stored(normals, suns, warmth.hours)
            lost = warmth.sky * clear * np.maximum(normals[..., 2], 0.0)
            self.table[kind] = self.air + gained - lost * (1.0 - min(max(suns[0][0][2], 0.0), 1.0))
        if lighting.snow > 0.0:  # what lies on surfaces that face up is not above its melting point
            lying = normals[..., 2] > 0.6
            for kind in (ObjectClass.GROUND, ObjectClass.PAVEMENT, ObjectClass.BUILDING):
                self.table[kind][lying] = np.minimum(self.table[kind][lying], 0.0)


@kernel(inline=True)
def direction_of(x: float, y: float, z: float) -> tuple[int, int]:
    """Return row and column of a direction in a map: the octahedron, unfolded to a square.

    Meyer et al., "On floating-point normal vectors", Computer Graphics Forum 29 (2010).
    """
    size = abs(x) + abs(y) + abs(z) + 1e-9
    u, v = x / size, y / size
    if z < 0.0:
        folded = (1.0 - abs(v)) * (1.0 if u >= 0.0 else -1.0)
        v = (1.0 - abs(u)) * (1.0 if v >= 0.0 else -1.0)
        u = folded
    row = min(max(int((v + 1.0) * 0.5 * DIRECTIONS), 0), DIRECTIONS - 1)
    return row, min(max(int((u + 1.0) * 0.5 * DIRECTIONS), 0), DIRECTIONS - 1)


def _normals() -> NDArray[np.float64]:
    """Return the direction of each cell of a map, shape (DIRECTIONS, DIRECTIONS, 3)."""
    middle = (np.arange(DIRECTIONS) + 0.5) * (2.0 / DIRECTIONS) - 1.0
    u, v = np.broadcast_arrays(middle[None, :], middle[:, None])
    z = 1.0 - np.abs(u) - np.abs(v)
    below = z < 0.0
    x = np.where(below, (1.0 - np.abs(v)) * np.where(u >= 0.0, 1.0, -1.0), u)
    y = np.where(below, (1.0 - np.abs(u)) * np.where(v >= 0.0, 1.0, -1.0), v)
    normal = np.stack([x, y, z], axis=-1)
    return np.asarray(normal / np.sqrt((normal * normal).sum(axis=-1, keepdims=True)))


def _past_suns(
    hour: float,  # Now
    # The sun of a weather that has no hour, as if it had stood still; None: it moved
    fixed: tuple[float, float, float] | None,
) -> list[tuple[tuple[float, float, float], float]]:
    """Return where the sun was, and how long ago [h], from now back."""
    ago = np.arange(0.0, _BACK, _STEP).tolist()
    return [(sun_at(hour - one) if fixed is None else fixed, one) for one in ago]


def _shine(lighting: Lighting, *, dark: bool) -> float:
    """Return how much of a clear day's sun has come through, 0 to 1."""
    if dark:  # the light is the moon's: by day, only clouds would have been in the way
        return 1.0 - 0.8 * lighting.clouds
    red, green, blue = lighting.sun_colour
    return min((0.2126 * red + 0.7152 * green + 0.0722 * blue) / _CLEAR_SUN, 1.0)


def _stored(
    normals: NDArray[np.float64], suns: list[tuple[tuple[float, float, float], float]], hours: float
) -> NDArray[np.float64]:
    """Return the share of vertical sunshine that surfaces still hold, 0 to 1."""
    held, whole = np.zeros(normals.shape[:-1]), 0.0
    for sun, ago in suns:
        weight = float(exact.exp(-ago / hours))
        facing = np.maximum(exact.product(normals, np.array(sun)[:, None])[..., 0], 0.0)
        held += weight * facing * (sun[2] > 0.0)
        whole += weight
    return held / whole
