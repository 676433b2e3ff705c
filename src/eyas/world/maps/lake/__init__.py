"""The lake district: a suburb of long blocks, each a pond or a strip of forest of one kind."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe, Original
from eyas.world.weather import (
    CLEAR_DAY,
    CLEAR_NIGHT,
    DAY,
    FOG,
    FOGGY,
    NIGHT,
    SNOW,
    WINTER_DAY,
)

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.world.plan.plan import MapPlan

__all__ = ["LAKE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.lake.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.world.maps.lake.plan import make_plan

    return make_plan(network, seed)


LAKE = MapRecipe(
    name="lake",
    title="A suburb between ponds and strips of forest",
    roads=_roads,
    plan=_plan,
    lighting={
        DAY: CLEAR_DAY,
        FOGGY: replace(FOG, fog_density=1.0 / 400.0),
        NIGHT: CLEAR_NIGHT,
        SNOW: WINTER_DAY,
    },
    seasons=True,
    package=__name__,
    original=Original(road=19.67, buildings=56, height=9.0, trees=13_520),
)
