"""Frames: rotations and translations, K at once, shape (K, 3, 4) [m]."""

import numpy as np
from numpy.typing import NDArray

from eyas.core import exact

__all__ = ["along", "directions", "framed", "level", "places", "turned"]


def level(count: int) -> NDArray[np.float64]:
    """Return frames at the origin, without rotation."""
    return np.tile(np.eye(3, 4), (count, 1, 1))


def places(frames: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points, shape (3,) or (K, 3), given in frames, as seen from outside, shape (K, 3)."""
    return directions(frames, points) + frames[..., 3]


def directions(frames: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors, shape (3,) or (K, 3), given in frames, as seen from outside, (K, 3)."""
    turned_vectors: NDArray[np.float64] = (frames[..., :3] * vectors[..., None, :]).sum(axis=-1)
    return turned_vectors


def turned(
    frames: NDArray[np.float64],
    pivot: NDArray[np.float64],
    roll: NDArray[np.float64],
    pitch: NDArray[np.float64],
    yaw: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return frames at a point of others, turned by roll, then pitch, then yaw [rad], (K,)."""
    cr, sr, cp, sp = exact.cos(roll), exact.sin(roll), exact.cos(pitch), exact.sin(pitch)
    cy, sy = exact.cos(yaw), exact.sin(yaw)
    rotation = np.stack([
        np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=-1),
        np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=-1),
        np.stack([-sp, cp * sr, cp * cr], axis=-1),
    ], axis=-2)  # fmt: skip
    return np.concatenate(
        [exact.product(frames[..., :3], rotation), places(frames, pivot)[..., None]], axis=-1
    )


def along(
    start: NDArray[np.float64], end: NDArray[np.float64], side: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return frames of bones: origin at the start, z away from the end, x towards a side."""
    z = _unit(start - end)
    x = _unit(side - (side * z).sum(axis=-1, keepdims=True) * z)
    return framed(start, x, np.cross(z, x), z)


def framed(
    origin: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    z: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return frames with these axes, each of shape (K, 3)."""
    return np.stack([x, y, z, origin], axis=-1)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    unit: NDArray[np.float64] = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit
