"""The weathers, and their light and air as shared by maps."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

from eyas.state.lighting import Lighting

__all__ = [
    "CLEAR_DAY",
    "CLEAR_NIGHT",
    "DAY",
    "FOG",
    "FOGGY",
    "NIGHT",
    "SNOW",
    "WEATHERS",
    "WINTER_DAY",
    "Season",
    "Weather",
]


class Season(StrEnum):
    """The state of plants, roofs and fields."""

    SUMMER = "summer"
    WINTER = "winter"


@dataclass(frozen=True, slots=True)
class Weather:
    """A weather that maps can have; a user's map may define its own."""

    name: str
    """Value of `world.weather`."""
    season: Season
    """Season in which it occurs."""


DAY = Weather("day", Season.SUMMER)
FOGGY = Weather("foggy", Season.SUMMER)
NIGHT = Weather("night", Season.SUMMER)
SNOW = Weather("snow", Season.WINTER)

WEATHERS = (DAY, FOGGY, NIGHT, SNOW)
"""The weathers of the original."""

# Light and air. A map uses these, or variants made from them with `dataclasses.replace`.

_STEEP = 1.0 / math.sqrt(0.55 * 0.55 + 0.6 * 0.6 + 1.0)

CLEAR_DAY = Lighting(
    # The original's sun: in the north-west, 50.9 degrees high.
    sun_direction=(-0.55 * _STEEP, 0.6 * _STEEP, _STEEP),
    sun_colour=(1.02, 0.96, 0.84),
    zenith_colour=(0.042, 0.130, 0.42),
    horizon_colour=(0.45, 0.64, 0.94),
    ambient_up=(0.31, 0.35, 0.43),
    ambient_down=(0.16, 0.155, 0.13),
    fog_colour=(0.47, 0.61, 0.82),
    # Clear air that tints the far edge of the map slightly blue.
    fog_density=1.0 / 7000.0,
    clouds=0.35,
)

# The original's plain grey sky (0.75, 0.75, 0.74) as radiance, and its weak bluish sun behind it.
_OVERCAST = (0.545, 0.545, 0.53)

FOG = replace(
    CLEAR_DAY,
    sun_colour=(0.035, 0.035, 0.04),
    zenith_colour=_OVERCAST,
    horizon_colour=(0.86, 0.86, 0.85),
    ambient_up=(0.54, 0.54, 0.55),
    ambient_down=(0.22, 0.215, 0.20),
    fog_colour=(0.60, 0.60, 0.59),
    # The original's visibility range: pale even near by, and the far edge of the map disappears.
    fog_density=1.0 / 1000.0,
    foggy=True,
    clouds=1.0,
)

# The original's plain blue sky (0.60, 0.757, 0.945), paler towards the horizon, and the day's sun.
WINTER_DAY = replace(
    CLEAR_DAY,
    zenith_colour=(0.24, 0.42, 0.80),
    horizon_colour=(0.50, 0.62, 0.80),
    # Snow reflects light upwards.
    ambient_up=(0.31, 0.36, 0.45),
    ambient_down=(0.27, 0.29, 0.32),
    fog_colour=(0.55, 0.64, 0.76),
    fog_density=1.0 / 6000.0,
    clouds=0.45,
    exposure=1.1,
    snow=1.0,
    flakes=0.5,
)

# All at slightly more than a third of the day's brightness, as in the original: a high moon, a sky
# that is not quite black, the glow of the town at the horizon; lamps and windows add the rest.
CLEAR_NIGHT = replace(
    CLEAR_DAY,
    sun_direction=(0.48, -0.42, 0.77),
    sun_colour=(0.086, 0.092, 0.108),
    zenith_colour=(0.0035, 0.005, 0.012),
    horizon_colour=(0.024, 0.024, 0.032),
    ambient_up=(0.062, 0.066, 0.082),
    ambient_down=(0.030, 0.029, 0.028),
    fog_colour=(0.024, 0.024, 0.032),
    fog_density=1.0 / 3000.0,
    clouds=0.15,
    luminosity=0.3,
    lamps=1.0,
    windows=0.3,
)
