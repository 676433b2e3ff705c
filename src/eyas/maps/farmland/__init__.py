"""The farmland: a patchwork of crops in four colours between straight roads, nothing to hide in."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import Weather, in_fog, metered, unchanged

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["FARMLAND", "FARMLAND_BARE"]

_BY_DAY = 0.2
"""Lamps by day: as in the original they are never off, and leave a warm glow on the road."""
_CLEAR = 1.0 / 18_000.0  # Density of air in which the mountains are seen


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.farmland.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.farmland.plan import make_plan

    return make_plan(network, seed)


def _weather(weather: Weather) -> Weather:
    day = replace(weather.day, lamps=max(weather.day.lamps, _BY_DAY))
    # No town is near: stars above a pale rim of the sky.
    night = replace(weather.night, horizon_colour=(0.008, 0.008, 0.009))
    if not day.foggy and not day.rain:
        day = replace(day, fog_density=_CLEAR)
    foggy = replace(weather, day=in_fog(day, 400.0), night=in_fog(night, 400.0))
    return metered(foggy, 0.88)


def _bare_plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.bare import make_plan
    from eyas.maps.farmland.layout import FLOOR
    from eyas.maps.farmland.plan import MOUNTAINS
    from eyas.maps.farmland.scenery import SOIL

    return make_plan("farmland-bare", network, seed, FLOOR, SOIL, MOUNTAINS)


FARMLAND = MapRecipe(
    name="farmland",
    title="A patchwork of fields in four colours",
    roads=_roads,
    plan=_plan,
    weather=_weather,
    seasons=True,
    package=__name__,
    original=Original(road=4.43),
    strollers=12,
    cyclists=4,
)

FARMLAND_BARE = replace(
    FARMLAND,
    name="farmland-bare",
    title="The roads of the farmland on bare soil, without scenery",
    plan=_bare_plan,
    weather=unchanged,
    without=("foggy", "night", "snow"),
    seasons=False,
    original=Original(road=4.45),
    strollers=0,
    cyclists=0,
)
"""The layout `farmlandS` of the original."""
