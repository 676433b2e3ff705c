"""Downtown: a dense grid of streets between old brick blocks and towers, and a park in the north."""

from dataclasses import replace
from typing import TYPE_CHECKING

from eyas.world.maps.recipe import MapRecipe
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

__all__ = ["DOWNTOWN"]


def _roads(seed: int) -> "RoadGraph":
    from eyas.world.maps.downtown.roads import road_graph

    return road_graph(seed)


def _scene(network: "RoadNetwork", seed: int, season: Season) -> "Scene":
    """Build the city; in winter it is the same, and the weather's light adds the snow."""
    from eyas.world.maps.downtown.scene import build_scene

    return build_scene(network, seed)


# The original's fog hides the far end of an avenue, not the other side of a crossing: its density
# grows with the square of the distance.
_HAZE = replace(FOG, fog_density=1.0 / 650.0, fog_power=2)

# Between lit fronts the streets are less dark than on open land, and many more windows are lit.
_LIT = replace(
    CLEAR_NIGHT,
    horizon_colour=(0.030, 0.027, 0.030),
    ambient_down=(0.042, 0.037, 0.030),
    windows=0.42,
)

DOWNTOWN = MapRecipe(
    name="downtown",
    title="Canyons between towers, and a park",
    roads=_roads,
    scene=_scene,
    lighting={DAY: CLEAR_DAY, FOGGY: _HAZE, NIGHT: _LIT, SNOW: WINTER_DAY},
    package=__name__,
)
