"""Recording of traffic that SUMO simulates according to the settings."""

from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version

import numpy as np

from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic.config import Demand, Drivers, Signals, TrafficConfig
from eyas.engine.traffic.cover import Cover, cover_hash
from eyas.engine.traffic.fleet import ROOMS, fleet_of, simplest
from eyas.engine.traffic.network import graph_hash, network_xml
from eyas.engine.traffic.recording import (
    ANGLE_UNIT,
    POSITION_UNIT,
    Provenance,
    TrafficRecording,
    quantised,
    restored,
)
from eyas.engine.traffic.smoothing import held
from eyas.engine.traffic.sumo import RATE, Drive, drive, options
from eyas.engine.traffic.sumo_install import sumo_version
from eyas.lanes import exact

WARM_UP = 60.0
"""Simulated time before the recording begins, in which vehicles spread over the map [s]."""

_JAM = 0.6  # Share of their time standing from which on vehicles are in a jam
_CREEP = 0.1  # Speed of what stands, at most [m/s]

GROUP_SHARE = 3  # Least number of vehicles in a group for each tracker, as in the original


def record(
    map_name: str,
    map_seed: int,
    graph: RoadGraph,  # Roads of the map
    config: TrafficConfig,  # Settings of the traffic
    duration: float,  # Length of the recording [s]
    seed: int,  # Seed of SUMO and of the routes
    progress: Callable[[float], None] | None = None,  # Called with the completed share, 0 to 1
    *,
    cover: Cover = (),  # The stretches of lanes in which drivers hide, where they do
) -> TrafficRecording:
    """Return a new recording, the same for the same arguments and SUMO version.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: The roads have no room for the requested traffic.
    """
    config = resolved(config, seed)
    cover = cover if config.drivers is not Drivers.NORMAL else ()
    origin = provenance(map_name, map_seed, graph_hash(graph), config, duration, cover)
    span = (WARM_UP, WARM_UP + duration)
    town = bool(graph.finished)
    origin = replace(origin, options=options(config, town=town))
    for room in ROOMS if town else (None,):
        fleet = fleet_of(config, span[1], room=room)
        raw = drive(roads_for(config, graph), config, fleet, cover, span, progress, town=town)
        if standing(raw) < _JAM:
            break
    return as_recording(raw, origin)


def standing(raw: Drive) -> float:
    """Return the share of their time in which vehicles stand."""
    moved = (
        np.asarray(exact.hypot(*np.moveaxis(np.diff(raw.position, axis=0), -1, 0))) > _CREEP / RATE
    )
    there = raw.present[1:] & raw.present[:-1]
    return 1.0 - float(moved[there].mean()) if there.any() else 0.0


def roads_for(config: TrafficConfig, graph: RoadGraph) -> bytes:
    """Return SUMO's network file of a map's roads; who evades may turn round at junctions, and
    there are traffic lights if they are to work.

    Raises:
        MissingExtraError: SUMO is not installed.
    """
    return network_xml(
        graph,
        turnarounds=config.drivers is Drivers.EVADING,
        signals=config.signals is Signals.WORKING,
    )


def resolved(
    config: TrafficConfig,  # The user's settings. Where they leave signals open, nobody obeys any
    seed: int,  # Seed of SUMO and of the routes
    trackers: int = 0,  # Number of trackers in a world, which determines the least size of a group
) -> TrafficConfig:
    """Return the settings that affect SUMO, with all values filled in; others at their defaults."""
    seen: dict[str, object] = {
        name: getattr(config, name) for name in ("demand", "drivers", "max_vehicles", "max_speed")
    }
    seen |= {
        "vehicle_type": simplest(config.vehicle_type),
        "max_acceleration": config.max_acceleration,
        "max_deceleration": config.max_deceleration,
        "signals": config.signals or Signals.AMBER,
        "seed": seed,
    }
    if config.demand is Demand.RESPAWN:
        seen |= {
            "group_size": max(config.group_size or GROUP_SHARE, GROUP_SHARE * trackers),
            "group_interval": config.group_interval,
            "route_length": config.route_length,
            "route_count": config.route_count,
        }
    return TrafficConfig.model_validate(seen)


def provenance(
    map_name: str,
    map_seed: int,
    roads: str,  # Hash of its road graph
    config: TrafficConfig,  # Settings from `resolved`
    duration: float,  # Length of the recording [s]
    cover: Cover = (),  # The stretches of lanes in which drivers hide
) -> Provenance:
    """Return the provenance of a recording made by this version.

    Raises:
        MissingExtraError: SUMO is not installed.
    """
    return Provenance(
        map_name=map_name,
        map_seed=map_seed,
        graph_hash=roads,
        config=config,
        duration=duration,
        warm_up=WARM_UP,
        options=options(config),
        cover=cover_hash(cover),
        sumo_version=sumo_version(),
        eyas_version=version("eyas"),
    )


def as_recording(raw: Drive, origin: Provenance) -> TrafficRecording:
    """Return what SUMO has driven as a recording."""
    position = np.zeros_like(raw.position)
    yaw = np.zeros_like(raw.yaw)
    for actor in range(raw.present.shape[1]):
        present = raw.present[:, actor]
        position[:, actor] = held(raw.position[:, actor], present)
        yaw[:, actor] = np.unwrap(held(raw.yaw[:, actor], present))
    return TrafficRecording(
        rate=float(RATE),
        position=restored(quantised(position, POSITION_UNIT), POSITION_UNIT),
        yaw=restored(quantised(yaw, ANGLE_UNIT), ANGLE_UNIT),
        present=raw.present,
        vehicle_types=raw.vehicle_types,
        vehicle_length=raw.vehicle_length,
        provenance=origin,
    )
