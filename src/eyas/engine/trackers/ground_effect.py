"""Ground effect: near the ground rotors push more."""

import math

from eyas.engine.trackers.airframe import Airframe
from eyas.lanes import kernel

ROTOR_HEIGHT = 0.02305
"""Height of the rotors over the body's middle, as in the original's `M100` [m]."""

_NEAREST = 0.5  # Least height over the ground for which the formula is made, in radii of a rotor


@kernel
def ground_effect(frame: Airframe, radius: float, height: float) -> float:
    """Return the thrust of four rotors over the ground, over that of the same far above it.

    Sanchez-Cuevas, Heredia and Ollero, "Characterization of the aerodynamic ground effect and its
    influence in multirotor control" (International Journal of Aerospace Engineering, 2017): the
    image of a source for each rotor below the ground. Their term for a wide body, which they fit to
    one, is left out; for one rotor it is the formula of Cheeseman and Bennett (1955).

    Args:
        frame: The distance of its rotors is used.
        radius: Of a rotor [m].
        height: Of the rotors over the ground [m].
    """
    z = max(height, _NEAREST * radius)
    beside = 4.0 * frame.arm * frame.arm + 4.0 * z * z
    across = 8.0 * frame.arm * frame.arm + 4.0 * z * z
    own = radius / (4.0 * z)
    square = radius * radius * z
    less = own * own + square / (beside * math.sqrt(beside))
    less += 0.5 * square / (across * math.sqrt(across))
    return 1.0 / (1.0 - less)
