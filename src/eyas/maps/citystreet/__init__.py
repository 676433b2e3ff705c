"""The street city: mid-rise blocks on lawn, rows of large trees, a road high above the roofs."""

from typing import TYPE_CHECKING

from eyas.engine.world.maps.recipe import MapRecipe, Original

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadGraph, RoadNetwork
    from eyas.maps.plan.plan import MapPlan

__all__ = ["CITYSTREET"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.maps.citystreet.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.maps.citystreet.plan import make_plan

    return make_plan(network, seed)


CITYSTREET = MapRecipe(
    name="citystreet",
    title="Mid-rise city blocks with rows of great trees",
    roads=_roads,
    plan=_plan,
    package=__name__,
    original=Original(road=4.01, buildings=83, height=30.0, trees=63),
    pedestrians=40,
    waiting=16,
    cyclists=10,
)
