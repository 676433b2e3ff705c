"""Pose of a body that keeps an offset from its target."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.frames import wrap_angle
from eyas.lanes import kernel
from eyas.lanes.elementary import sin_cos

__all__ = ["offset_pose"]


@kernel(inline=True)
def offset_pose(
    target: NDArray[np.float64], target_yaw: float, offset: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Return x, y, z [m] and yaw [rad] of a body at an offset from a target.

    Args:
        target: Reference point of the target, world frame [m], shape (3,).
        target_yaw: Heading of the target [rad].
        offset: Forward, left, up in the body's heading frame [m], and its heading relative to the
            target's [rad], shape (4,).
    """
    yaw = target_yaw + offset[3]
    sine, cosine = sin_cos(yaw)
    x = target[0] + cosine * offset[0] - sine * offset[1]
    y = target[1] + sine * offset[0] + cosine * offset[1]
    return x, y, target[2] + offset[2], wrap_angle(yaw)
