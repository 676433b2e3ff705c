"""The village: a green valley of faceted hills, where tunnels hide the target."""

from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe
from eyas.world.maps.village.air import VILLAGE_FOG, VILLAGE_NIGHT
from eyas.world.weather import CLEAR_DAY, DAY, FOGGY, NIGHT, SNOW, WINTER_DAY, Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["VILLAGE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.village.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    """Build the village; in winter it is the same, and the weather's light adds the snow."""
    from eyas.world.maps.village.scene import build_scene

    return build_scene(network, seed)


VILLAGE = MapRecipe(
    name="village",
    title="A green valley with hills and tunnels",
    roads=_roads,
    scene=_scene,
    lighting={DAY: CLEAR_DAY, FOGGY: VILLAGE_FOG, NIGHT: VILLAGE_NIGHT, SNOW: WINTER_DAY},
    package=__name__,
)
