"""Trucks with a trailer: the trailer is pulled by the fifth wheel and swings behind its truck.

The front bumper follows SUMO's lane, the truck's rear axle the bumper, and the trailer's axles the
fifth wheel, each as a tractrix: no wheel slides. With kingpin and rear axle at one place that is
dγ/ds = κ - sin(γ) / L for the angle γ between the two, the curvature κ of the truck's path and the
trailer's length L from kingpin to axles. Both axes meet at the kingpin, so this angle, the *hitch*,
and the chord from bumper to tail tell where both are. The chord is the heading of the actor.
"""

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.traffic.tractrix import follow_headings
from eyas.lanes import exact, kernel
from eyas.lanes.elementary import sin_cos

BUMPER_AHEAD = 4.75  # From the kingpin to the front bumper [m]

TAIL_BEHIND = 9.55  # From the kingpin to the end of the trailer [m]

REAR_AXLE = 0.3  # From the kingpin back to the truck's rear axle [m]

AXLES_BEHIND = 7.1  # From the kingpin to the middle of the trailer's axles [m]

_REFERENCE = 1.0  # From the middle of the chord to the actor's reference point ahead of it [m]

_SHORTEST_LEAD = 0.1  # [m]

Floats = NDArray[np.float64]
Number = TypeVar("Number", float, NDArray[np.floating])


class Links(NamedTuple):
    """Headings of what follows each other [rad]."""

    lead: float  # From the front bumper to SUMO's front, which is a little ahead of it
    truck: float
    trailer: float

    @classmethod
    def straight(cls, yaw: float) -> "Links":
        """Return those of a vehicle that drives straight on."""
        return cls(yaw, yaw, yaw)

    @classmethod
    def of(cls, front: Floats, centre: Floats, heading: float, hitch: float) -> "Links":
        """Return those of a pose; arguments as of `tow` and from `Articulated`, at one instant."""
        bend, half = _chord(hitch)
        truck = heading - bend
        ahead = half - _REFERENCE
        east, north = front - centre - ahead * np.array([exact.cos(heading), exact.sin(heading)])
        turn = math.remainder(exact.atan2(north, east) - truck, 2.0 * math.pi)
        return cls(truck + turn, truck, truck + hitch)


class Articulated(NamedTuple):
    """Motion of a truck with its trailer at S instants."""

    centre: Floats
    """Reference point, 1 m ahead of the middle between bumper and tail [m], shape (S, 2)."""
    heading: Floats  # Direction from the tail to the bumper, without jumps [rad], shape (S,)
    hitch: Floats  # Heading of the trailer less that of the truck [rad], shape (S,)


def tow(
    front: Floats,  # Path of SUMO's front [m], shape (S, 2)
    length: float,  # SUMO's length of the vehicle [m]; its middle is the reference point
    links: Links,  # Headings at the first point
) -> Articulated:
    """Return the motion of a truck whose front is pulled along a path."""
    ahead = 0.5 * (BUMPER_AHEAD + TAIL_BEHIND) - _REFERENCE
    lead = max(0.5 * length - ahead, _SHORTEST_LEAD)
    bumper = front - lead * _directions(follow_headings(front, links.lead, lead))
    truck = follow_headings(bumper, links.truck, BUMPER_AHEAD + REAR_AXLE)
    kingpin = bumper - BUMPER_AHEAD * _directions(truck)
    trailer = follow_headings(kingpin, links.trailer, AXLES_BEHIND)
    tail, hitch = kingpin - TAIL_BEHIND * _directions(trailer), trailer - truck
    along = BUMPER_AHEAD + TAIL_BEHIND * exact.cos(hitch)
    heading = truck + exact.atan2(TAIL_BEHIND * exact.sin(hitch), along)
    return Articulated(0.5 * (bumper + tail) + _REFERENCE * _directions(heading), heading, hitch)


@kernel
def folded(hitch: float, towed: int) -> tuple[float, float, float, float]:
    """Return where the truck or trailer has carried the frame of the straight vehicle: x, y [m],
    cosine and sine of its heading, in the frame of the whole. The origin of both is the middle of
    the chord.

    Args:
        hitch: Angle between the two [rad].
        towed: 1 for the trailer, 0 for the truck.
    """
    s, c = sin_cos(hitch)
    return folded_by(s, c, towed)


@kernel
def folded_by(s: Number, c: Number, towed: int) -> tuple[Number, Number, Number, Number]:
    """Return the same for the sine and cosine of the angle; arrays only where it is interpreted."""
    along, aside = BUMPER_AHEAD + TAIL_BEHIND * c, TAIL_BEHIND * s
    chord = np.sqrt(along * along + aside * aside)
    ahead, left = along / chord, -aside / chord
    turned_ahead, turned_left = ahead * c - left * s, left * c + ahead * s
    half = 0.5 * (BUMPER_AHEAD if towed == 1 else TAIL_BEHIND)
    x, y = half * (turned_ahead - ahead), half * (turned_left - left)
    return (x, y, turned_ahead, turned_left) if towed == 1 else (x, y, ahead, left)


def _chord(hitch: float) -> tuple[float, float]:
    """Return the angle from the truck to the chord [rad], and half the chord's length [m]."""
    along = BUMPER_AHEAD + TAIL_BEHIND * exact.cos(hitch)
    aside = TAIL_BEHIND * exact.sin(hitch)
    return exact.atan2(aside, along), 0.5 * exact.hypot(along, aside)


def _directions(heading: Floats) -> Floats:
    return np.stack([exact.cos(heading), exact.sin(heading)], axis=-1)
