"""Another map of a kind: the same recipe with another seed, made before it is used."""

from eyas.modes.maps.info import describe
from eyas.sim.assets import load_assets
from eyas.traffic.config import TrafficConfig
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS

__all__ = ["run"]


def run(name: str, seed: int) -> list[str]:
    """Make the map's roads, scene, geometry and traffic, all of which are kept in the cache.

    Returns:
        Its figures, and how to use it.

    Raises:
        EyasError: There is no such map, or it cannot be made.
    """
    world = WorldConfig(map=MAPS.get(name).name, seed=seed)
    load_assets(world, TrafficConfig(), 1)
    told = [line for line in describe(name, seed) if not line.startswith("recorded traffic")]
    return [*told, f"use it with --map {world.map} --set world.seed={seed}"]
