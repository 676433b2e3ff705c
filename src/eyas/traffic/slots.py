"""Assignment of vehicles to actors."""

from collections.abc import Iterable
from typing import Final

__all__ = ["Slots"]


class Slots:
    """Assignment of an actor to each vehicle; the actor of a vehicle that left is reused.

    Between two vehicles an actor is absent for at least one step, so that no motion connects them.

    Args:
        count: Number of actors, at least the largest number of vehicles at a time.
    """

    def __init__(self, count: int) -> None:
        self.taken: Final[dict[int, int]] = {}
        """Actor of each vehicle in the world."""
        self._free = list(range(count))

    def advance(self, vehicles: Iterable[int]) -> None:
        """Update the assignment to the vehicles that are in the world now, given by number."""
        here = set(vehicles)
        gone = sorted(self.taken.keys() - here)
        # New vehicles first: an actor freed in this step is reused in the next at the earliest.
        for vehicle in sorted(here - self.taken.keys()):
            self.taken[vehicle] = self._free.pop(0)
        for vehicle in gone:
            self._free.append(self.taken.pop(vehicle))
        self._free.sort()
