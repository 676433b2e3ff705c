"""Interface to SUMO: a simulation in this process, sampled ten times per second."""

import tempfile
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from eyas.core.errors import ConfigError
from eyas.traffic.config import Demand, TrafficConfig
from eyas.traffic.demand import RoadLinks, Route, without_turnarounds
from eyas.traffic.slots import Slots
from eyas.traffic.sumo_install import import_libsumo

__all__ = ["RATE", "Drive", "Fleet", "drive", "options"]

RATE = 10
"""SUMO's steps and Eyas's samples per second [Hz], as in the original."""

_DRIVERS = {
    # Drivers decide twice a second: smoother, and several times faster.
    Demand.KEEP_ALIVE: ("--default.action-step-length", "0.5"),
    # In each step, as in the original.
    Demand.RESPAWN: (),
}

_OPTIONS = (
    # Never teleport a vehicle out of a jam or an accident.
    *("--time-to-teleport", "-1"),
    *("--collision.action", "none"),
    *("--no-warnings", "true"),
    *("--no-step-log", "true"),
    *("--duration-log.disable", "true"),
)

_IMPATIENCE = {
    Demand.KEEP_ALIVE: "",
    # Cars stand 0.4 % of the time on the original's roads, but 1.1 % on ours if none is impatient.
    # Measured on citystreet: 0.37 % for the shipped groups of 12, 0.37 to 0.68 % for four seeds.
    Demand.RESPAWN: ' impatience="0.12"',
}

TYPE = "eyas"
"""Name of the only vehicle type."""

Fleet = Callable[[RoadLinks], Iterator[tuple[float, Route]]]
"""Function of the roads that yields each vehicle's entry time [s] and route, the earliest first."""


@dataclass(slots=True)
class Drive:
    """SUMO's unprocessed output. S samples, A actors."""

    position: NDArray[np.float64]
    """Middle of the vehicle's length, east and north [m], shape (S, A, 2); 0 while absent."""
    yaw: NDArray[np.float64]
    """Heading [rad], shape (S, A); 0 while absent."""
    present: NDArray[np.bool_]
    """Whether the actor is in the world, shape (S, A)."""
    vehicle_length: float
    """SUMO's length of the vehicle class [m]."""


def options(demand: Demand) -> tuple[str, ...]:
    """Return SUMO's options, except the network, the seed and the step length."""
    # Vehicles move gradually to the next lane instead of jumping 3.5 m in one step.
    return ("--lateral-resolution", "0.8", *_DRIVERS[demand], *_OPTIONS)


def drive(
    network: bytes,
    config: TrafficConfig,
    fleet: Fleet,
    span: tuple[float, float],
    progress: Callable[[float], None] | None,
) -> Drive:
    """Run SUMO and return the poses of its vehicles.

    Args:
        network: SUMO's network file.
        config: Settings of the traffic; the seed is a number.
        fleet: Entry times and routes of the vehicles.
        span: First and last time of the samples [s].
        progress: Called with the completed share, 0 to 1, each simulated second.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs another simulation in this process.
    """
    skipped, steps = round(span[0] * RATE), round(span[1] * RATE)
    shape = (steps - skipped + 1, config.max_vehicles)
    result = Drive(np.zeros((*shape, 2)), np.zeros(shape), np.zeros(shape, np.bool_), 0.0)
    with _simulation(network, config) as sumo:
        result.vehicle_length = sumo.vehicletype.getLength(TYPE)
        links = _read_links(sumo, config.vehicle_type)
        entrance = _Entrance(sumo, fleet(links), config)
        slots = Slots(config.max_vehicles)
        for step in range(1, steps + 1):
            entrance.advance((step - 1) / RATE)
            sumo.simulationStep()
            slots.advance(int(name) for name in sumo.vehicle.getIDList())
            if step >= skipped:
                _read_poses(sumo, slots, result, step - skipped)
            if progress and step % RATE == 0:
                progress(step / steps)
    return result


@contextmanager
def _simulation(network: bytes, config: TrafficConfig) -> Iterator[ModuleType]:
    sumo = import_libsumo()
    if sumo.simulation.isLoaded():
        raise ConfigError(
            "traffic: SUMO already runs in this process (libsumo allows one); close it"
        )
    with tempfile.TemporaryDirectory(prefix="eyas-sumo-") as folder:
        roads, types = Path(folder) / "net.xml", Path(folder) / "types.xml"
        roads.write_bytes(network)
        types.write_text(_type_xml(config))
        files = ("--net-file", str(roads), "--additional-files", str(types))
        clock = ("--step-length", str(1 / RATE), "--seed", str(config.seed))
        sumo.start(["sumo", *files, *clock, *options(config.demand)])
        try:
            yield sumo
        finally:
            sumo.close()


def _type_xml(config: TrafficConfig) -> str:
    # Everything else, including the length, is SUMO's default for the class, as in the original,
    # except that vehicles do not slide sideways while standing, and at most at an angle of 17
    # degrees while driving.
    return (
        f'<additional><vType id="{TYPE}" vClass="{config.vehicle_type}" '
        f'maxSpeed="{config.max_speed}" accel="{config.max_acceleration}" '
        f'decel="{config.max_deceleration}" '
        'lcMaxSpeedLatStanding="0" lcMaxSpeedLatFactor="0.3"'
        f"{_IMPATIENCE[config.demand]}/></additional>"
    )


def _read_links(sumo: ModuleType, vehicle_type: str) -> RoadLinks:
    lanes = {
        edge: [f"{edge}_{index}" for index in range(sumo.edge.getLaneNumber(edge))]
        for edge in sorted(sumo.edge.getIDList())
        if not edge.startswith(":")
    }
    open_lanes = {
        edge: [lane for lane in names if vehicle_type not in sumo.lane.getDisallowed(lane)]
        for edge, names in lanes.items()
    }
    edges = [edge for edge, names in open_lanes.items() if names]
    successors: dict[str, Route] = {}
    for edge in edges:
        targets = {link[0] for lane in open_lanes[edge] for link in sumo.lane.getLinks(lane)}
        following = {sumo.lane.getEdgeID(lane) for lane in targets}
        successors[edge] = tuple(sorted(following & set(edges)))
    length = {edge: sumo.lane.getLength(open_lanes[edge][0]) for edge in edges}
    ends = {
        edge: (sumo.edge.getFromJunction(edge), sumo.edge.getToJunction(edge)) for edge in edges
    }
    return without_turnarounds(RoadLinks(successors, length), ends)


class _Entrance:
    """Adds vehicles to the simulation when they are due and there is room for them."""

    def __init__(
        self, sumo: ModuleType, fleet: Iterator[tuple[float, Route]], config: TrafficConfig
    ) -> None:
        self._sumo = sumo
        self._fleet = fleet
        self._room = config.max_vehicles
        # Vehicles that never leave start anywhere; those of a group start where an edge begins.
        self._place = "random_free" if config.demand is Demand.KEEP_ALIVE else "base"
        self._waiting: deque[tuple[float, Route]] = deque()
        self._entered = 0

    def advance(self, time: float) -> None:
        """Add the vehicles that are due at `time` [s]; those without room wait."""
        self._room += self._sumo.simulation.getArrivedNumber()
        while self._room > 0 and self._next_time() <= time:
            name = str(self._entered)
            self._sumo.route.add(name, self._waiting.popleft()[1])
            self._sumo.vehicle.add(name, name, TYPE, departLane="best", departPos=self._place)
            self._entered += 1
            self._room -= 1

    def _next_time(self) -> float:
        if not self._waiting:
            self._waiting.extend(entry for entry in [next(self._fleet, None)] if entry)
        return self._waiting[0][0] if self._waiting else float("inf")


def _read_poses(sumo: ModuleType, slots: Slots, result: Drive, sample: int) -> None:
    half = 0.5 * result.vehicle_length
    for vehicle, slot in slots.taken.items():
        # SUMO's position is the middle of the front bumper; its angle is clockwise from north.
        east, north = sumo.vehicle.getPosition(str(vehicle))
        yaw = np.radians(90.0 - sumo.vehicle.getAngle(str(vehicle)))
        result.position[sample, slot] = east - half * np.cos(yaw), north - half * np.sin(yaw)
        result.yaw[sample, slot] = yaw
        result.present[sample, slot] = True
