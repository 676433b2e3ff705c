"""The entrance of vehicles into SUMO's simulation."""

from collections import Counter, deque
from collections.abc import Iterator, Sequence
from types import ModuleType

from eyas.traffic.config import Demand, VehicleType
from eyas.traffic.fleet import Entry

__all__ = ["Entrance"]


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
        fleet: Iterator[Entry],
        actors: Sequence[VehicleType],
        demand: Demand,
    ) -> None:
        self.entered: list[VehicleType] = []
        self._sumo = sumo
        self._fleet = fleet
        self._room = Counter(actors)
        # Vehicles that never leave start anywhere; those of a group start where an edge begins.
        self._place = "random_free" if demand is Demand.KEEP_ALIVE else "base"
        self._waiting = {name: deque[Entry]() for name in self._room}
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

    def _due(self, time: float) -> Entry | None:
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
