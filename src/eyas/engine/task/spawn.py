"""Start of an episode, placed relative to a target."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.frames import wrap_angle
from eyas.lanes import exact, interpreted, kernel
from eyas.lanes.elementary import tan

_wrapped = interpreted(wrap_angle)


@dataclass(frozen=True, slots=True)
class StartValues:
    """A sampled start, relative to the target; the fields of `StartConfig`."""

    pitch: float  # SampledDelay camera pitch, positive down [rad], before the gimbal limits it
    height: float  # [m]
    direction: float  # [rad]
    horizontal_bias: float  # [m]
    vertical_bias: float  # [m]


@kernel
def start_distance(pitch: float, height: float, vertical_bias: float, ahead: float) -> float:
    """Return how far ahead of the target's reference point the tracker starts [m].

    It starts so far behind the target that, without biases, its optical axis meets the target's
    centre. As in the original, this neglects the place of the camera in the body and the height of
    the reference point, and applies `ahead` along the tracker's heading.

    Args:
        pitch: Of the camera, positive down [rad].
        height: [m]
        vertical_bias: [m]
        ahead: See `start_pose` [m].
    """
    return ahead + vertical_bias - tan(abs(0.5 * math.pi - pitch)) * height


_distance = interpreted(start_distance)


def start_pose(
    start: StartValues, target_position: ArrayLike, target_yaw: float, ahead: float
) -> tuple[NDArray[np.float64], float]:
    """Return the start position of the tracker's body [m], shape (3,), and its yaw [rad].

    See `start_distance`.

    Args:
        start: The sampled start.
        target_position: Reference point of the target [m], shape (3,).
        target_yaw: Heading of the target [rad].
        ahead: Distance of the target's middle ahead of its reference point, see
            `eyas.engine.targets.kind.Kind` [m].
    """
    yaw = target_yaw + start.direction
    forward = _distance(start.pitch, start.height, start.vertical_bias, ahead)
    left = start.horizontal_bias
    east = exact.cos(yaw) * forward - exact.sin(yaw) * left
    north = exact.sin(yaw) * forward + exact.cos(yaw) * left
    offset = np.array([east, north, start.height])
    return np.asarray(target_position, np.float64) + offset, _wrapped(yaw)
