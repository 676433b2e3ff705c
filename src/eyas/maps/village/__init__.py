"""The village: a green valley of faceted hills, where tunnels hide the target."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import CLEAR_DAY, CLEAR_NIGHT, FOG, Weather, in_fog, unchanged

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["VILLAGE", "VILLAGE_BARE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.village.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.village.plan import make_plan

    return make_plan(network, seed)


def _bare_plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.bare import make_plan
    from eyas.maps.village.layout import FLOOR
    from eyas.maps.village.plan import GRASS, VALLEY

    return make_plan("village-bare", network, seed, FLOOR, GRASS, VALLEY, "double yellow")


# Haze that fills the valley to the original's visibility range, below a sky that stays blue: the
# sun still casts shadows.
_HAZE = replace(
    CLEAR_DAY,
    sun_colour=(0.55, 0.53, 0.48),
    zenith_colour=(0.22, 0.34, 0.56),
    horizon_colour=(0.80, 0.84, 0.88),
    ambient_up=(0.44, 0.47, 0.51),
    ambient_down=(0.20, 0.21, 0.18),
    fog_colour=(0.74, 0.78, 0.81),
    fog_density=1.0 / 400.0,
    foggy=True,
    clouds=0.45,
)

# Darker than in a city, and greenish as under the lights of a stadium.
_DARK = replace(
    CLEAR_NIGHT,
    sun_colour=(0.014, 0.016, 0.017),
    ambient_up=(0.016, 0.018, 0.018),
    ambient_down=(0.008, 0.009, 0.008),
    horizon_colour=(0.007, 0.0075, 0.0085),
    fog_colour=(0.006, 0.0065, 0.007),
    windows=0.2,
)

_SKIES = {FOG: _HAZE, CLEAR_NIGHT: _DARK}


def _weather(weather: Weather) -> Weather:
    return weather.each(lambda light: _SKIES.get(light) or in_fog(light, 400.0))


VILLAGE = MapRecipe(
    name="village",
    title="A green valley with hills and tunnels",
    roads=_roads,
    plan=_plan,
    weather=_weather,
    package=__name__,
    original=Original(road=3.59, buildings=24, height=12.0, trees=41),
    strollers=24,
    waiting=12,
    cyclists=8,
)

VILLAGE_BARE = replace(
    VILLAGE,
    name="village-bare",
    title="The roads of the village on bare grass, without scenery",
    plan=_bare_plan,
    weather=unchanged,
    without=("foggy", "night", "snow"),
    seasons=False,
    original=Original(road=3.59),
    strollers=0,
    waiting=0,
    cyclists=0,
)
"""The layout `villageS` of the original."""
