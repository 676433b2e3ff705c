"""The simple maps: sixteen straight roads that never meet, on grounds of seven kinds.

All have the same roads, and share the network and the recordings in this package. Weathers
included there are 24 of them: the original's 23, and the lawn in snow.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import Weather, in_fog
from eyas.maps.desert import desert_weather

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["CITY", "CLINKER", "DESERT", "FARM", "GRASS", "LAKE", "VILLAGE"]


def _weather(weather: Weather, visibility: float = 400.0) -> Weather:
    # The winter scene is white itself and, as in the original, roads stay black.
    return weather.each(lambda light: replace(in_fog(light, visibility), snow=0.0))


def _purple_by_night(weather: Weather) -> Weather:
    purple, glow = (0.009, 0.0075, 0.014), (0.021, 0.018, 0.028)
    night = replace(weather.night, zenith_colour=purple, horizon_colour=glow)
    return _weather(replace(weather, night=night))


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.simpleway.roads import road_graph

    return road_graph(seed)


def _skinned(
    skin: str,
    title: str,
    weather: Callable[[Weather], Weather] = _weather,
    *,
    seasons: bool = True,
    without: tuple[str, ...] = (),
) -> MapRecipe:
    """Return the simple map with one kind of ground."""

    def plan(network: "RoadNetwork", seed: int) -> "MapPlan":
        from eyas.maps.simpleway.plan import make_plan

        return make_plan(skin, network, seed)

    return MapRecipe(
        name=f"simpleway-{skin}",
        title=title,
        roads=_roads,
        plan=plan,
        weather=weather,
        without=without,
        seasons=seasons,
        package=__name__,
        original=Original(road=48.1),
    )


GRASS = _skinned("grass", "Straight roads on a lawn", partial(_weather, visibility=500.0))
CLINKER = _skinned(
    "clinker", "Straight roads on a grey plain", _purple_by_night, seasons=False, without=("snow",)
)
DESERT = _skinned("desert", "Straight roads under bars of sand", desert_weather)
FARM = _skinned("farm", "Straight roads between coloured strips")
LAKE = _skinned("lake", "Straight roads between strips of water")
VILLAGE = _skinned("village", "Straight roads on a green plain")
CITY = _skinned("city", "Straight roads on a white plain", without=("day", "foggy", "night"))
