"""How each kind moves by itself."""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

from eyas.behaviours.config import Behaviour

__all__ = ["HABITS", "STROLL", "Habit"]


class Habit(NamedTuple):
    """The typical motion of a kind."""

    behaviour: Behaviour
    speed: float
    """[m/s]"""
    acceleration: float
    """Also while it brakes [m/s^2]."""
    yaw_rate: float
    """Largest [rad/s]; curves are taken no faster."""
    radius: float
    """Wanted radius of curves [m]."""
    distance: float = 5.0
    """Way to where it stops, if it does [m]."""
    turn: float = 0.0
    """Turn before it stops, counter-clockwise [rad]."""


HABITS: Final[Mapping[str, Habit]] = {
    "Pedestrian": Habit(Behaviour.POLYLINE, 2.0, 2.0, 2.5, 1.0),
    "Shrimp": Habit(Behaviour.STOP, 0.26, 0.5, 0.35, 0.75, distance=4.6, turn=math.radians(-75)),
    "Create": Habit(Behaviour.WANDER, 0.5, 1.0, 2.0, 0.2),
    "Sojourner": Habit(Behaviour.STRAIGHT, 0.04, 0.1, 0.2, 0.3),
    "Mantis": Habit(Behaviour.STRAIGHT, 0.55, 0.5, 0.4, 2.0),
    "BB-8": Habit(Behaviour.WEAVE, 1.0, 1.0, 1.5, 0.5),
    "AiboErs7": Habit(Behaviour.STOP, 0.1, 0.3, 0.6, 0.3, distance=2.5),
    "BioloidDog": Habit(Behaviour.STRAIGHT, 0.35, 0.7, 0.8, 0.5),
    "FireBird6": Habit(Behaviour.WANDER, 0.05, 0.1, 0.5, 0.1),
    "Scout": Habit(Behaviour.STRAIGHT, 0.08, 0.2, 0.4, 0.2),
    "GhostDog": Habit(Behaviour.STRAIGHT, 0.8, 1.0, 1.0, 0.8),
    "Hoap2": Habit(Behaviour.STOP, 0.05, 0.1, 0.4, 0.2, distance=1.5),
}
"""By name of the kind. Behaviours and speeds are those of the original's robots with their own
controllers, which were measured or, where they walk, estimated. Those that the original stops at
walls turn away here; Create does not back up first."""

STROLL: Final = (1.1, 1.7)
"""Slowest and fastest walk on a pavement [m/s]."""
