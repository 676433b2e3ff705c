"""Assignment of vehicles to actors."""

from collections.abc import Mapping, Sequence
from typing import Final

from eyas.traffic.config import VehicleType

__all__ = ["Slots"]


class Slots:
    """Assignment of an actor to each vehicle; the actor of a vehicle that left is reused.

    Between two vehicles an actor is absent for at least one step, so that no motion connects them;
    both are of its class.

    Args:
        actors: Class of each actor; of each class at least the largest number of vehicles at a
            time.
    """

    def __init__(self, actors: Sequence[VehicleType]) -> None:
        self.taken: Final[dict[int, int]] = {}
        """Actor of each vehicle in the world."""
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
