"""The desert: dunes close to the road, and sand drifts that hide its surface."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from eyas.engine.state.lighting import Lighting
from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import (
    CLEAR_DAY,
    CLEAR_NIGHT,
    DUST,
    FOG,
    OVERCAST,
    RAIN,
    WINTER_DAY,
    Weather,
    metered,
)

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["DESERT", "DESERT_BARE", "desert_weather"]

# The original's sky is pale yellow to white, its sun the same as everywhere.
_DAY = replace(
    CLEAR_DAY,
    sun_colour=(1.62, 1.49, 1.25),
    zenith_colour=(0.66, 0.61, 0.42),
    horizon_colour=(1.0, 0.88, 0.56),
    # Sand reflects more light upwards than grass.
    ambient_up=(0.26, 0.255, 0.225),
    ambient_down=(0.26, 0.22, 0.15),
    fog_colour=(0.84, 0.76, 0.56),
    fog_density=1.0 / 5000.0,
    clouds=0.0,
)

# Dust in the air: the original's visibility range, and its sun still casts shadows.
_FOG = replace(
    _DAY,
    sun_colour=(0.50, 0.45, 0.36),
    zenith_colour=(0.78, 0.75, 0.66),
    horizon_colour=(0.94, 0.89, 0.76),
    ambient_up=(0.50, 0.48, 0.43),
    ambient_down=(0.27, 0.24, 0.18),
    fog_colour=(0.88, 0.84, 0.73),
    fog_density=1.0 / 400.0,
    foggy=True,
    clouds=0.0,
)

# The ground stays sand, so that snow is a matter of the scene; the sky is clearer and colder.
_WINTER = replace(
    _DAY,
    sun_colour=(1.00, 0.95, 0.84),
    zenith_colour=(0.46, 0.54, 0.58),
    horizon_colour=(0.86, 0.84, 0.72),
    ambient_up=(0.34, 0.36, 0.36),
    fog_colour=(0.78, 0.76, 0.66),
    flakes=0.25,
)

# A low warm moon over chocolate brown, and the last red light of the day at the horizon.
_NIGHT = replace(
    CLEAR_NIGHT,
    sun_direction=(0.55, 0.66, 0.51),
    sun_colour=(0.015, 0.013, 0.011),
    zenith_colour=(0.0017, 0.0019, 0.0032),
    horizon_colour=(0.024, 0.011, 0.0065),
    ambient_up=(0.014, 0.012, 0.010),
    ambient_down=(0.008, 0.006, 0.004),
    fog_colour=(0.010, 0.0065, 0.005),
)

_SKIES = {CLEAR_DAY: _DAY, FOG: _FOG, WINTER_DAY: _WINTER, CLEAR_NIGHT: _NIGHT}


_SKY = ("zenith_colour", "horizon_colour", "fog_colour", "ambient_up", "ambient_down")
_CLOSED = {weather.name for weather in (RAIN, OVERCAST, DUST)}
"""Weathers whose sky no sun shines through."""
_PALE = 0.78  # Exposure of sand, which is twice as pale as grass


def desert_weather(weather: Weather) -> Weather:
    """Return how a weather is in the desert."""
    if weather.name in _CLOSED:
        return metered(weather.each(_sandy), _PALE)
    return metered(weather.each(lambda light: _SKIES.get(light) or _dusty(light)), _PALE)


def _dusty(light: Lighting) -> Lighting:
    """Return any other light, half of whose sky is dust; the ground stays sand."""
    sky = _DAY if light.luminosity == 1.0 else _NIGHT
    half: dict[str, Any] = {
        name: tuple(
            0.5 * (own + dust)
            for own, dust in zip(getattr(light, name), getattr(sky, name), strict=True)
        )
        for name in _SKY
    }
    return replace(light, snow=0.0, **half)


def _sandy(light: Lighting) -> Lighting:
    """Return light under a closed sky, as warm as the sand that it is reflected by."""
    tinted: dict[str, Any] = {}
    for name in _SKY:
        red, green, blue = getattr(light, name)
        tinted[name] = (1.06 * red, green, 0.86 * blue)
    return replace(light, snow=0.0, **tinted)


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.desert.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.desert.plan import make_plan

    return make_plan(network, seed)


def _bare_plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.bare import make_plan
    from eyas.maps.desert.layout import FLOOR
    from eyas.maps.desert.plan import DUNES, SAND

    return make_plan("desert-bare", network, seed, FLOOR, SAND, DUNES)


DESERT = MapRecipe(
    name="desert",
    title="Dunes, and roads under sand",
    roads=_roads,
    plan=_plan,
    weather=desert_weather,
    seasons=True,
    package=__name__,
    original=Original(road=3.37, buildings=7, height=12.0),
)

DESERT_BARE = replace(
    DESERT,
    name="desert-bare",
    title="The roads of the desert on bare sand, without scenery",
    plan=_bare_plan,
    without=("foggy", "night", "snow"),
    seasons=False,
    original=Original(road=3.35),
)
"""The layout `desertS` of the original."""
