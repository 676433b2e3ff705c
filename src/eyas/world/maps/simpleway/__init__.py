"""The simple maps: sixteen straight roads that never meet, on grounds of seven kinds.

All have the same roads, and share the network and the recordings in this package. Weathers
included there are 24 of them: the original's 23, and the lawn in snow.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.state.lighting import Lighting
from eyas.world.maps.desert.air import DESERT_DAY, DESERT_FOG, DESERT_NIGHT, DESERT_WINTER
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
    Weather,
)

if TYPE_CHECKING:
    from eyas.state.roads import RoadGraph, RoadNetwork
    from eyas.world.plan.plan import MapPlan

__all__ = ["CITY", "CLINKER", "DESERT", "FARM", "GRASS", "LAKE", "VILLAGE"]

_FOG = replace(FOG, fog_density=1.0 / 400.0)
# The winter scene is white itself and, as in the original, roads stay black.
_WINTER = replace(WINTER_DAY, snow=0.0)
_ALL = {DAY: CLEAR_DAY, FOGGY: _FOG, NIGHT: CLEAR_NIGHT, SNOW: _WINTER}

_DESERT = {DAY: DESERT_DAY, FOGGY: DESERT_FOG, NIGHT: DESERT_NIGHT, SNOW: DESERT_WINTER}

_PURPLE_NIGHT = replace(
    CLEAR_NIGHT, zenith_colour=(0.018, 0.015, 0.028), horizon_colour=(0.042, 0.036, 0.057)
)


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.simpleway.roads import road_graph

    return road_graph(seed)


def _skinned(
    skin: str, title: str, lighting: Mapping[Weather, Lighting], *, seasons: bool = False
) -> MapRecipe:
    """Return the simple map with one kind of ground."""

    def plan(network: "RoadNetwork", seed: int) -> "MapPlan":
        from eyas.world.maps.simpleway.plan import make_plan

        return make_plan(skin, network, seed)

    return MapRecipe(
        name=f"simpleway-{skin}",
        title=title,
        roads=_roads,
        plan=plan,
        lighting=lighting,
        seasons=seasons,
        package=__name__,
        original=Original(road=48.1),
    )


GRASS = _skinned(
    "grass",
    "Straight roads on a lawn",
    {**_ALL, FOGGY: replace(FOG, fog_density=1.0 / 500.0)},
    seasons=True,
)
CLINKER = _skinned(
    "clinker",
    "Straight roads on a grey plain",
    {DAY: CLEAR_DAY, FOGGY: _FOG, NIGHT: _PURPLE_NIGHT},
)
DESERT = _skinned("desert", "Straight roads under bars of sand", _DESERT, seasons=True)
FARM = _skinned("farm", "Straight roads between coloured strips", _ALL, seasons=True)
LAKE = _skinned("lake", "Straight roads between strips of water", _ALL, seasons=True)
VILLAGE = _skinned("village", "Straight roads on a green plain", _ALL, seasons=True)
CITY = _skinned("city", "Straight roads on a white plain", {SNOW: _WINTER}, seasons=True)
