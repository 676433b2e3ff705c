"""The interface between the simulation and any traffic."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.state.motion import ActorState, Motion

__all__ = ["TrafficSource"]


class TrafficSource(Protocol):
    """Motion of the actors over time. All worlds share the source; each has its own time.

    An actor never changes its kind (`Motion.kind`), even if it represents several vehicles one
    after another.
    """

    @property
    def motion(self) -> Motion:
        """Motion for kernels to read (`eyas.traffic.interpolation.interpolate_actor`)."""
        ...

    @property
    def live(self) -> bool:
        """Whether the motion is not known in advance, so that `prepare` must come first."""
        ...

    @property
    def actors(self) -> int:
        """Number of actors."""
        ...

    @property
    def duration(self) -> float:
        """Last time of the traffic [s]; the first is 0."""
        ...

    def prepare(self, until: float) -> None:
        """Make the motion known up to a time [s], and for a second more."""
        ...

    def at(self, time: NDArray[np.float64], out: ActorState) -> None:
        """Write all actors of W worlds.

        Args:
            time: Time of each world [s], shape (W,); clamped to 0 and the duration.
            out: Actors of W worlds.
        """
        ...

    def available(self, start: float, end: float) -> NDArray[np.bool_]:
        """Return whether each actor stays in the world from `start` to `end` [s], shape (A,)."""
        ...

    def close(self) -> None:
        """End what drives the traffic; may be called twice."""
        ...
