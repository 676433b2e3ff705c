"""The light of a weather at an hour: sun, twilight, moon and stars."""

import math
from dataclasses import replace
from typing import Any

from eyas.engine.state.lighting import Lighting
from eyas.lanes import exact

Colour = tuple[float, float, float]  # Linear red, green and blue; also a direction

_LATITUDE, _DECLINATION = math.radians(45.0), math.radians(20.0)
"""A day in May at 45 degrees north; the sun stands in the south at 12."""
_DIMMING = (0.06, 0.12, 0.26)
"""Optical depth of a vertical way through the air for red, green and blue: a low sun is orange."""


def sun_at(hour: float) -> Colour:
    """Return the unit vector towards the sun: east, north, up.

    The usual formulas of hour angle, declination and latitude, by true solar time.
    """
    return _seen_at(math.radians(15.0 * (hour - 12.0)), _DECLINATION)


def _seen_at(turn: float, declination: float) -> Colour:
    """Return the unit vector to what has an hour angle and a declination [rad]."""
    south = exact.cos(declination) * exact.cos(turn)
    up = exact.sin(declination)
    return (
        -exact.cos(declination) * exact.sin(turn),
        exact.cos(_LATITUDE) * up - exact.sin(_LATITUDE) * south,
        exact.sin(_LATITUDE) * up + exact.cos(_LATITUDE) * south,
    )


_LOW_SUN, _MOONLIGHT, _DARK = 4.0, -6.0, -12.0
"""Heights of the sun [deg]: below the first night begins, below the second the moon's light, below
the third it is night."""

_MIXED = tuple(
    "zenith_colour horizon_colour fog_colour ambient_up ambient_down fog_density exposure "
    "luminosity clouds snow flakes rain leaves wet litter mist mist_depth glare "
    "longest_shadow".split()
)
"""Fields of a `Lighting` that are mixed by share in twilight."""

_LAMPS = ("lamps", "windows", "daytime_lamps")
"""Lights that are switched on as the sun sinks, from the horizon to as far below it as
`_LOW_SUN`."""
_LONGEST = 2.6  # Exposure under a low sun, over the day's: then lamps are lit
_LOWEST = 1.5  # Height of the sun below which the formulas of daylight would go on to black [deg]


_SIDEREAL = math.radians(15.041)  # Turn of the stars in an hour [rad]
_MOONRISE = 3.0  # Height of the moon below which it throws no light [deg]
_STARLIGHT = 0.35
"""Share of the night's ambient light that is not the moon's, but the stars' and the town's."""


def under_moon(
    night: Lighting,  # The night under a full moon
    hour: float,  # 0 to 24
    age: float,  # Of the moon, as a share of a month, 0 new, 0.5 full
) -> Lighting:
    """Return the light of a night with moon and stars where an hour has them.

    The moon lags behind the sun by its age, and stands as high in the south as the sun does half a
    year from a full moon. Its light falls off with the phase angle as Allen's formula says
    (Krisciunas and Schaefer, A model of the brightness of moonlight, 1991): a half moon gives a
    tenth of a full one.
    """
    lag = 2.0 * math.pi * age
    moon = _seen_at(math.radians(15.0 * (hour - 12.0)) - lag, _DECLINATION * float(exact.cos(lag)))
    height = math.degrees(float(exact.asin(moon[2])))
    angle = abs(180.0 - 360.0 * age)
    square = angle * angle
    dimmer = float(exact.power(10.0, -0.4 * (0.026 * angle + 4e-9 * square * square)))
    share = dimmer * min(max((height - _MOONRISE) / 6.0, 0.0), 1.0)
    lit = _STARLIGHT + (1.0 - _STARLIGHT) * share
    ambient: dict[str, Any] = {
        name: _scaled(getattr(night, name), lit) for name in ("ambient_up", "ambient_down")
    }
    return replace(
        night,
        sun_direction=_lifted(moon, max(height, _MOONRISE)),
        sun_colour=_scaled(night.sun_colour, share),
        zenith_colour=_scaled(night.zenith_colour, 0.5 + 0.5 * lit),
        star_turn=_SIDEREAL * hour,
        moon_limb=_limb(moon, sun_at(hour)),
        moon_lit=0.5 * (1.0 - float(exact.cos(lag))),
        **ambient,
    )


def _limb(moon: Colour, sun: Colour) -> Colour:
    """Return the unit vector across the line of sight from the moon towards the sun."""
    along = sum(a * b for a, b in zip(moon, sun, strict=True))
    x, y, z = (b - along * a for a, b in zip(moon, sun, strict=True))
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length) if length > 1e-6 else (1.0, 0.0, 0.0)


def at_hour(
    by_day: Lighting,  # Light and air while the sun is up
    by_night: Lighting,  # The same while it is deep below the horizon
    hour: float,  # The hour
) -> Lighting:
    """Return the light of an hour, 0 to 24: of the day, the night, or the twilight between them."""
    direction = sun_at(hour)
    height = math.degrees(float(exact.asin(direction[2])))
    if height >= _LOW_SUN:
        return _by_day(by_day, direction)
    if height <= _DARK:
        return by_night
    day = _by_day(by_day, _lifted(direction, max(height, _LOWEST)))
    night, share = by_night, (_LOW_SUN - height) / (_LOW_SUN - _DARK)
    mixed = {name: _mixed(getattr(day, name), getattr(night, name), share) for name in _MIXED}
    (mixed["luminance"],) = _mixed((day.luminance,), (night.luminance,), share)
    mixed["stars"] = day.stars if height > _MOONLIGHT else night.stars
    for name in ("star_turn", "moon_limb", "moon_lit"):
        mixed[name] = getattr(day if height > _MOONLIGHT else night, name)
    # Sun and moon change places while neither throws a shadow, so that none jumps.
    if height > _MOONLIGHT:
        mixed["sun_direction"] = _lifted(direction, _LOW_SUN)
        mixed["sun_colour"] = _scaled(day.sun_colour, max(height, 0.0) / _LOW_SUN)
    else:
        risen = (_MOONLIGHT - height) / (_MOONLIGHT - _DARK)
        mixed["sun_direction"] = night.sun_direction
        mixed["sun_colour"] = _scaled(night.sun_colour, risen)
    lit = min(max(-height, 0.0) / _LOW_SUN, 1.0)
    mixed |= {name: _mixed(getattr(day, name), getattr(night, name), lit) for name in _LAMPS}
    return replace(day, **mixed)


def _by_day(light: Lighting, direction: Colour) -> Lighting:
    """Return light and air of a weather with the sun somewhere above the horizon."""
    longer = _way(direction[2]) - _way(light.sun_direction[2])
    sun = _dimmed(light.sun_colour, longer)
    sky = min(math.sqrt(direction[2] / light.sun_direction[2]), 1.1)
    return replace(
        light,
        sun_direction=direction,
        sun_colour=sun,
        zenith_colour=_scaled(light.zenith_colour, sky),
        horizon_colour=_scaled(_dimmed(light.horizon_colour, 0.3 * longer), 0.5 + 0.5 * sky),
        fog_colour=_scaled(_dimmed(light.fog_colour, 0.3 * longer), 0.5 + 0.5 * sky),
        ambient_up=_scaled(light.ambient_up, sky),
        ambient_down=_scaled(light.ambient_down, sky),
        # The camera meters streets, which a low sun leaves to the sky.
        exposure=light.exposure * min(float(exact.power(sky, -0.75)), _LONGEST),
    )


def _lifted(direction: Colour, height: float) -> Colour:
    """Return the direction of the same azimuth, `height` degrees above the horizon."""
    east, north, _ = direction
    flat = exact.cos(math.radians(height)) / math.sqrt(east * east + north * north)
    return flat * east, flat * north, exact.sin(math.radians(height))


def _mixed(day: Any, night: Any, share: float) -> Any:  # noqa: ANN401  # numbers or colours
    """Return a mixture of day and night; colours by their logarithms, as eyes see."""
    if not isinstance(day, tuple):
        return (1.0 - share) * day + share * night
    return tuple(
        exact.exp((1.0 - share) * exact.log(a) + share * exact.log(b))
        for a, b in zip(day, night, strict=True)
    )


def _way(height: float) -> float:
    """Return the way of light through the air, given the sine of the sun's height; zenith: 1.

    Rozenberg, Twilight (1966): finite at the horizon, where 1 / sine is not.
    """
    return float(1.0 / (height + 0.025 * exact.exp(-11.0 * height)))


def _dimmed(colour: Colour, way: float) -> Colour:
    red, green, blue = (
        part * exact.exp(-taken * way) for part, taken in zip(colour, _DIMMING, strict=True)
    )
    return red, green, blue


def _scaled(colour: Colour, factor: float) -> Colour:
    red, green, blue = colour
    return factor * red, factor * green, factor * blue
