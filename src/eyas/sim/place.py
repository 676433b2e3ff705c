"""What simulations of the same place share: scene, renderer, traffic, rigs."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core.cache.cached import cached
from eyas.core.cache.folder import Kind
from eyas.render.ahead import compile_ahead
from eyas.render.kernels.bundles import Geometry
from eyas.render.pack.geometry import build_geometry
from eyas.render.renderer import Renderer, build_renderer
from eyas.render.textures.library import build_textures
from eyas.state.lighting import Lighting
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Scene
from eyas.targets.catalogue import KINDS, kind_index
from eyas.targets.rig import VehicleRigs, build_rigs
from eyas.traffic.config import Demand, TrafficConfig
from eyas.traffic.library import find_recording
from eyas.traffic.network import build_network
from eyas.traffic.recorded import recorded_motion
from eyas.traffic.replay import Replay
from eyas.traffic.source import TrafficSource
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS, MapRecipe
from eyas.world.maps.recipe import TRAFFIC_FILE
from eyas.world.weather import Season

__all__ = ["Place", "load_place", "load_scene"]


@dataclass(frozen=True, slots=True)
class Place:
    """A map in a weather with its traffic."""

    scene: Scene
    traffic: TrafficSource
    lighting: Lighting
    renderer: Renderer
    rigs: VehicleRigs


def load_network(world: WorldConfig) -> RoadNetwork:
    """Return the map's roads: shipped for seed 0, built by netconvert for other seeds.

    Raises:
        MissingExtraError: netconvert is needed and not installed.
    """
    recipe = MAPS.get(world.map)
    shipped = recipe.shipped_network() if world.seed == 0 else None
    return shipped or build_network(recipe.roads(world.seed))


@lru_cache(maxsize=2)
def load_scene(map_name: str, seed: int, season: Season = Season.SUMMER) -> Scene:
    """Return everything of a map that stands still."""
    recipe = MAPS.get(map_name)
    network = load_network(WorldConfig(map=map_name, seed=seed))
    return _cached_of_map(
        Kind.SCENE,
        recipe,
        (),
        _inputs(seed, season, network),
        lambda: recipe.scene(network, seed, season),
        of=Scene,
    )


Thing = TypeVar("Thing")

_SCENE_MAKERS = ("world", "mesh", "state", "core/rng.py")


def _cached_of_map(
    kind: Kind,
    recipe: MapRecipe,
    makers: tuple[str, ...],
    inputs: tuple[object, ...],
    make: Callable[[], Thing],
    *,
    of: type[Thing],
) -> Thing:
    """Return a value that is made of a map from the cache, see `cached`.

    Of a map without a package nothing is kept: no source tells one version of it from another.
    """
    sources = recipe.source_hash()
    if sources is None:
        return make()
    told = (recipe.name, sources, *inputs)
    return cached(kind, (*makers, *_SCENE_MAKERS), told, make, of=of)


def _inputs(seed: int, season: Season, network: RoadNetwork) -> tuple[object, ...]:
    """Return what tells one scene of a map from another."""
    roads = network.graph_hash, network.builder
    return seed, season.value, *roads, shapely.__version__


def load_place(world: WorldConfig, traffic: TrafficConfig, trackers: int) -> Place:
    """Return a place, built once in a process for all simulations in it.

    Args:
        world: Map and weather.
        traffic: What drives.
        trackers: How many follow; groups of vehicles that enter together are three times as many.

    Raises:
        EyasError: No such map or weather, or no traffic for it.
    """
    grouped = traffic.demand is Demand.RESPAWN and traffic.group_size is None
    return _load_place(world, traffic, trackers if grouped else 1)


def _textures() -> dict[str, NDArray[np.uint8]]:
    return cached(
        Kind.TEXTURES,
        ("render", "world/build/materials.py"),
        (),
        build_textures,
        of=dict[str, NDArray[np.uint8]],
    )


@lru_cache(maxsize=2)
def _load_place(world: WorldConfig, traffic: TrafficConfig, trackers: int) -> Place:
    recipe = MAPS.get(world.map)
    light, season = recipe.light(world.weather), recipe.season(world.weather)
    recording = find_recording(
        recipe.roads(world.seed),
        traffic,
        trackers=trackers,
        shipped=recipe.shipped(TRAFFIC_FILE),
    )
    ready = compile_ahead()
    scene = load_scene(world.map, world.seed, season)
    kind = np.array([kind_index(name) for name in recording.vehicle_types], np.int32)
    vehicle_type = KINDS[kind[0]]
    rigs = cached(
        Kind.RIGS,
        ("targets", "mesh", "state"),
        (vehicle_type,),
        lambda: build_rigs(vehicle_type),
        of=VehicleRigs,
    )
    geometry = _cached_of_map(
        Kind.GEOMETRY,
        recipe,
        ("render", "targets"),
        (vehicle_type, *_inputs(world.seed, season, scene.network)),
        lambda: build_geometry(scene, rigs.library, _textures()),
        of=Geometry,
    )
    renderer = build_renderer(scene, geometry, light, ready=ready)
    replay = Replay(recorded_motion(recording, scene.terrain, kind))
    return Place(scene, replay, light, renderer, rigs)
