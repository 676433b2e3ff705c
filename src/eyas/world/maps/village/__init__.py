"""The village: a green valley of faceted hills, where tunnels hide the target."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe, Original
from eyas.world.maps.village.air import VILLAGE_FOG, VILLAGE_NIGHT
from eyas.world.weather import CLEAR_DAY, DAY, FOGGY, NIGHT, SNOW, WINTER_DAY

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.world.plan.plan import MapPlan

__all__ = ["VILLAGE", "VILLAGE_BARE"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.village.roads import road_graph

    return road_graph(seed)


def _plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.world.maps.village.plan import make_plan

    return make_plan(network, seed)


def _bare_plan(network: "RoadNetwork", seed: int) -> "MapPlan":
    from eyas.world.maps.bare import make_plan
    from eyas.world.maps.village.layout import FLOOR
    from eyas.world.maps.village.looks import GRASS
    from eyas.world.maps.village.plan import VALLEY

    return make_plan("village-bare", network, seed, FLOOR, GRASS, VALLEY, "double yellow")


VILLAGE = MapRecipe(
    name="village",
    title="A green valley with hills and tunnels",
    roads=_roads,
    plan=_plan,
    lighting={DAY: CLEAR_DAY, FOGGY: VILLAGE_FOG, NIGHT: VILLAGE_NIGHT, SNOW: WINTER_DAY},
    package=__name__,
    original=Original(road=3.59, buildings=24, height=12.0, trees=41),
)

VILLAGE_BARE = replace(
    VILLAGE,
    name="village-bare",
    title="The roads of the village on bare grass, without scenery",
    plan=_bare_plan,
    lighting={DAY: CLEAR_DAY},
    seasons=False,
    original=Original(road=3.59),
)
"""The layout `villageS` of the original."""
