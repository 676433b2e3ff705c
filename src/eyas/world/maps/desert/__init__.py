"""The desert: dunes close to the road, and sand drifts that hide its surface."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.world.maps.desert.air import desert_weather
from eyas.world.maps.recipe import MapRecipe, Original
from eyas.world.weather import Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["DESERT", "DESERT_BARE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.desert.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.desert.scene import build_scene

    return build_scene(network, seed, season)


def _bare_scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.bare import build_bare_scene
    from eyas.world.maps.desert.looks import SAND
    from eyas.world.maps.desert.plan import FLOOR
    from eyas.world.maps.desert.scene import DUNES

    return build_bare_scene("desert-bare", network, seed, FLOOR, SAND, DUNES)


DESERT = MapRecipe(
    name="desert",
    title="Dunes, and roads under sand",
    roads=_roads,
    scene=_scene,
    weather=desert_weather,
    seasons=True,
    package=__name__,
    original=Original(road=3.37, buildings=7, height=12.0),
)

DESERT_BARE = replace(
    DESERT,
    name="desert-bare",
    title="The roads of the desert on bare sand, without scenery",
    scene=_bare_scene,
    without=("foggy", "night", "snow"),
    seasons=False,
    original=Original(road=3.35),
)
"""The layout `desertS` of the original."""
