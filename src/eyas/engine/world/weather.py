"""The weathers: one record each, in one table, and the light that each gives at an hour."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.registry import Registry
from eyas.engine.state.lighting import Lighting
from eyas.engine.world.hours import at_hour, under_moon


class Season(StrEnum):
    """The state of plants, roofs and fields."""

    SUMMER = "summer"
    WINTER = "winter"
    AUTUMN = "autumn"
    """Autumn: summer, but the leaves of trees have turned, and some have fallen."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weather:
    """A weather, as it is where no map changes it."""

    name: str
    """Words joined by hyphens: value of `world.weather`, part of the names of environments."""
    season: Season = Season.SUMMER
    """Season in which it occurs."""
    day: Lighting
    """Light and air while the sun is up: what falls and lies, too."""
    night: Lighting
    """Light and air while the sun is deep below the horizon; its `sun_direction` is the moon's."""
    dark: bool = False
    """Whether it is night unless an hour is given."""
    hour: float | None = None
    """Hour at which it is shown unless another is given; None: `day` or `night` as they are."""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\w+(-\w+)*", self.name):
            raise ConfigError(
                f"Weather.name: {self.name!r} is not allowed; allowed: words joined by hyphens"
            )

    def each(self, change: Callable[[Lighting], Lighting]) -> "Weather":
        """Return the weather with its light by day and by night changed alike."""
        return replace(self, day=change(self.day), night=change(self.night))

    def light(self, hour: float | None = None, moon: float | None = None) -> Lighting:
        """Return light and air at an hour.

        Args:
            hour: 0 to 24; None: the weather's own, day or night.
            moon: Age of the moon as a share of a month, 0 new, 0.5 full; None: it is always full
                and stands where the weather has it, under stars that stand still.
        """
        hour = self.hour if hour is None else hour
        if hour is None and (moon is None or not self.dark):
            return self.night if self.dark else self.day
        if moon is None:
            return at_hour(self.day, self.night, hour or 0.0)
        hour = hour or 0.0
        return at_hour(self.day, under_moon(self.night, hour, moon), hour)


# Light and air. A map uses these, or variants made from them with `dataclasses.replace`.

_STEEP = 1.0 / math.sqrt(0.55 * 0.55 + 0.6 * 0.6 + 1.0)  # Scales the sun's direction to 1

CLEAR_DAY = Lighting(
    # The original's sun: in the north-west, 50.9 degrees high.
    sun_direction=(-0.55 * _STEEP, 0.6 * _STEEP, _STEEP),
    # On level ground 4.1 times the sky's light, as from 50 degrees through clear air (Bird and
    # Hulstrom, A simplified clear sky model, SERI/TR-642-761, 1981).
    sun_colour=(1.56, 1.49, 1.32),
    zenith_colour=(0.042, 0.130, 0.42),
    horizon_colour=(0.45, 0.64, 0.94),
    ambient_up=(0.255, 0.282, 0.328),
    ambient_down=(0.15, 0.142, 0.118),
    fog_colour=(0.47, 0.61, 0.82),
    # Clear air that tints the far edge of the map slightly blue.
    fog_density=1.0 / 7000.0,
    clouds=0.35,
    # White paper in this sun has radiance 1.3.
    luminance=23_000.0,
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
    # 1e4 lux under the cloud, a tenth of the sun's.
    luminance=8_000.0,
)

# The original's plain blue sky (0.60, 0.757, 0.945), paler towards the horizon, and the day's sun.
WINTER_DAY = replace(
    CLEAR_DAY,
    zenith_colour=(0.24, 0.42, 0.80),
    horizon_colour=(0.50, 0.62, 0.80),
    # Snow reflects light upwards.
    ambient_up=(0.30, 0.345, 0.43),
    ambient_down=(0.35, 0.37, 0.40),
    fog_colour=(0.55, 0.64, 0.76),
    fog_density=1.0 / 6000.0,
    clouds=0.45,
    exposure=0.78,
    snow=1.0,
    flakes=0.5,
)

# Exposed for streets under their lamps: the moon gives a fiftieth of that light, the glow of the
# town above it some more, so that what no lamp lights is nearly black.
CLEAR_NIGHT = replace(
    CLEAR_DAY,
    sun_direction=(0.48, -0.42, 0.77),
    sun_colour=(0.016, 0.0175, 0.021),
    zenith_colour=(0.0017, 0.0021, 0.0038),
    horizon_colour=(0.026, 0.0215, 0.0175),
    ambient_up=(0.021, 0.021, 0.023),
    ambient_down=(0.012, 0.0105, 0.0085),
    fog_colour=(0.017, 0.0145, 0.0125),
    fog_density=1.0 / 3000.0,
    clouds=0.0,
    exposure=2.1,
    luminosity=0.3,
    # A lit street is then at 1 to 2 cd/m^2, as EN 13201 asks of roads of classes M3 to M1.
    luminance=25.0,
    lamps=1.0,
    windows=0.3,
)

# The original has neither of these two: its fog and its snow come by day. Fog and clouds throw the
# town's light back, and so does the ground that is white.
_FOG_NIGHT = replace(
    CLEAR_NIGHT,
    sun_colour=(0.002, 0.002, 0.0022),
    zenith_colour=(0.026, 0.023, 0.020),
    horizon_colour=(0.046, 0.039, 0.032),
    ambient_up=(0.034, 0.031, 0.028),
    ambient_down=(0.016, 0.014, 0.012),
    fog_colour=(0.040, 0.035, 0.030),
    fog_density=FOG.fog_density,
    foggy=True,
    clouds=1.0,
)
_WINTER_NIGHT = replace(
    CLEAR_NIGHT,
    ambient_down=(0.019, 0.018, 0.018),
    exposure=1.4,
    snow=1.0,
    flakes=WINTER_DAY.flakes,
)

# Weathers that the original does not have.

# Grey light without shadows from a closed sky that is brighter above (CIE's overcast sky).
_OVERCAST_DAY = replace(
    CLEAR_DAY,
    sun_colour=(0.0, 0.0, 0.0),
    zenith_colour=(0.37, 0.385, 0.41),
    horizon_colour=(0.335, 0.35, 0.375),
    ambient_up=(0.35, 0.362, 0.382),
    ambient_down=(0.12, 0.118, 0.11),
    fog_colour=(0.37, 0.385, 0.41),
    fog_density=1.0 / 5000.0,
    clouds=1.0,
    exposure=1.9,
    luminance=12_500.0,
)
_OVERCAST_NIGHT = replace(_FOG_NIGHT, fog_density=CLEAR_NIGHT.fog_density, foggy=False)

_RAIN_DAY = replace(
    _OVERCAST_DAY,
    zenith_colour=(0.30, 0.315, 0.34),
    horizon_colour=(0.34, 0.355, 0.38),
    ambient_up=(0.30, 0.315, 0.34),
    ambient_down=(0.085, 0.086, 0.085),
    fog_colour=(0.30, 0.315, 0.335),
    fog_density=1.0 / 1300.0,
    exposure=1.6,
    luminance=7_000.0,
    # Drivers have their lamps on, and some rooms need light.
    daytime_lamps=0.6,
    windows=0.05,
    rain=0.6,
    wet=1.0,
)
_RAIN_NIGHT = replace(
    _FOG_NIGHT, fog_density=_RAIN_DAY.fog_density, foggy=False, rain=_RAIN_DAY.rain, wet=1.0
)

# Dust that a storm has raised: thicker near the ground, and the sun is a pale disc.
_DUST_DAY = replace(
    CLEAR_DAY,
    sun_colour=(0.46, 0.36, 0.21),
    zenith_colour=(0.50, 0.39, 0.23),
    horizon_colour=(0.64, 0.48, 0.27),
    ambient_up=(0.42, 0.34, 0.23),
    ambient_down=(0.21, 0.165, 0.105),
    fog_colour=(0.60, 0.45, 0.255),
    fog_density=1.0 / 380.0,
    foggy=True,
    clouds=0.0,
    mist=1.0 / 260.0,
    mist_depth=14.0,
    glare=0.35,
    luminance=15_000.0,
)
_DUST_NIGHT = replace(
    _FOG_NIGHT,
    zenith_colour=(0.022, 0.018, 0.013),
    horizon_colour=(0.040, 0.031, 0.020),
    fog_colour=(0.038, 0.029, 0.019),
    fog_density=_DUST_DAY.fog_density,
    clouds=0.0,
    mist=_DUST_DAY.mist,
    mist_depth=_DUST_DAY.mist_depth,
)

# The half hour before sunset: long shadows, a dazzling sun, the first lamps and windows lit.
_EVENING = replace(
    CLEAR_DAY,
    horizon_colour=(0.68, 0.62, 0.66),
    fog_colour=(0.57, 0.55, 0.60),
    fog_density=1.0 / 4500.0,
    clouds=0.4,
    glare=1.0,
    longest_shadow=16.0,
    lamps=0.45,
    windows=0.22,
    stars=0.0,
)

# A low October sun, mist over fields and ponds, leaves on the ground and in the air.
_AUTUMN_DAY = replace(
    CLEAR_DAY,
    sun_direction=(-0.78, 0.40, 0.48),
    sun_colour=(1.45, 1.28, 1.0),
    horizon_colour=(0.52, 0.64, 0.82),
    ambient_up=(0.22, 0.25, 0.31),
    fog_colour=(0.60, 0.65, 0.72),
    fog_density=1.0 / 3500.0,
    clouds=0.5,
    exposure=1.1,
    luminance=21_000.0,
    mist=1.0 / 70.0,
    mist_depth=7.0,
    glare=0.3,
    longest_shadow=6.0,
    litter=1.0,
    leaves=0.35,
)
_AUTUMN_NIGHT = replace(
    CLEAR_NIGHT,
    mist=_AUTUMN_DAY.mist,
    mist_depth=_AUTUMN_DAY.mist_depth,
    litter=_AUTUMN_DAY.litter,
    leaves=_AUTUMN_DAY.leaves,
)

DAY = Weather(name="day", day=CLEAR_DAY, night=CLEAR_NIGHT)
FOGGY = Weather(name="foggy", day=FOG, night=_FOG_NIGHT)
NIGHT = replace(DAY, name="night", dark=True)
SNOW = Weather(name="snow", season=Season.WINTER, day=WINTER_DAY, night=_WINTER_NIGHT)
RAIN = Weather(name="rain", day=_RAIN_DAY, night=_RAIN_NIGHT)
DUSK = Weather(name="dusk", day=_EVENING, night=CLEAR_NIGHT, hour=18.9)
OVERCAST = Weather(name="overcast", day=_OVERCAST_DAY, night=_OVERCAST_NIGHT)
DUST = Weather(name="dust", day=_DUST_DAY, night=_DUST_NIGHT)
AUTUMN = Weather(name="autumn", season=Season.AUTUMN, day=_AUTUMN_DAY, night=_AUTUMN_NIGHT)

WEATHERS: Registry[Weather] = Registry(
    "world.weather",
    Weather,
    {each.name: each for each in (DAY, FOGGY, NIGHT, SNOW, RAIN, DUSK, OVERCAST, DUST, AUTUMN)},
    group="eyas.weathers",
)
"""The four weathers of the original, Eyas' own, and those of a user."""


def unchanged(weather: Weather) -> Weather:
    """Return the weather: how it is on maps where nothing about it is special."""
    return weather


def metered(weather: Weather, exposure: float) -> Weather:
    """Return a weather whose days a camera exposes by a factor more: land that is darker than
    most, or less: land that is paler.
    """
    return replace(weather, day=replace(weather.day, exposure=exposure * weather.day.exposure))


def in_fog(light: Lighting, visibility: float) -> Lighting:
    """Return light and air with another visibility range [m], if there is fog."""
    return replace(light, fog_density=1.0 / visibility) if light.foggy else light
