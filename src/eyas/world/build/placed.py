"""Things at their places, as planners list them."""

from typing import NamedTuple

__all__ = ["Placed"]


class Placed(NamedTuple):
    """A copy of a kind of thing."""

    kind: str
    """Name of the kind."""
    x: float
    y: float
    z: float
    """Its foot [m]."""
    turn: float = 0.0
    """Angle, counter-clockwise about z [rad]."""
    scale: float = 1.0
    """Factor on its size."""
