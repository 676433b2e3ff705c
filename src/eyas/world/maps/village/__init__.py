"""The village: a green valley of faceted hills, a winding road, and tunnels that hide the target."""

from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe
from eyas.world.weather import DAY, FOGGY, NIGHT, SNOW, Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["VILLAGE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.village.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.village.scene import build_scene

    return build_scene(network, seed)


def _lighting() -> dict:  # placeholder
    from eyas.world.weather import CLEAR_DAY, CLEAR_NIGHT, FOG, WINTER_DAY

    return {DAY: CLEAR_DAY, FOGGY: FOG, NIGHT: CLEAR_NIGHT, SNOW: WINTER_DAY}


VILLAGE = MapRecipe(
    name="village",
    title="A green valley with hills and tunnels",
    roads=_roads,
    scene=_scene,
    lighting=_lighting(),
    package=__name__,
)
