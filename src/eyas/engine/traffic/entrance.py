"""The entrance of vehicles into SUMO's simulation, and the actors that show them."""

from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from types import ModuleType
from typing import Final

from eyas.engine.traffic.config import Demand, VehicleType
from eyas.engine.traffic.fleet import Departure


class Entrance:
    """Adds vehicles when they are due and there is room for one more of their class.

    Attributes:
        entered: Class of each vehicle, by its number.

    Args:
        sumo: The running simulation; its types of vehicles have the names of the classes.
        fleet: The vehicles, the earliest first.
        actors: Class of each actor: there is room for so many vehicles.
        demand: When vehicles enter and leave.
    """

    def __init__(
        self,
        sumo: ModuleType,
        fleet: Iterator[Departure],
        actors: Sequence[VehicleType],
        demand: Demand,
    ) -> None:
        self.entered: list[VehicleType] = []
        self._sumo = sumo
        self._fleet = fleet
        self._room = Counter(actors)
        # Vehicles that never leave start anywhere; those of a group start where an edge begins.
        self._place = "random_free" if demand is Demand.KEEP_ALIVE else "base"
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
                name, name, entry.vehicle_type.value, departLane="best", departPos=self._place
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
