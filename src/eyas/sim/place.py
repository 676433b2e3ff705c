"""What simulations of the same place share: scene, renderer, traffic, rigs."""

from dataclasses import dataclass
from functools import lru_cache

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
from eyas.state.roads import RoadNetwork
from eyas.state.scene import Lighting, Scene
from eyas.state.terrain import Terrain
from eyas.targets.catalogue import KINDS, kind_index
from eyas.targets.rig import VehicleRigs, build_rigs
from eyas.traffic.config import Demand, TrafficConfig
from eyas.traffic.library import find_recording
from eyas.traffic.network import build_network
from eyas.traffic.recorded import recorded_motion
from eyas.traffic.replay import Replay
from eyas.traffic.source import TrafficSource
from eyas.world.config import WorldConfig
from eyas.world.maps import build_scene, road_graph, shipped_network
from eyas.world.weather import lighting

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
    shipped = shipped_network(world.map) if world.seed == 0 else None
    return shipped or build_network(road_graph(world.map, world.seed))


@lru_cache(maxsize=2)
def load_scene(map_name: str, seed: int) -> Scene:
    """Return everything of a map that stands still."""
    network = load_network(WorldConfig(map=map_name, seed=seed))
    return cached(
        Kind.SCENE,
        _SCENE_MAKERS,
        _inputs(map_name, seed, network),
        lambda: build_scene(map_name, network, seed),
        of=Scene,
    )


_SCENE_MAKERS = ("world", "mesh", "state", "core/rng.py")


def _inputs(map_name: str, seed: int, network: RoadNetwork) -> tuple[object, ...]:
    """Return what tells one scene from another."""
    return map_name, seed, network.graph_hash, network.builder, shapely.__version__


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
    graph = road_graph(world.map, world.seed)
    light = lighting(world.map, world.weather)
    recording = find_recording(graph, traffic, trackers=trackers)
    ready = compile_ahead()
    scene = load_scene(world.map, world.seed)
    kind = np.array([kind_index(name) for name in recording.vehicle_types], np.int32)
    vehicle_type = KINDS[kind[0]]
    rigs = cached(
        Kind.RIGS,
        ("targets", "mesh", "state"),
        (vehicle_type,),
        lambda: build_rigs(vehicle_type),
        of=VehicleRigs,
    )
    geometry = cached(
        Kind.GEOMETRY,
        ("render", "targets", *_SCENE_MAKERS),
        (vehicle_type, *_inputs(world.map, world.seed, scene.network)),
        lambda: build_geometry(scene, rigs.library, _textures()),
        of=Geometry,
    )
    renderer = build_renderer(scene, geometry, light, ready=ready)
    ground = Terrain.flat(scene.ground_height)
    replay = Replay(recorded_motion(recording, ground, kind))
    return Place(scene, replay, light, renderer, rigs)
