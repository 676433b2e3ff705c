"""The traffic of others as a recording: SUMO drives their vehicles on their network."""

from collections.abc import Callable
from contextlib import closing
from types import ModuleType

import numpy as np

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.scratch import scratch
from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic.config import TrafficConfig, VehicleType
from eyas.engine.traffic.library import CANONICAL_SEED, STANDARD_DURATION
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.record import WARM_UP, as_recording, provenance, resolved
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.sumo import RATE, Drive
from eyas.engine.traffic.sumo_install import import_libsumo
from eyas.lanes import exact

_MOST = 400  # Largest number of vehicles at a time: those beyond it are left out

_AS = {
    VehicleType.PASSENGER: "private passenger taxi hov evehicle ignoring custom1 custom2 vip "
    "authority emergency army",
    VehicleType.BUS: "bus coach",
    VehicleType.TRUCK: "truck delivery",
    VehicleType.TRAILER: "trailer",
    VehicleType.MOTORCYCLE: "motorcycle moped",
}
_CLASSES = {name: shown for shown, names in _AS.items() for name in names.split()}
"""The class that each of SUMO's is shown as; others are left out."""


def record_others(
    graph: RoadGraph,
    demand: bytes,  # Their vehicles, from `demand_of`
    left_out: Callable[[str], None],  # Told of each vehicle that is not shown
    progress: Callable[[float], None],  # Called with the completed share, 0 to 1
) -> TrafficRecording:
    """Return the recording of their traffic that stands for the usual one of a map.

    Raises:
        ConfigError: SUMO refuses the vehicles, or none of them drives.
        MissingExtraError: SUMO is not installed.
    """
    sumo = import_libsumo()
    if sumo.simulation.isLoaded():
        raise ConfigError("traffic: SUMO already runs in this process (libsumo allows one)")
    samples = round(STANDARD_DURATION * RATE) + 1
    config = resolved(TrafficConfig(), CANONICAL_SEED)
    with scratch() as folder:
        roads, routes = folder / "net.xml", folder / "routes.rou.xml"
        roads.write_bytes(graph.finished)
        routes.write_bytes(demand)
        files = ("--net-file", str(roads), "--route-files", str(routes), "--route-steps", "0")
        quiet = ("--no-warnings", "true", "--no-step-log", "true", "--duration-log.disable", "true")
        # Lane changes take time, so that they can be seen; all else is SUMO's default.
        how = ("--lanechange.duration", "2", "--ignore-route-errors", "true",
               "--collision.action", "none")  # fmt: skip
        clock = ("--step-length", str(1 / RATE), "--seed", str(config.seed), "--begin", "0")
        try:
            sumo.start(["sumo", *files, *quiet, *how, *clock])
        except (sumo.TraCIException, sumo.FatalTraCIError, RuntimeError) as error:
            reason = (str(error).strip().splitlines() or ["no reason given"])[0]
            raise ConfigError(f"--routes: SUMO refuses them: {reason}") from None
        with closing(sumo):
            drive = _driven(sumo, samples, left_out, progress)
    if not drive.present.any():
        raise ConfigError("--routes: none of the vehicles drives in the first 22 minutes")
    origin = provenance(graph.map_name, graph.seed, graph_hash(graph), config, STANDARD_DURATION)
    return as_recording(drive, origin)


def _driven(
    sumo: ModuleType,
    samples: int,
    left_out: Callable[[str], None],
    progress: Callable[[float], None],
) -> Drive:
    """Return the poses of all vehicles after the warm-up.

    An actor stands for one vehicle after another, of one class, with a step between them in which
    it is absent, as in `eyas.engine.traffic.sumo.ActorSlots`; here their number is not known.
    """
    skipped = round(WARM_UP * RATE)
    classes: list[VehicleType] = []  # Of the actors
    lengths: list[float] = []
    free: dict[VehicleType, list[int]] = {name: [] for name in VehicleType}
    taken: dict[str, int] = {}  # Actor of each vehicle in the world; -1: it is left out
    room = Drive.create(samples, (VehicleType.PASSENGER,) * _MOST, np.zeros(_MOST))
    for step in range(1, skipped + samples):
        sumo.simulationStep()
        here = sumo.vehicle.getIDList()
        fresh = [name for name in here if name not in taken]
        gone = taken.keys() - set(here)
        if step >= skipped:
            for name in fresh:
                taken[name] = _actor(sumo, name, classes, lengths, free, left_out)
            row = step - skipped
            for name in here:
                if (actor := taken[name]) >= 0:
                    yaw = float(np.radians(90.0 - sumo.vehicle.getAngle(name)))
                    east, north = sumo.vehicle.getPosition(name)
                    half = 0.5 * sumo.vehicle.getLength(name)
                    place = east - half * exact.cos(yaw), north - half * exact.sin(yaw)
                    room.position[row, actor], room.yaw[row, actor] = place, yaw
                    room.present[row, actor] = True
        for name in sorted(gone):
            if (actor := taken.pop(name)) >= 0:
                free[classes[actor]].append(actor)
        if step % RATE == 0:
            progress(step / (skipped + samples))
    count, length = len(classes), np.array(lengths)
    position, yaws = room.position[:, :count], room.yaw[:, :count]
    return Drive(position, yaws, room.present[:, :count], tuple(classes), length)


def _actor(
    sumo: ModuleType,
    name: str,
    classes: list[VehicleType],
    lengths: list[float],
    free: dict[VehicleType, list[int]],
    left_out: Callable[[str], None],
) -> int:
    """Return the actor for a vehicle that has come into the world; -1: it is left out."""
    own = sumo.vehicle.getVehicleClass(name)
    if own not in _CLASSES:
        left_out(f"vehicles of the class {own}")
        return -1
    kind = _CLASSES[own]
    if free[kind]:
        return free[kind].pop(0)
    if len(classes) >= _MOST:
        left_out(f"vehicles beyond {_MOST} at a time")
        return -1
    classes.append(kind)
    lengths.append(min(float(sumo.vehicle.getLength(name)), 30.0))
    return len(classes) - 1
