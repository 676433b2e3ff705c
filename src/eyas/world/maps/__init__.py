"""The maps, one recipe a file."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import as_file, files

from eyas.core.errors import NotInThisVersionError, UnknownNameError
from eyas.state.roads import RoadGraph, RoadNetwork
from eyas.state.scene import Scene
from eyas.world.maps.citystreet import recipe as citystreet
from eyas.world.roads.network_file import load_network

__all__ = ["LATER", "MAPS", "Recipe", "build_scene", "road_graph", "shipped_network"]


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a map is made."""

    road_graph: Callable[[int], RoadGraph]
    """Draws the roads of a seed."""
    build_scene: Callable[[RoadNetwork, int], Scene]
    """Builds everything else of a seed around the processed roads."""


MAPS = {citystreet.NAME: Recipe(citystreet.road_graph, citystreet.build_scene)}
"""The recipes by name."""

LATER = ("desert", "downtown", "farmland", "lake", "simpleway", "village")
"""Maps of the original that this version does not have."""


def road_graph(name: str, seed: int) -> RoadGraph:
    """Return the roads of a map.

    Raises:
        UnknownNameError: No such map.
        NotInThisVersionError: The map is not part of this version.
    """
    _check(name)
    return MAPS[name].road_graph(seed)


def build_scene(name: str, network: RoadNetwork, seed: int) -> Scene:
    """Return everything of a map that stands still.

    Args:
        name: Of the map.
        network: The processed roads of the same map and seed.
        seed: Of the map, >= 0.

    Raises:
        UnknownNameError: No such map.
        NotInThisVersionError: The map is not part of this version.
    """
    _check(name)
    return MAPS[name].build_scene(network, seed)


def shipped_network(name: str) -> RoadNetwork | None:
    """Return the processed roads of a map's seed 0 that come with the package, if there are any.

    Raises:
        UnknownNameError: No such map.
        NotInThisVersionError: The map is not part of this version.
        DataFileError: The installation is damaged.
    """
    _check(name)
    resource = files("eyas.world.maps") / name / "network.npz"
    if not resource.is_file():
        return None
    with as_file(resource) as path:
        return load_network(path)


def _check(name: str) -> None:
    if name in LATER:
        have = ", ".join(sorted(MAPS))
        raise NotInThisVersionError(f"world.map: '{name}' is not in this version; there is: {have}")
    if name not in MAPS:
        raise UnknownNameError("world.map", name, (*MAPS, *LATER))
