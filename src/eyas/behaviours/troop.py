"""What is asked for: how many of a kind, where, when, and how they move."""

from typing import NamedTuple

from eyas.behaviours.lives import Lives
from eyas.core.variation import Variation
from eyas.targets.habit import Behaviour, Habit

__all__ = ["Clock", "Troop"]


class Clock(NamedTuple):
    """The instants of a motion."""

    samples: int
    rate: float
    """[Hz]"""


class Troop(NamedTuple):
    """Some of one kind."""

    kind: str
    """Name of the kind."""
    breadth: float
    """Diameter of the circle in which it fits [m]."""
    behaviour: Behaviour | None
    """None: that of the habit."""
    habit: Habit
    """How they move."""
    lives: Lives
    offset: Variation
    """Where it begins: distance from the middle of the road [m]."""
    setting: str
    """Setting of the number, for messages."""
    chosen_by: str = "custom.behaviour"
    """Setting of the behaviour, for messages."""
