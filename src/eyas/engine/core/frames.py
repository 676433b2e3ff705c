"""Angles and rotations as scalar kernels. Quaternions are w, x, y, z, body to world."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel

_TURN = 2.0 * math.pi

Quaternion = NDArray[np.float64] | tuple[float, float, float, float]


@kernel
def wrap_angle(angle: float) -> float:
    """Return the same direction within -pi to pi [rad]; angles in that range are unchanged."""
    if -math.pi <= angle <= math.pi:
        return angle
    return angle - _TURN * math.floor((angle + math.pi) / _TURN)


@kernel
def rotate(quaternion: Quaternion, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a body vector in the world frame."""
    w, i, j, k = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    tx, ty, tz = 2.0 * (j * z - k * y), 2.0 * (k * x - i * z), 2.0 * (i * y - j * x)
    return (
        x + w * tx + j * tz - k * ty,
        y + w * ty + k * tx - i * tz,
        z + w * tz + i * ty - j * tx,
    )


@kernel
def rotate_back(quaternion: Quaternion, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a world vector in the body frame."""
    w, i, j, k = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    tx, ty, tz = 2.0 * (k * y - j * z), 2.0 * (i * z - k * x), 2.0 * (j * x - i * y)
    return (
        x + w * tx - j * tz + k * ty,
        y + w * ty - k * tx + i * tz,
        z + w * tz - i * ty + j * tx,
    )
