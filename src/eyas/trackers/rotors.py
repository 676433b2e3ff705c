"""The rotors of the flown drone: how fast they follow what is asked of them."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.clock import PHYSICS_STEP
from eyas.lanes import kernel
from eyas.lanes.elementary import exp
from eyas.trackers.airframe import Airframe
from eyas.trackers.rigid_body import Thrusts

__all__ = ["spun_up"]


@kernel
def spun_up(
    frame: Airframe, rotor: NDArray[np.float64], wanted: Thrusts
) -> tuple[Thrusts, Thrusts, Thrusts]:
    """Return the thrusts at the beginning, in the middle and at the end of a step [N].

    Each rotor's rate approaches the one for its wanted thrust by a low-pass of first order.

    Args:
        frame: Its motors' constants are used.
        rotor: Rates of the rotors [rad/s], shape (4,); updated.
        wanted: Thrusts that the controller asks for [N].
    """
    if frame.motor_time_constant <= 0.0:
        return wanted, wanted, wanted
    left = exp(-0.5 * PHYSICS_STEP / frame.motor_time_constant)
    a = _spun(frame, rotor, 0, wanted[0], left)
    b = _spun(frame, rotor, 1, wanted[1], left)
    c = _spun(frame, rotor, 2, wanted[2], left)
    d = _spun(frame, rotor, 3, wanted[3], left)
    return (a[0], b[0], c[0], d[0]), (a[1], b[1], c[1], d[1]), (a[2], b[2], c[2], d[2])


@kernel
def _spun(
    frame: Airframe, rotor: NDArray[np.float64], index: int, wanted: float, left: float
) -> tuple[float, float, float]:
    """Return the thrusts of one rotor as in `spun_up`; `left` is the gap after half a step."""
    goal = math.sqrt(wanted / frame.thrust_constant)
    gap = rotor[index] - goal
    middle, end = goal + left * gap, goal + left * left * gap
    first, rotor[index] = rotor[index], end
    factor = frame.thrust_constant
    return factor * first * first, factor * middle * middle, factor * end * end
