"""Boxes and cameras of labels, as other tools want them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.exports.label import Label

Floats = NDArray[np.float64]


class Box3D(NamedTuple):
    """A 3D box in the world."""

    centre: Floats  # [m], shape (3,)
    size: Floats  # Length, width, height [m], shape (3,)
    rotation: Floats  # Box to world; columns forward, left, up, shape (3, 3)


def box_of(corners: ArrayLike) -> Box3D:
    """Return the box of eight corners, as in labels: four on the ground, counter-clockwise from the
    right of the tail, and those above them. One that is sheared (a person on a slope) is made
    rectangular.
    """
    points = np.array(corners, np.float64)
    first, ahead, _, left, above, *_ = points.tolist()
    edges = [[a - b for a, b in zip(end, first, strict=True)] for end in (ahead, left, above)]
    (a, b, c), (d, e, f) = _scaled(edges[0]), _scaled(edges[1])
    g, h, i = _scaled([b * f - c * e, c * d - a * f, a * e - b * d])
    size = np.array([_length(edge) for edge in edges])
    return Box3D(points.mean(axis=0), size, np.array([[a, d, g], [b, e, h], [c, f, i]]))


def camera_pose(label: Label) -> tuple[Floats, Floats]:
    """Return the optical centre in the world [m], shape (3,), and the rotation from the axes of
    computer vision (right, down, forward) to the world, shape (3, 3).
    """
    forward, left, up = np.array(label["camera_rotation"], np.float64).T
    rotation = np.column_stack([-left, -up, forward])
    return np.array(label["camera_position"], np.float64), rotation


def quaternion_of(rotation: Floats) -> tuple[float, float, float, float]:
    """Return a rotation, shape (3, 3), as a quaternion w, x, y, z with w at least 0.

    By the largest of its four numbers (Shepperd, 1978), so that nothing small is divided by.
    """
    m = rotation.tolist()  # nine numbers are slow to compute with as arrays
    trace = m[0][0] + m[1][1] + m[2][2]
    squares = [trace, m[0][0], m[1][1], m[2][2]]
    largest = squares.index(max(squares))
    if largest == 0:
        w = _root(1.0 + trace)
        found = (w, (m[2][1] - m[1][2]) / w, (m[0][2] - m[2][0]) / w, (m[1][0] - m[0][1]) / w)
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        length = _root(1.0 + m[i][i] - m[j][j] - m[k][k])
        axes = [0.0, 0.0, 0.0]
        axes[i], axes[j], axes[k] = (
            length,
            (m[j][i] + m[i][j]) / length,
            (m[k][i] + m[i][k]) / length,
        )
        found = ((m[k][j] - m[j][k]) / length, *axes)
    sign = -0.5 if found[0] < 0.0 else 0.5
    w, x, y, z = (sign * each for each in found)
    return w, x, y, z


def _root(value: float) -> float:
    """Return the square root; of what rounding has made negative 0."""
    return math.sqrt(max(value, 0.0))


def _length(vector: list[float]) -> float:
    x, y, z = vector
    return math.sqrt(x * x + y * y + z * z)


def _scaled(vector: list[float]) -> list[float]:
    """Return a vector with a length of 1."""
    length = max(_length(vector), 1e-9)
    return [each / length for each in vector]
