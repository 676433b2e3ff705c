"""Recorded vehicles of others as the traffic of a map: real motion where SUMO's would be."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.installed import installed_version
from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic.config import Mix, TrafficConfig, VehicleType
from eyas.engine.traffic.fleet import simplest
from eyas.engine.traffic.library import CANONICAL_SEED
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.record import as_recording, resolved
from eyas.engine.traffic.recording import Provenance, TrafficRecording
from eyas.engine.traffic.sumo import RATE, Drive
from eyas.engine.world.projection import Projection
from eyas.lanes import exact
from eyas.maps.traffic.tables import TrackTable, Vehicle

_MOST = 400  # Largest number of vehicles at a time
_LONGEST = 7200.0  # Longest recording: twice that of the longest public one [s]
_USUAL = {
    VehicleType.PASSENGER: 4.5,
    VehicleType.BUS: 12.0,
    VehicleType.TRUCK: 9.0,
    VehicleType.TRAILER: 16.5,
    VehicleType.MOTORCYCLE: 2.2,
}
"""Lengths of vehicles whose table has none [m]."""

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Put:
    """Where a table lies on a map."""

    x: float = 0.0  # Where its reference point is put [m]
    y: float = 0.0
    turn: float = 0.0  # By which it is turned about that point [rad]
    reference: tuple[float, float] | None = None
    """That point in metres of the table; None: the middle of all places."""


def put_by_place(table: TrackTable, projection: Projection | None) -> Put | None:
    """Return where a table lies on a map by its place on earth; None: not both are known."""
    if table.origin is None or projection is None:
        return None
    away = math.dist(table.origin, (projection.longitude, projection.latitude))
    if away > 1.0:
        return None
    east, north = projection.metres(table.origin)[0].tolist()
    return Put(east, north, 0.0, (0.0, 0.0))


def traffic_of(table: TrackTable, graph: RoadGraph, put: Put, source: Path) -> TrafficRecording:
    """Return the recording of a table's vehicles on a map.

    A vehicle is there from its first row to its last; an actor stands for several vehicles of one
    class one after another. Times count from the first row of the table.

    Raises:
        ConfigError: They last too long, or too many are there at a time.
    """
    vehicles = table.vehicles
    end = max(float(vehicle.time[-1]) for vehicle in vehicles)
    if end > _LONGEST:
        raise ConfigError(
            f"{source}: it lasts {end:.6g} s; allowed: up to {_LONGEST:g} s: split it, or give the "
            "unit of its times (--columns)"
        )
    samples = math.floor(end * RATE) + 1
    if samples < 2:
        raise ConfigError(f"{source}: it lasts {end:.3g} s; allowed: 0.1 s or more")
    actors, classes = _shared(vehicles, source)
    length = np.array([_length(vehicles, actors, k, kind) for k, kind in enumerate(classes)])
    drive = Drive.create(samples, tuple(classes), length)
    place = np.concatenate([vehicle.place for vehicle in vehicles])
    reference = np.array(put.reference or 0.5 * (place.min(axis=0) + place.max(axis=0)))
    cosine, sine = float(exact.cos(put.turn)), float(exact.sin(put.turn))
    turned = np.array([[cosine, sine], [-sine, cosine]])
    for vehicle, actor in zip(vehicles, actors, strict=True):
        first, last = _span(vehicle)
        time = np.arange(first, last + 1) / RATE
        where = np.stack([np.interp(time, vehicle.time, c) for c in vehicle.place.T], axis=1)
        rows = slice(first, last + 1)
        drive.position[rows, actor] = (where - reference) @ turned + (put.x, put.y)
        drive.yaw[rows, actor] = np.interp(time, vehicle.time, vehicle.yaw) + put.turn
        drive.present[rows, actor] = True
    config = resolved(TrafficConfig(vehicle_type=_mix(classes)), CANONICAL_SEED)
    origin = Provenance(
        map_name=graph.map_name,
        map_seed=graph.seed,
        graph_hash=graph_hash(graph),
        config=config,
        duration=(samples - 1) / RATE,
        warm_up=0.0,
        options=(f"tracks of {source.name}",),
        sumo_version="",
        eyas_version=installed_version(),
    )
    return as_recording(drive, origin)


def _span(vehicle: Vehicle) -> tuple[int, int]:
    """Return the first and the last sample at which a vehicle is there."""
    first = math.ceil(float(vehicle.time[0]) * RATE - 1e-6)
    return first, max(first, math.floor(float(vehicle.time[-1]) * RATE + 1e-6))


def _shared(vehicles: tuple[Vehicle, ...], source: Path) -> tuple[list[int], list[VehicleType]]:
    """Return the actor of each vehicle, and the class of each actor."""
    actors: list[int] = []
    classes: list[VehicleType] = []
    until: list[int] = []  # Last sample of each actor
    for vehicle in vehicles:
        first, last = _span(vehicle)
        free = (
            k
            for k, kind in enumerate(classes)
            # Between two vehicles an actor is absent for at least one sample.
            if kind is vehicle.kind and until[k] + 1 < first
        )
        actor = next(free, len(classes))
        if actor == len(classes):
            if actor == _MOST:
                raise ConfigError(f"{source}: more than {_MOST} vehicles at a time")
            classes.append(vehicle.kind)
            until.append(last)
        until[actor] = last
        actors.append(actor)
    return actors, classes


def _length(
    vehicles: tuple[Vehicle, ...], actors: list[int], actor: int, kind: VehicleType
) -> float:
    """Return the length of an actor: the median of those that it stands for [m]."""
    pairs = zip(vehicles, actors, strict=True)
    known = [vehicle.length for vehicle, own in pairs if own == actor and vehicle.length]
    return float(np.median(known)) if known else _USUAL[kind]


def _mix(classes: list[VehicleType]) -> VehicleType | Mix:
    return simplest(Mix(**{kind.value: float(classes.count(kind)) for kind in VehicleType}))
