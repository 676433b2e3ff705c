"""State of the traffic, as arrays."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

__all__ = ["ActorState"]


@dataclass(slots=True)
class ActorState:
    """A actors in each of W worlds. Reference point as in `TargetState.position`, z = 0."""

    position: NDArray[np.float64]
    """East and north [m], shape (W, A, 2)."""
    yaw: NDArray[np.float64]
    """[rad], shape (W, A)."""
    speed: NDArray[np.float64]
    """[m/s], shape (W, A)."""
    yaw_rate: NDArray[np.float64]
    """[rad/s], shape (W, A)."""
    travelled: NDArray[np.float64]
    """Path length since the recording began, which turns the wheels [m], shape (W, A)."""
    present: NDArray[np.bool_]
    """Whether the actor is in the world, shape (W, A)."""

    @classmethod
    def create(cls, worlds: int, actors: int) -> "ActorState":
        """Return `actors` actors at the origin in each of `worlds` worlds."""
        plane = (worlds, actors)
        return cls(
            position=np.zeros((*plane, 2)),
            yaw=np.zeros(plane),
            speed=np.zeros(plane),
            yaw_rate=np.zeros(plane),
            travelled=np.zeros(plane),
            present=np.zeros(plane, np.bool_),
        )

    def first(self, worlds: int) -> "ActorState":
        """Return the actors of the first worlds; the arrays are shared."""
        return ActorState(*(getattr(self, array.name)[:worlds] for array in fields(self)))
