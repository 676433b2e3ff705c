"""The interface of a camera path: what it is told, and the sketch of a flight that it gives."""

from abc import abstractmethod
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]


class FlightScene(NamedTuple):
    """What a path is told of an episode: M samples, `eyas.engine.sim.flights.signals.STEP`
    apart.
    """

    time: Floats
    """Since a step before the start [s], shape (M,)."""
    target: Floats
    """Middle of the target's body, world frame [m], shape (M, 3)."""
    heading: Floats
    """Of the target, counter-clockwise from east, without jumps [rad], shape (M,)."""
    height: float
    """Asked height above the target [m]."""
    pitch: float
    """Asked pitch at which the camera looks down at it [rad]."""
    field_of_view: float
    """Horizontal [rad]."""
    ground: Floats
    """z of the ground below the target [m], shape (M,)."""

    @property
    def distance(self) -> float:
        """Horizontal distance from which the target is seen at the asked height and pitch [m]."""
        return float(min(max(self.height / exact.tan(self.pitch), 2.0), 60.0))

    def beside(self, bearing: float | Floats, distance: float | Floats) -> Floats:
        """Return places around the target, shape (M, 3).

        Args:
            bearing: Direction from the target relative to its heading [rad]; pi is behind.
            distance: Horizontal distance [m].
        """
        return self.around(self.heading + bearing, distance)

    def around(self, direction: float | Floats, distance: float | Floats) -> Floats:
        """Return places around the target at the asked height, shape (M, 3).

        Args:
            direction: From the target, counter-clockwise from east [rad].
            distance: Horizontal [m].
        """
        whole = np.zeros(len(self.time)) + direction
        x = self.target[:, 0] + distance * exact.cos(whole)
        y = self.target[:, 1] + distance * exact.sin(whole)
        return np.stack([x, y, self.target[:, 2] + self.height], axis=1)


class FlightSketch(NamedTuple):
    """A flight as it is meant. The planner smooths it, keeps it above the ground and out of what
    stands around, and lets the camera look away as often as it is asked to.
    """

    place: Floats
    """Where the drone is, world frame [m], shape (M, 3)."""
    look: Floats
    """The point that it looks at, behind the target as a pilot is [m], shape (M, 3)."""
    field_of_view: Floats
    """Horizontal [rad], shape (M,)."""


@runtime_checkable
class CameraPath(Protocol):
    """A camera path. One object sketches many episodes and remembers nothing."""

    in_view: float = 1.0
    """Share of time in which the target is in the picture if the settings ask for none, 0 to 1."""
    searches: bool = False
    """Whether the camera looks around when it looks away, and does so at first."""

    @abstractmethod
    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Return a flight; whatever is random about it is sampled from `rng`."""
        ...
