"""What the simulation asks of any traffic."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.state.motion import ActorState, Motion

__all__ = ["TrafficSource"]


class TrafficSource(Protocol):
    """Where the actors are at any time. All worlds share the source; each has its own time.

    An actor keeps its kind (`Motion.kind`) for ever, also where it stands for one vehicle after
    another.
    """

    @property
    def motion(self) -> Motion:
        """What kernels read (`eyas.traffic.interpolation.interpolate_actor`)."""
        ...

    @property
    def actors(self) -> int:
        """Number of actors."""
        ...

    @property
    def duration(self) -> float:
        """Last time that can be asked for [s]; the first is 0."""
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
