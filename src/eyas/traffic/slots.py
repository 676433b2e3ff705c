"""Which actor stands for which vehicle."""

from collections.abc import Iterable
from typing import Final

__all__ = ["Slots"]


class Slots:
    """Gives each vehicle an actor, and the actor of one that left to a later one.

    Between two vehicles an actor is absent for at least one step, so no motion joins them.

    Args:
        count: Number of actors; never fewer than vehicles.
    """

    def __init__(self, count: int) -> None:
        self.taken: Final[dict[int, int]] = {}
        """Actor of each vehicle in the world."""
        self._free = list(range(count))

    def advance(self, vehicles: Iterable[int]) -> None:
        """Take note of the numbers of the vehicles that are in the world now."""
        here = set(vehicles)
        gone = sorted(self.taken.keys() - here)
        # New ones come first: what this step sets free is given away in the next at the earliest.
        for vehicle in sorted(here - self.taken.keys()):
            self.taken[vehicle] = self._free.pop(0)
        for vehicle in gone:
            self._free.append(self.taken.pop(vehicle))
        self._free.sort()
