"""Downtown: canyons between old blocks of brick and towers, and a park in the north."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.engine.world.weather import CLEAR_NIGHT, Weather, in_fog, metered

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["DOWNTOWN"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.downtown.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.downtown.plan import make_plan

    return make_plan(network, seed)


# Fronts and shop windows throw light back into the streets; the sky between them is black.
_LIT = replace(
    CLEAR_NIGHT,
    zenith_colour=(0.0012, 0.0016, 0.004),
    horizon_colour=(0.020, 0.016, 0.013),
    ambient_up=(0.042, 0.039, 0.037),
    ambient_down=(0.030, 0.025, 0.019),
    fog_colour=(0.014, 0.012, 0.010),
    windows=0.26,
)


def _weather(weather: Weather) -> Weather:
    # In the original the fog is too thin to be seen from above; here it veils the end of a block.
    lit = weather.each(lambda light: _LIT if light == CLEAR_NIGHT else in_fog(light, 500.0))
    return metered(lit, 1.25)  # most of the streets lie in shade


DOWNTOWN = MapRecipe(
    name="downtown",
    title="Canyons between towers, and a park",
    roads=_roads,
    plan=_plan,
    weather=_weather,
    package=__name__,
    original=Original(road=11.05, buildings=470, height=28.0, trees=334),
    pedestrians=80,
    waiting=40,
    cyclists=18,
)
