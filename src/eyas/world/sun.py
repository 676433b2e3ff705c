"""The sun at an hour of the day, and what it does to the light of a weather."""

import math
from dataclasses import replace

from eyas.core import exact
from eyas.core.errors import ConfigError
from eyas.state.lighting import Lighting

__all__ = ["at_hour", "sun_at"]

LATITUDE, DECLINATION = math.radians(45.0), math.radians(20.0)
"""A day in May at 45 degrees north; the sun stands in the south at 12."""
DIMMING = (0.06, 0.12, 0.26)
"""How much of red, green and blue a vertical way through the air takes; a low sun is orange."""


def sun_at(hour: float) -> tuple[float, float, float]:
    """Return the unit vector towards the sun: east, north, up.

    The usual formulas of hour angle, declination and latitude, by true solar time.
    """
    turn = math.radians(15.0 * (hour - 12.0))
    south = exact.cos(DECLINATION) * exact.cos(turn)
    up = exact.sin(DECLINATION)
    return (
        -exact.cos(DECLINATION) * exact.sin(turn),
        exact.cos(LATITUDE) * up - exact.sin(LATITUDE) * south,
        exact.sin(LATITUDE) * up + exact.cos(LATITUDE) * south,
    )


def at_hour(lighting: Lighting, hour: float) -> Lighting:
    """Return light and air of a weather at an hour.

    Args:
        lighting: The weather's own.
        hour: The hour, such that the sun is up.

    Raises:
        ConfigError: It is the light of a night.
    """
    if lighting.night:
        raise ConfigError("world.hour: not allowed at night; allowed: weathers with a sun")
    direction = sun_at(hour)
    longer = _way(direction[2]) - _way(lighting.sun_direction[2])
    sun = _dimmed(lighting.sun_colour, longer)
    sky = min(math.sqrt(direction[2] / lighting.sun_direction[2]), 1.1)
    return replace(
        lighting,
        sun_direction=direction,
        sun_colour=sun,
        zenith_colour=_scaled(lighting.zenith_colour, sky),
        horizon_colour=_scaled(_dimmed(lighting.horizon_colour, 0.3 * longer), 0.5 + 0.5 * sky),
        fog_colour=_scaled(_dimmed(lighting.fog_colour, 0.3 * longer), 0.5 + 0.5 * sky),
        ambient_up=_scaled(lighting.ambient_up, sky),
        ambient_down=_scaled(lighting.ambient_down, sky),
        exposure=lighting.exposure / math.sqrt(sky),
    )


def _way(height: float) -> float:
    """Return the way of light through the air, given the sine of the sun's height; zenith: 1.

    Rozenberg, Twilight (1966): finite at the horizon, where 1 / sine is not.
    """
    return float(1.0 / (height + 0.025 * exact.exp(-11.0 * height)))


def _dimmed(colour: tuple[float, float, float], way: float) -> tuple[float, float, float]:
    red, green, blue = (
        part * exact.exp(-taken * way) for part, taken in zip(colour, DIMMING, strict=True)
    )
    return red, green, blue


def _scaled(colour: tuple[float, float, float], factor: float) -> tuple[float, float, float]:
    red, green, blue = colour
    return factor * red, factor * green, factor * blue
