"""The ground that a picture covers, for overlays and for inspection."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.state.terrain import Plane, height_over
from eyas.lanes import exact, interpreted

_height_over = interpreted(height_over)


def ground_corners(
    position: ArrayLike,  # Optical centre, world frame [m], shape (3,)
    rotation: ArrayLike,  # Camera to world; columns forward, left, up, shape (3, 3)
    # Half the width and height of a part of the picture, at a depth of 1 m
    half_size: tuple[float, float],
    ground: Plane,  # The ground, approximated by a plane
    reach: float = 1000.0,  # Depth at which the ground is cut off [m]
) -> NDArray[np.float64]:
    """Return the corners of the ground that the middle part of a picture covers.

    Returns:
        Points on the ground [m], counter-clockwise as seen from above, shape (K, 3): upper left,
        lower left, lower right, upper right of the picture; up to one more if a corner is cut off,
        and none if no ground is visible.
    """
    centre, axes = np.asarray(position, np.float64), np.asarray(rotation, np.float64)
    height = _height_over(ground, centre[0], centre[1], centre[2])
    signs = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)])
    corners = np.column_stack([np.ones(4), signs * half_size])
    rays = exact.product(corners, axes.T)
    if height <= 0.0:
        return np.zeros((0, 3))
    # Decrease of each ray's height above the plane per unit of depth.
    falling = ground.rise_east * rays[:, 0] + ground.rise_north * rays[:, 1] - rays[:, 2]
    # Positive where the ray meets the ground before `reach`; linear along the rectangle's sides.
    excess = falling - height / reach
    kept = []
    for i in range(4):
        j = (i + 1) % 4
        if excess[i] >= 0.0:
            kept.append((*rays[i], falling[i]))
        if (excess[i] >= 0.0) != (excess[j] >= 0.0):
            share = excess[i] / (excess[i] - excess[j])
            cut = rays[i] + share * (rays[j] - rays[i])
            kept.append((*cut, falling[i] + share * (falling[j] - falling[i])))
    seen = np.array(kept).reshape(-1, 4)
    flat: NDArray[np.float64] = centre[:2] + seen[:, :2] * (height / seen[:, 3:])
    return on_plane(ground, flat)


def on_plane(ground: Plane, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of a plane at given points east and north, shape (K, 2) [m]."""
    offset = points - (ground.x, ground.y)
    rise = ground.rise_east * offset[:, 0] + ground.rise_north * offset[:, 1]
    return np.column_stack([points, ground.z + rise])
