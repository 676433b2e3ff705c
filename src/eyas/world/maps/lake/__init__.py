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
    Season,
)

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["LAKE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.lake.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.lake.scene import build_scene

    return build_scene(network, seed, season)


LAKE = MapRecipe(
    name="lake",
    title="A suburb between ponds and strips of forest",
    roads=_roads,
    scene=_scene,
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
