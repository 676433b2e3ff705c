"""The tractrix: the heading of what is pulled along a path and does not slide."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import compiled
from eyas.lanes.elementary import atan, atan2, exp, hypot, tan


def follow_headings(
    front: NDArray[np.float64],  # Path of its front [m], shape (S, 2)
    yaw: float,  # Heading at its first point [rad]
    wheelbase: float,  # Distance from the front to the axle that does not slide [m]
) -> NDArray[np.float64]:
    """Return the headings (S,) of a body whose front is pulled along a path [rad]."""
    heading = np.empty(len(front))
    _follow(front, float(yaw), float(wheelbase), heading)
    return heading


@compiled
def _follow(
    front: NDArray[np.float64], yaw: float, wheelbase: float, heading: NDArray[np.float64]
) -> None:
    """Write the heading (S,) of a body whose front is pulled along `front` (S, 2).

    Between two points the pull is straight, and the angle a between heading and pull shrinks:
    tan(a / 2) falls by the factor exp(-distance / wheelbase), the tractrix in closed form.
    """
    heading[0] = yaw
    for sample in range(1, front.shape[0]):
        east = front[sample, 0] - front[sample - 1, 0]
        north = front[sample, 1] - front[sample - 1, 1]
        distance = hypot(east, north)
        if distance > 1e-9:
            angle = atan2(north, east) - yaw
            angle -= 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
            left = 2.0 * atan(tan(0.5 * angle) * exp(-distance / wheelbase))
            yaw += angle - left
        heading[sample] = yaw
