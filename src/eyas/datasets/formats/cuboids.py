"""3D boxes of labels, and the camera that sees them, as the formats of driving data want them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.core import exact
from eyas.exports.label import Label

__all__ = ["Cuboid", "camera_axes", "cuboid_of", "quaternion_of"]

Floats = NDArray[np.float64]


class Cuboid(NamedTuple):
    """The 3D box of a moving object, world frame."""

    centre: Floats
    """Middle of the box [m], shape (3,)."""
    foot: Floats
    """Middle of its side on the ground [m], shape (3,)."""
    size: Floats
    """Length, width, height [m], shape (3,)."""
    rotation: Floats
    """Box to world; columns are its forward, left and up axes, shape (3, 3)."""


def cuboid_of(seen: Label) -> Cuboid:
    """Return the box of an entry of `others`: that of its `corners`."""
    corners = np.array(seen["corners"])
    edges = np.stack([corners[1] - corners[0], corners[3] - corners[0], corners[4] - corners[0]])
    size = np.sqrt(np.square(edges).sum(axis=1))
    forward, left = edges[0] / size[0], edges[1] / size[1]
    # People on slopes have sheared boxes, which stand upright; a rotation has no shear.
    rotation = np.stack([forward, left, np.cross(forward, left)], axis=1)
    return Cuboid(corners.mean(axis=0), corners[:4].mean(axis=0), size, rotation)


def camera_axes(rotation: ArrayLike) -> Floats:
    """Return camera to world with the axes of computer vision: columns right, down, forward,
    shape (3, 3).

    Args:
        rotation: Camera to world; columns forward, left, up.
    """
    forward, left, up = np.asarray(rotation, np.float64).T
    return np.stack([-left, -up, forward], axis=1)


def quaternion_of(rotation: Floats) -> list[float]:
    """Return the unit quaternion w, x, y, z of a rotation, with w at least 0.

    Args:
        rotation: A rotation matrix, shape (3, 3).
    """
    # The component that is largest is found first, from the diagonal, for the sake of precision.
    trace = float(np.trace(rotation))
    squares = np.array([trace, *(2.0 * np.diag(rotation) - trace)])
    largest = int(squares.argmax())
    turn = rotation - rotation.T
    both = rotation + rotation.T
    if largest == 0:
        rest = [1.0 + trace, turn[2, 1], turn[0, 2], turn[1, 0]]
    else:
        i, j, k = (largest - 1 + step for step in range(3))
        i, j, k = i % 3, j % 3, k % 3
        rest = [turn[k, j], 0.0, 0.0, 0.0]
        rest[1 + i] = 1.0 + squares[largest]
        rest[1 + j], rest[1 + k] = both[i, j], both[i, k]
    quaternion = np.array(rest) / exact.length(rest)
    return [float(part) for part in (-quaternion if quaternion[0] < 0 else quaternion)]
