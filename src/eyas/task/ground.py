"""The ground that a picture covers, to be drawn over it and to be looked at."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.task.rules import Rules

__all__ = ["ground_corners"]


def ground_corners(
    position: ArrayLike, rotation: ArrayLike, rules: Rules, reach: float = 1000.0
) -> NDArray[np.float64]:
    """Return the corners of the ground that the rewarded part of the picture covers.

    Args:
        position: Optical centre, world frame [m], shape (3,).
        rotation: Camera to world; columns forward, left, up, shape (3, 3).
        rules: `ground`, `half_width`, `half_height` are used.
        reach: Depth at which the ground is cut off, if the picture shows more [m].

    Returns:
        East and north [m], counter-clockwise seen from above, shape (K, 2): upper left, lower
        left, lower right, upper right of the picture; up to one more where a corner is cut off,
        and none if there is no ground to be seen.
    """
    centre, axes = np.asarray(position, np.float64), np.asarray(rotation, np.float64)
    height = centre[2] - rules.ground
    signs = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])
    corners = np.column_stack([np.ones(4), signs * (rules.half_width, rules.half_height)])
    rays = corners @ axes.T
    if height <= 0.0:
        return np.zeros((0, 2))
    # Positive where the ray meets the ground before `reach`; linear along the rectangle's sides.
    excess = -rays[:, 2] - height / reach
    kept = []
    for i in range(4):
        j = (i + 1) % 4
        if excess[i] >= 0.0:
            kept.append(rays[i])
        if (excess[i] >= 0.0) != (excess[j] >= 0.0):
            share = excess[i] / (excess[i] - excess[j])
            kept.append(rays[i] + share * (rays[j] - rays[i]))
    seen = np.array(kept).reshape(-1, 3)
    corners_seen: NDArray[np.float64] = centre[:2] - seen[:, :2] * (height / seen[:, 2:])
    return corners_seen
