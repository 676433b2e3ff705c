"""The interface of a target that is a Python class, and the two that need none."""

from abc import abstractmethod
from collections.abc import Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import Scene


class Ride(NamedTuple):
    """Motion of K bodies at one instant: all that their parts may depend on."""

    travelled: NDArray[np.float64]
    """Path length since the motion began [m], shape (K,)."""
    speed: NDArray[np.float64]
    """[m/s], shape (K,)."""
    yaw_rate: NDArray[np.float64]
    """Counter-clockwise [rad/s], shape (K,)."""


@runtime_checkable
class OwnTarget(Protocol):
    """A target: its parts, and their poses.

    The model frame is x forward, y left, z up, with the origin on the ground below the middle.
    """

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width and height [m]."""
        ...

    @abstractmethod
    def parts(self) -> Sequence[Mesh]:
        """Return the P parts, each in a frame of its own."""
        ...

    @abstractmethod
    def pose(self, ride: Ride) -> NDArray[np.float64]:
        """Return rotation and translation of each part in the model frame, shape (K, P, 3, 4)."""
        ...


@runtime_checkable
class MovesItself(Protocol):
    """A target that has a motion of its own, in the place of `behaviour`."""

    @abstractmethod
    def tracks(
        self,
        scene: Scene,  # The map
        time: NDArray[np.float64],  # The times, ten a second [s], shape (S,)
        count: int,  # Number of bodies
        rng: np.random.Generator,  # Source of random numbers; the same seed gives the same ways
    ) -> NDArray[np.float64]:
        """Return x, y [m] and heading [rad] of some bodies at all times, shape (S, count, 3)."""
        ...


class Shaped:
    """A body of one part that does not move in itself, such as a mesh from a file."""

    def __init__(self, size: tuple[float, float, float], levels: tuple[Mesh, ...]) -> None:
        self.size = size
        self.levels = levels

    def parts(self) -> Sequence[Mesh]:
        """Return the mesh."""
        return self.levels[:1]

    def pose(self, ride: Ride) -> NDArray[np.float64]:
        """Return the pose of the part, which is that of the model."""
        return np.tile(np.eye(3, 4), (len(ride.speed), 1, 1, 1))
