"""The desert: dunes close to the road, and sand drifts that hide its surface."""

from typing import TYPE_CHECKING

from eyas.world.maps.desert.air import DESERT_DAY, DESERT_FOG, DESERT_NIGHT, DESERT_WINTER
from eyas.world.maps.recipe import MapRecipe
from eyas.world.weather import DAY, FOGGY, NIGHT, SNOW, Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["DESERT"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.desert.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.desert.scene import build_scene

    return build_scene(network, seed, season)


DESERT = MapRecipe(
    name="desert",
    title="Dunes, and roads under sand",
    roads=_roads,
    scene=_scene,
    lighting={DAY: DESERT_DAY, FOGGY: DESERT_FOG, NIGHT: DESERT_NIGHT, SNOW: DESERT_WINTER},
    seasons=True,
    package=__name__,
)
