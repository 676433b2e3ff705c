"""Interface to SUMO: a simulation in this process, sampled ten times per second."""

from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.scratch import scratch
from eyas.engine.state.motion import Lamp
from eyas.engine.traffic.config import Demand, Drivers, TrafficConfig, VehicleType
from eyas.engine.traffic.cover import Cover
from eyas.engine.traffic.demand import RoadLinks, Route, without_turnarounds
from eyas.engine.traffic.drivers import Manoeuvres
from eyas.engine.traffic.fleet import Departure, Fleet, vehicle_types
from eyas.engine.traffic.sumo_install import import_libsumo
from eyas.lanes import exact

# The entrance of vehicles into SUMO's simulation, and the actors that show them.


class Entrance:
    """Adds vehicles when they are due and there is room for one more of their class.

    Attributes:
        entered: Class of each vehicle, by its number.
    """

    def __init__(
        self,
        # The running simulation; its types of vehicles have the names of the classes
        sumo: ModuleType,
        fleet: Iterator[Departure],  # The vehicles, the earliest first
        actors: Sequence[VehicleType],  # Class of each actor: there is room for so many vehicles
    ) -> None:
        self.entered: list[VehicleType] = []
        self._sumo = sumo
        self._fleet = fleet
        self._room = Counter(actors)
        self._waiting = {name: deque[Departure]() for name in self._room}
        self._next = next(fleet, None)

    def advance(self, time: float) -> None:
        """Add the vehicles that are due at `time` [s]; those without room wait."""
        for name in self._sumo.simulation.getArrivedIDList():
            self._room[self.entered[int(name)]] += 1
        while self._room.total() > 0 and (entry := self._due(time)):
            name = str(len(self.entered))
            self._sumo.route.add(name, entry.route)
            self._sumo.vehicle.add(
                name,
                name,
                entry.vehicle_type.value,
                departLane="best",
                departPos=entry.place,
                departSpeed=entry.speed,
            )
            self.entered.append(entry.vehicle_type)
            self._room[entry.vehicle_type] -= 1

    def _due(self, time: float) -> Departure | None:
        """Return the next vehicle that is due and has room."""
        fronts = [queue[0] for name, queue in self._waiting.items() if queue and self._room[name]]
        if fronts:
            return self._waiting[min(fronts, key=lambda entry: entry.time).vehicle_type].popleft()
        while self._next is not None and self._next.time <= time:
            entry, self._next = self._next, next(self._fleet, None)
            if self._room[entry.vehicle_type]:
                return entry
            self._waiting[entry.vehicle_type].append(entry)
        return None


class ActorSlots:
    """Assignment of an actor to each vehicle; the actor of a vehicle that left is reused.

    Between two vehicles an actor is absent for at least one step, so that no motion connects them;
    both are of its class.

    Args:
        actors: Class of each actor; of each class at least the largest number of vehicles at a
            time.
    """

    def __init__(self, actors: Sequence[VehicleType]) -> None:
        self.taken: Final[dict[int, int]] = {}  # Actor of each vehicle in the world
        self._class = tuple(actors)
        self._free: dict[VehicleType, list[int]] = {name: [] for name in actors}
        for actor, name in enumerate(actors):
            self._free[name].append(actor)

    def advance(self, vehicles: Mapping[int, VehicleType]) -> None:
        """Update the assignment to the vehicles that are in the world now: number and class."""
        gone = sorted(self.taken.keys() - vehicles.keys())
        # New vehicles first: an actor freed in this step is reused in the next at the earliest.
        for vehicle in sorted(vehicles.keys() - self.taken.keys()):
            self.taken[vehicle] = self._free[vehicles[vehicle]].pop(0)
        for vehicle in gone:
            actor = self.taken.pop(vehicle)
            self._free[self._class[actor]].append(actor)
        for free in self._free.values():
            free.sort()


RATE = 10  # SUMO's steps and Eyas's samples per second [Hz], as in the original

_SELDOM = ("--default.action-step-length", "0.5")
"""Drivers decide twice a second: smoother, and several times faster. Without it they decide in each
step, as in the original."""

_SLOW = 10.0
"""Below it, drivers who decide twice a second exceed their maximum until they decide again: of 5
m/s by up to 5 m/s, 0.4 % of the time [m/s]."""

_PATIENT = ("--time-to-teleport", "-1")  # Never teleport a vehicle out of a jam or an accident

_STUCK = ("--time-to-teleport", "150", "--time-to-teleport.remove", "true")
"""In streets that no recipe has drawn, who has stood for so long, longer than any red light, is
taken away [s]: else all of Kingsway, a junction in Manchester, stands after some minutes."""

_OPTIONS = (
    *("--collision.action", "none"),
    *("--no-warnings", "true"),
    *("--no-step-log", "true"),
    *("--duration-log.disable", "true"),
)

_SIGNALS = {1: Lamp.RIGHT, 2: Lamp.LEFT, 8: Lamp.BRAKE}
"""By the bits of SUMO's `vehicle.getSignals`."""

_IMPATIENCE = {
    Demand.KEEP_ALIVE: "",
    # Cars stand 0.4 % of the time on the original's roads, but 1.1 % on ours if none is impatient.
    # Measured on citystreet: 0.37 % for the shipped groups of 12, 0.37 to 0.68 % for four seeds.
    Demand.RESPAWN: ' impatience="0.12"',
}


@dataclass(slots=True)
class Drive:
    """SUMO's unprocessed output. S samples, A actors."""

    position: NDArray[np.float64]
    """Middle of the vehicle's length, east and north [m], shape (S, A, 2); 0 while absent."""
    yaw: NDArray[np.float64]  # Heading [rad], shape (S, A); 0 while absent
    present: NDArray[np.bool_]  # Whether the actor is in the world, shape (S, A)
    vehicle_types: tuple[VehicleType, ...]  # Class of each actor, A
    vehicle_length: NDArray[np.float64]  # SUMO's length of each actor's class [m], shape (A,)

    @classmethod
    def create(
        cls, samples: int, actors: tuple[VehicleType, ...], length: NDArray[np.float64]
    ) -> "Drive":
        """Return samples in which nobody is present."""
        shape = (samples, len(actors))
        return cls(
            np.zeros((*shape, 2)), np.zeros(shape), np.zeros(shape, np.bool_), actors, length
        )


def options(config: TrafficConfig, *, town: bool = False) -> tuple[str, ...]:
    """Return SUMO's options, except the network, the seed and the step length."""
    seldom = config.demand is Demand.KEEP_ALIVE and config.max_speed >= _SLOW
    # Vehicles move gradually to the next lane instead of jumping 3.5 m in one step.
    jams = _STUCK if town else _PATIENT
    return ("--lateral-resolution", "0.8", *(_SELDOM if seldom else ()), *jams, *_OPTIONS)


def drive(
    network: bytes,  # SUMO's network file
    config: TrafficConfig,  # Settings of the traffic; the seed is a number
    fleet: Fleet,  # The vehicles
    cover: Cover,  # The stretches of lanes in which drivers hide
    span: tuple[float, float],  # First and last time of the samples [s]
    # Called with the completed share, 0 to 1, each simulated second
    progress: Callable[[float], None] | None,
    *,
    town: bool = False,  # Whether no recipe has drawn the roads, so that not all may find room
) -> Drive:
    """Run SUMO and return the poses of its vehicles.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs another simulation in this process, or the roads have no room
            for all who never leave: told before the whole time is simulated.
    """
    skipped, steps = round(span[0] * RATE), round(span[1] * RATE)
    with closing(SumoRun(network, config, fleet, cover, town=town)) as run:
        result = Drive.create(steps - skipped + 1, run.actors, run.vehicle_length)
        for step in range(1, steps + 1):
            run.advance()
            if step >= skipped:
                run.read(result, step - skipped)
            needed = not town and config.demand is Demand.KEEP_ALIVE
            if step == skipped and needed and not result.present[0].all():
                raise no_room(result.present[0])
            if progress and step % RATE == 0:
                progress(step / steps)
    return result


def departures_and_types(
    network: bytes, config: TrafficConfig, fleet: Fleet
) -> tuple[str, list[Departure]]:
    """Return the classes of vehicles as SUMO's files tell them, and all vehicles, the earliest
    first; arguments as of `SumoRun`.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs another simulation in this process, or the roads are too few.
    """
    classes = tuple(dict.fromkeys(vehicle_types(config)))
    with _simulation(network, config, classes) as sumo:
        links = {name: _read_links(sumo, name) for name in classes}
        return "".join(_type_xml(name, config) for name in classes), list(fleet(links))


def no_room(present: NDArray[np.bool_]) -> ConfigError:
    """Return the error about vehicles of whom some, shape (A,), have not found room."""
    return ConfigError(
        f"traffic.max_vehicles: {present.size} is too many for the roads of this map; allowed: up "
        f"to about {int(present.sum())}"
    )


class SumoRun:
    """SUMO's simulation in this process: libsumo allows one.

    Attributes:
        actors: Class of each actor.
        vehicle_length: SUMO's length of each actor's class [m], shape (A,).
        sumo: The module libsumo, with the simulation loaded.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: SUMO already runs another simulation in this process, or the roads are too few.
    """

    def __init__(
        self,
        network: bytes,  # SUMO's network file
        config: TrafficConfig,  # Settings of the traffic; the seed is a number
        fleet: Fleet,  # The vehicles
        cover: Cover = (),  # The stretches of lanes in which drivers hide
        *,
        town: bool = False,  # Whether no recipe has drawn the roads
    ) -> None:
        self.actors = vehicle_types(config)
        classes = tuple(dict.fromkeys(self.actors))
        self._slots = ActorSlots(self.actors)
        self._steps = 0
        with ExitStack() as stack:
            self.sumo = stack.enter_context(_simulation(network, config, classes, town=town))
            length = {name: self.sumo.vehicletype.getLength(name.value) for name in classes}
            self.vehicle_length = np.array([length[name] for name in self.actors], np.float64)
            links = {name: _read_links(self.sumo, name) for name in classes}
            self._entrance = Entrance(self.sumo, fleet(links), self.actors)
            usual = config.drivers is Drivers.NORMAL
            self._manoeuvres = None if usual else Manoeuvres(self.sumo, config, cover, links)
            self._stack = stack.pop_all()

    def close(self) -> None:
        """End the simulation; may be called twice."""
        self._stack.close()

    def advance(self) -> None:
        """Simulate one step."""
        self._entrance.advance(self._steps / RATE)
        self.sumo.simulationStep()
        self._steps += 1
        entered = self._entrance.entered
        here = {vehicle: entered[vehicle] for vehicle in map(int, self.sumo.vehicle.getIDList())}
        self._slots.advance(here)
        if self._manoeuvres is not None:
            self._manoeuvres.advance(self._steps / RATE, here)

    def read(self, result: Drive, sample: int) -> None:
        """Write the poses of the vehicles as a sample that is empty so far."""
        for vehicle, actor in self._slots.taken.items():
            # SUMO's position is the middle of the front bumper; its angle is clockwise from north.
            half = 0.5 * result.vehicle_length[actor]
            east, north = self.sumo.vehicle.getPosition(str(vehicle))
            yaw = np.radians(90.0 - self.sumo.vehicle.getAngle(str(vehicle)))
            place = east - half * exact.cos(yaw), north - half * exact.sin(yaw)
            result.position[sample, actor] = place
            result.yaw[sample, actor] = yaw
            result.present[sample, actor] = True

    def read_lamps(self, lamps: NDArray[np.uint8]) -> None:
        """Write what the vehicles signal now, a `Lamp` for each actor, shape (A,)."""
        for vehicle, actor in self._slots.taken.items():
            told = self.sumo.vehicle.getSignals(str(vehicle))
            lit = [lamp for bit, lamp in _SIGNALS.items() if told & bit]
            lamps[actor] = sum(lit)

    def vehicle_of(self, actor: int) -> str | None:
        """Return SUMO's name of the vehicle that an actor represents now; None if absent."""
        taken = self._slots.taken.items()
        return next((str(vehicle) for vehicle, slot in taken if slot == actor), None)


@contextmanager
def _simulation(
    network: bytes, config: TrafficConfig, classes: Sequence[VehicleType], *, town: bool = False
) -> Iterator[ModuleType]:
    sumo = import_libsumo()
    if sumo.simulation.isLoaded():
        raise ConfigError(
            "traffic: SUMO already runs in this process (libsumo allows one); close it"
        )
    with scratch() as folder:
        roads, types = folder / "net.xml", folder / "types.xml"
        roads.write_bytes(network)
        lines = "".join(_type_xml(name, config) for name in classes)
        types.write_text(f"<additional>{lines}</additional>")
        files = ("--net-file", str(roads), "--additional-files", str(types))
        clock = ("--step-length", str(1 / RATE), "--seed", str(config.seed))
        sumo.start(["sumo", *files, *clock, *options(config, town=town)])
        try:
            yield sumo
        finally:
            sumo.close()


def _type_xml(name: VehicleType, config: TrafficConfig) -> str:
    # Everything else, including the length, is SUMO's default for the class, as in the original,
    # except that vehicles do not slide sideways while standing, and at most at an angle of 17
    # degrees while driving.
    return (
        f'<vType id="{name}" vClass="{name}" '
        f'maxSpeed="{config.max_speed}" accel="{config.max_acceleration}" '
        f'decel="{config.max_deceleration}" '
        'lcMaxSpeedLatStanding="0" lcMaxSpeedLatFactor="0.3"'
        f"{_IMPATIENCE[config.demand]}/>"
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
