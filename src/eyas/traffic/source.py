"""What the simulation asks of any traffic."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.state.tracker import ActorState

__all__ = ["TrafficSource"]


class TrafficSource(Protocol):
    """Where the actors are at any time. All worlds share the source; each has its own time."""

    @property
    def actors(self) -> int:
        """Number of actors."""
        ...

    @property
    def duration(self) -> float:
        """Last time that can be asked for [s]; the first is 0."""
        ...

    @property
    def table(self) -> NDArray[np.float32]:
        """What `eyas.traffic.replay.interpolate_actor` reads, shape (S, A, 8)."""
        ...

    @property
    def rate(self) -> float:
        """Rows of the table in a second [Hz]."""
        ...

    def at(self, time: NDArray[np.float64], out: ActorState) -> None:
        """Write all actors of W worlds.

        Args:
            time: Time of each world [s], shape (W,); held at 0 and at the duration.
            out: W worlds.
        """
        ...

    def available(self, start: float, end: float) -> NDArray[np.bool_]:
        """Return which actors are in the world, without a break, from `start` to `end` [s].

        Returns:
            shape (A,).
        """
        ...

    def present_until(self, time: float, actor: int) -> float:
        """Return when an actor that is there at `time` leaves [s]; `time` if it is not there.

        An actor that stays to the end gives the duration.
        """
        ...
