"""The interface between the simulation and any traffic."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.motion import ActorState, Motion


class Stays(NamedTuple):
    """When actors that may be targets are in the world; an actor may come and go several times."""

    actor: NDArray[np.int64]  # The actor, shape (S,)
    enters: NDArray[np.float64]  # Time of its first sample there [s], shape (S,)
    leaves: NDArray[np.float64]
    """Last time at which it is there [s]; infinite if that is not known yet, shape (S,)."""
    known: float
    """Episodes that begin before this time [s] need no more to be known: `prepare` would do
    nothing."""


class TrafficSource(Protocol):
    """Motion of the actors over time. All worlds share the source; each has its own time.

    An actor never changes its kind (`Motion.kind`), even if it represents several vehicles one
    after another.
    """

    @property
    def motion(self) -> Motion:
        """Motion for kernels to read (`eyas.engine.traffic.interpolation.interpolate_actor`)."""
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

    def stays(self) -> Stays:
        """Return when actors that may be targets are in the world, as far as it is known."""
        ...

    def close(self) -> None:
        """End what drives the traffic; may be called twice."""
        ...
