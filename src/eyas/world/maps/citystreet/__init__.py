"""The street city: mid-rise blocks on lawn, rows of large trees, a road high above the roofs."""

from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe, Original
from eyas.world.weather import Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["CITYSTREET"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.citystreet.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    """Build the city; in winter it is the same, and the weather's light adds the snow."""
    from eyas.world.maps.citystreet.scene import build_scene

    return build_scene(network, seed)


CITYSTREET = MapRecipe(
    name="citystreet",
    title="Mid-rise city blocks with rows of great trees",
    roads=_roads,
    scene=_scene,
    package=__name__,
    original=Original(road=4.01, buildings=83, height=30.0, trees=63),
    pedestrians=40,
)
