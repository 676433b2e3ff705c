"""The lake district: a suburb of long blocks, each a pond or a strip of forest of one kind."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import Weather, in_fog, metered

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["LAKE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.lake.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.lake.plan import make_plan

    return make_plan(network, seed)


def _weather(weather: Weather) -> Weather:
    # Few windows light the woods.
    few = replace(weather.night, windows=min(weather.night.windows, 0.08))
    foggy = replace(weather, night=few).each(lambda light: in_fog(light, 400.0))
    return metered(foggy, 0.88)


LAKE = MapRecipe(
    name="lake",
    title="A suburb between ponds and strips of forest",
    roads=_roads,
    plan=_plan,
    weather=_weather,
    seasons=True,
    package=__name__,
    original=Original(road=19.67, buildings=56, height=9.0, trees=13_520),
    strollers=24,
    cyclists=8,
)
