"""The village: a green valley of faceted hills, where tunnels hide the target."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe, Original
from eyas.world.maps.village.air import VILLAGE_FOG, VILLAGE_NIGHT
from eyas.world.weather import CLEAR_DAY, DAY, FOGGY, NIGHT, SNOW, WINTER_DAY, Season

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.state.scene import Scene

__all__ = ["VILLAGE", "VILLAGE_BARE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.village.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    """Build the village; in winter it is the same, and the weather's light adds the snow."""
    from eyas.world.maps.village.scene import build_scene

    return build_scene(network, seed)


def _bare_scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    from eyas.world.maps.bare import build_bare_scene
    from eyas.world.maps.village.looks import GRASS
    from eyas.world.maps.village.plan import FLOOR
    from eyas.world.maps.village.scene import VALLEY
    from eyas.world.roads import markings

    return build_bare_scene(
        "village-bare", network, seed, FLOOR, GRASS, VALLEY, markings.Centre.DOUBLE_YELLOW
    )


VILLAGE = MapRecipe(
    name="village",
    title="A green valley with hills and tunnels",
    roads=_roads,
    scene=_scene,
    lighting={DAY: CLEAR_DAY, FOGGY: VILLAGE_FOG, NIGHT: VILLAGE_NIGHT, SNOW: WINTER_DAY},
    package=__name__,
    original=Original(road=3.59, buildings=24, height=12.0, trees=41),
)

VILLAGE_BARE = replace(
    VILLAGE,
    name="village-bare",
    title="The roads of the village on bare grass, without scenery",
    scene=_bare_scene,
    lighting={DAY: CLEAR_DAY},
    seasons=False,
    original=Original(road=3.59),
)
"""The layout `villageS` of the original."""
