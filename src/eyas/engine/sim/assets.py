"""Data shared by simulations of the same map, weather and traffic; made once per process."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.behaviours.groups import SampleClock
from eyas.engine.core.cache.array_file import let_go
from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.kernels.bundles import Geometry, Light
from eyas.engine.render.renderer import CpuRenderer, pack_scene
from eyas.engine.sensors.obstacles import Solids
from eyas.engine.sim.cover import cover_of
from eyas.engine.sim.crowd import NOBODY, Crowd, vehicles_of
from eyas.engine.sim.crowd_motion import CrowdSurroundings, live_motions, with_crowd
from eyas.engine.sim.scenes import Lenses, load_geometry, load_network, load_scene, load_solids
from eyas.engine.sim.views.additions import SignalLights, lights_of, signal_poles
from eyas.engine.state.draw import Renderer
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.roads import RoadGraph
from eyas.engine.state.scene import Scene
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.targets.quadrotor import QUADROTOR
from eyas.engine.targets.rig import Rigs
from eyas.engine.traffic.config import Demand, Drivers, Lamps, Signals, Source, TrafficConfig
from eyas.engine.traffic.library import CANONICAL_SEED, STANDARD_DURATION, find_file, obeys_signals
from eyas.engine.traffic.live import LiveSumo
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.record import resolved, roads_for
from eyas.engine.traffic.recorded import Vehicles, recorded_vehicles
from eyas.engine.traffic.replay import Replay
from eyas.engine.traffic.signals import SignalPlan, load_plan, signal_plan, walk_plan
from eyas.engine.traffic.source import TrafficSource
from eyas.engine.world.config import WorldConfig, WorldWindConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import SIGNALS_FILE, SIGNALS_TRAFFIC_FILE

_FALLING = ("flakes", "rain", "leaves")

_RATE = 10.0  # Samples per second of worlds without vehicles, as of a recording [Hz]


@dataclass(frozen=True, slots=True)
class Assets:
    """A map in a weather, with its traffic."""

    scene: Scene
    traffic: TrafficSource
    lighting: Lighting
    renderer: Renderer
    """Eyas' own packs what it draws at the first call of a method."""
    rigs: Rigs
    solids: Callable[[], Solids]
    """Returns what rays and bodies may meet, loaded when it is first asked for."""
    body_part: int = -1
    """Part of the renderer's library that a tracker looks like to others; -1: it has none."""
    signals: SignalLights | None = None  # Lights of signals that change; None: there are none


def load_assets(
    world: WorldConfig,
    traffic: TrafficConfig,
    trackers: int = 1,
    crowd: Crowd = NOBODY,
    *,
    bodies: bool = False,
) -> Assets:
    """Return the data of a simulation; simulations that need the same part share it.

    Weathers of one season share scene and geometry; different traffic shares the scene; all
    weathers share the traffic.

    Args:
        world: Map and weather.
        traffic: The traffic.
        trackers: Number of trackers in a world; at least three times as many vehicles enter
            together in a group, and several see each other.
        crowd: Who is there besides, or instead of, the vehicles.
        bodies: Whether even the only tracker in a world has a body that may be seen.

    Raises:
        EyasError: The map or weather does not exist, or has no traffic.
    """
    if world.wind is not None:  # whatever its speed, drawn for each episode
        world = world.model_copy(update={"wind": WorldWindConfig()})
    recipe = MAPS.get(world.map)
    lighting, season = _lighting(world), recipe.season(world.weather)
    town = bool(recipe.roads(world.seed).finished)
    scene = load_scene(world.map, world.seed, season)
    if traffic.signals is None:
        working = not town and _obeyed(world, traffic, scene)
        decided = Signals.WORKING if working else Signals.AMBER
        traffic = traffic.model_copy(update={"signals": decided})
    if not town and traffic.signals is Signals.WORKING and not signal_poles(scene):
        raise ConfigError(
            f"traffic.signals: 'working' is not allowed on '{world.map}', which has no traffic "
            "lights; allowed there: amber"
        )
    grouped = traffic.demand is Demand.RESPAWN
    find = _live if traffic.source is Source.LIVE else _traffic
    source = find(world.map, world.seed, traffic, trackers if grouped else 1, crowd)
    kinds, rigs = sorted({*source.motion.kind.tolist()}), Rigs(source.motion.kind)
    body_part, parts = -1, sum(cast.rig.part_count for cast in rigs.casts)
    if trackers > 1 or bodies:
        body_part, parts = parts, parts + 1
        kinds.append(kind_index(QUADROTOR.name))
    plan = _signal_plan(world.map, world.seed, traffic.drivers, traffic.signals)
    signals = None if plan is None else lights_of(scene, plan, parts)
    lenses = Lenses.NONE if signals is None else Lenses.PLAIN if town else Lenses.COVERING
    renderer = _renderer(world, tuple(kinds), lenses)
    solids = partial(load_solids, world.map, world.seed, season)
    return Assets(scene, source, lighting, renderer, rigs, solids, body_part, signals)


def _obeyed(world: WorldConfig, traffic: TrafficConfig, scene: Scene) -> bool:
    """Return whether signals work if the settings leave it open, see `TrafficConfig.signals`."""
    if traffic.source is Source.LIVE:
        return bool(signal_poles(scene))
    recipe = MAPS.get(world.map)
    kept = recipe.shipped(SIGNALS_TRAFFIC_FILE)
    # A bare map has the traffic of another, but not its poles.
    return obeys_signals(recipe.roads(world.seed), traffic, kept) and bool(signal_poles(scene))


@lru_cache(maxsize=4)
def _signal_plan(
    map_name: str, seed: int, drivers: Drivers, signals: Signals | None
) -> SignalPlan | None:
    """Return what signals show; None if there are none that work."""
    recipe = MAPS.get(map_name)
    graph = recipe.roads(seed)
    if signals is not Signals.WORKING and not graph.finished:
        return None
    kept = recipe.shipped(SIGNALS_FILE)
    if kept is not None and not graph.finished and seed == 0 and drivers is not Drivers.EVADING:
        return load_plan(kept)  # so that it needs no SUMO
    return signal_plan(SumoNet(graph.finished or _signalled(graph, drivers)))


def _signalled(graph: RoadGraph, drivers: Drivers) -> bytes:
    """Return SUMO's network file of roads with working signals, kept in the cache."""
    driven = TrafficConfig(drivers=drivers, signals=Signals.WORKING)
    network = cached(
        EntryKind.PLAN,
        lambda: np.frombuffer(roads_for(driven, graph), np.uint8),
        (roads_for, graph, drivers.value),
        of=NDArray[np.uint8],
    )
    return network.tobytes()


@lru_cache(maxsize=4)
def _traffic(
    map_name: str, seed: int, config: TrafficConfig, trackers: int, crowd: Crowd
) -> TrafficSource:
    vehicles = _vehicles(map_name, seed, config, trackers, crowd)
    clock = SampleClock(round(STANDARD_DURATION * _RATE) + 1, _RATE)
    if vehicles is not None:
        clock = SampleClock(vehicles.samples, vehicles.rate)
    # A scene depends on the season, but its ground does not.
    scene = load_scene(map_name, seed)
    finished, lights = MAPS.get(map_name).roads(seed).finished, None
    if scene.footways.told and finished:
        lights = walk_plan(SumoNet(finished))
    around = CrowdSurroundings(scene, clock, _seed_of(config), vehicles, lights)
    motion, targets = with_crowd(crowd, around)
    replay = Replay(motion, targets)
    let_go(motion.track)  # which has been read to its end
    return replay


def _live(
    map_name: str, seed: int, config: TrafficConfig, trackers: int, crowd: Crowd
) -> TrafficSource:
    """Return traffic that SUMO drives now: never shared, as its simulation ends with its owner."""
    if not crowd.follows_vehicles:
        raise ConfigError(
            "traffic.source: 'live' is for targets that SUMO drives, 'SUMO_VEHICLE'; use 'recorded'"
        )
    scene, own_seed = load_scene(map_name, seed), _seed_of(config)
    clock = SampleClock(round(STANDARD_DURATION * _RATE) + 1, _RATE)
    return LiveSumo(
        MAPS.get(map_name).roads(seed),
        resolved(config, own_seed, trackers),
        scene.terrain,
        kind_index,
        STANDARD_DURATION,
        others=live_motions(crowd, CrowdSurroundings(scene, clock, own_seed)),
        lamps=config.lamps is Lamps.WORKING,
        cover=() if config.drivers is Drivers.NORMAL else cover_of(map_name, seed),
    )


def _seed_of(config: TrafficConfig) -> int:
    return CANONICAL_SEED if config.seed is None else config.seed


def _vehicles(
    map_name: str, seed: int, config: TrafficConfig, trackers: int, crowd: Crowd
) -> Vehicles | None:
    """Return SUMO's vehicles; None if none are wanted."""
    if vehicles_of(crowd, config.max_vehicles) == 0:
        return None
    recipe = MAPS.get(map_name)
    file = find_file(
        recipe.roads(seed),
        config,
        trackers=trackers,
        shipped=recipe.shipped_traffic(),
        cover=partial(cover_of, map_name, seed),
    )
    kind = np.array([kind_index(name) for name in file.outline().vehicle_types], np.int32)
    network = load_network(map_name, seed) if config.lamps is Lamps.WORKING else None
    terrain = load_scene(map_name, seed).terrain
    return recorded_vehicles(file, terrain, kind[: vehicles_of(crowd, len(kind))], network)


@lru_cache(maxsize=8)
def _renderer(world: WorldConfig, kinds: tuple[int, ...], lenses: Lenses) -> Renderer:
    return CpuRenderer(partial(_packed, world, kinds, lenses))


def _packed(world: WorldConfig, kinds: tuple[int, ...], lenses: Lenses) -> tuple[Geometry, Light]:
    season = MAPS.get(world.map).season(world.weather)
    return pack_scene(
        load_scene(world.map, world.seed, season),
        load_geometry(world.map, world.seed, season, kinds, lenses=lenses),
        _lighting(world),
    )


def _lighting(world: WorldConfig) -> Lighting:
    light = MAPS.get(world.map).light(world.weather, world.hour, world.moon)
    if world.wind is not None:
        light = replace(light, windy=1.0)
    light = replace(light, smoke=world.smoke, spray=light.wet if world.spray else 0.0)
    if world.precipitation == 1.0:
        return light
    falls = {name: world.precipitation * getattr(light, name) for name in _FALLING}
    return replace(light, **falls)
