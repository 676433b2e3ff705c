"""The desert: dunes close to the road, and sand drifts that hide its surface."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original
from eyas.maps.desert.air import desert_weather

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["DESERT", "DESERT_BARE"]


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
