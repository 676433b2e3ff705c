"""How people, robots and drones move by themselves."""

from enum import StrEnum
from typing import NamedTuple


class Behaviour(StrEnum):
    """How a pedestrian, a robot or a drone moves. None goes through walls, trees or water."""

    POLYLINE = "polyline"
    """Round and round through 2 to 4 random points within 30 m, as the original's pedestrians."""
    PAVEMENT = "pavement"  # Round a block on its pavement, at 1.1 to 1.7 m/s.
    VERGE = "verge"  # The same along the edges of roads, on grass where there is no pavement
    RIDE = "ride"  # Along the kerb, with the traffic, at a cyclist's speed
    WAIT = "wait"  # Stands where one waits: at bus stops, at the tables of cafes
    CROSSING = "crossing"
    """As on pavements, and over the painted crossings, when no recorded vehicle comes."""
    STRAIGHT = "straight"  # Straight on; turns away where something is in the way
    WANDER = "wander"  # As straight, but also turns at random, every few metres
    WEAVE = "weave"  # Straight on in a wave
    STOP = "stop"  # Straight, perhaps a turn, and then stands still for good
    CRUISE = "cruise"  # In the air, from place to place over roofs and trees
    ORBIT = "orbit"  # In the air, round and round a place, above all that stands there
    ROAM = "roam"  # In the air, 2 to 3 m above the ground: between houses, below crowns
    FLEE = "flee"  # As `roam`, nearly twice as fast, with sudden turns


AERIAL = frozenset({Behaviour.CRUISE, Behaviour.ORBIT, Behaviour.ROAM, Behaviour.FLEE})
"""Behaviours of what flies."""


class Habit(NamedTuple):
    """The typical motion of a kind."""

    behaviour: Behaviour
    speed: float  # [m/s]
    acceleration: float  # Also while it brakes [m/s^2]
    yaw_rate: float  # Largest [rad/s]; curves are taken no faster
    radius: float  # Wanted radius of curves [m]
    distance: float = 5.0  # Way to where it stops, if it does [m]
    turn: float = 0.0  # Turn before it stops, counter-clockwise [rad]
