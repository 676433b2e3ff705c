"""The frame of a car, on which its body is built: its width and its wheels."""

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Axle:
    """One or two wheels that turn together."""

    x: float  # Position along the vehicle [m]
    track: float  # Distance between the middles of the two wheels [m]; 0 for a single wheel
    width: float  # Width of a tyre [m]
    steered: bool = False  # Whether the wheels steer
    towed: bool = False  # Whether it is a trailer's


class Frame(Protocol):
    """A car without its body; x forward, y left, z up, origin on the ground in the middle."""

    @property
    def width(self) -> float:
        """Overall width, with mirrors [m]."""

    @property
    def wheel_radius(self) -> float:
        """Radius of all wheels [m]."""

    @property
    def axles(self) -> tuple[Axle, ...]:
        """Axles, the front one first."""
