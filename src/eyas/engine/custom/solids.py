"""Triangles of plain solids, their middles at the origin and their axes along z."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.lanes import exact

_ROUND = 24  # Number of sides of what is round

Solid = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Points [m], shape (V, 3), and triangles, shape (T, 3)."""


def box(size: ArrayLike) -> Solid:
    """Return a box from its three extents [m]."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float64)
    quads = np.array(
        [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    )
    half = 0.5 * np.asarray(size, np.float64)
    return signs * half, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def cylinder(radius: float, height: float) -> Solid:
    """Return a cylinder."""
    half = 0.5 * height
    return _turned([(0.0, -half), (radius, -half), (radius, half), (0.0, half)])


def cone(radius: float, height: float) -> Solid:
    """Return a cone that stands on its disc."""
    half = 0.5 * height
    return _turned([(0.0, -half), (radius, -half), (0.0, half)])


def sphere(radius: float) -> Solid:
    """Return a sphere."""
    quarter = 0.5 * math.pi
    return _turned(_ended(_arc(radius, 0.0, -quarter, quarter)))


def capsule(radius: float, height: float) -> Solid:
    """Return a cylinder of a height, with half spheres at its ends."""
    half, quarter = 0.5 * height, 0.5 * math.pi
    low, high = _arc(radius, -half, -quarter, 0.0), _arc(radius, half, 0.0, quarter)
    return _turned(_ended([*low, *high]))


def _turned(profile: Sequence[tuple[float, float]]) -> Solid:
    """Return a solid of revolution about z from radii and heights, the lowest first."""
    angle = 2.0 * math.pi * np.arange(_ROUND) / _ROUND
    ring = np.stack([exact.cos(angle), exact.sin(angle)], axis=-1)
    points = [np.column_stack([r * ring, np.full(_ROUND, z)]) for r, z in profile]
    here = np.arange(_ROUND)
    after = (here + 1) % _ROUND
    faces = []
    for level in range(len(profile) - 1):
        low, high = level * _ROUND, (level + 1) * _ROUND
        if profile[level][0] > 0.0:
            faces.append(np.column_stack([low + here, low + after, high + after]))
        if profile[level + 1][0] > 0.0:
            faces.append(np.column_stack([low + here, high + after, high + here]))
    return np.concatenate(points), np.concatenate(faces)


def _arc(radius: float, middle: float, first: float, last: float) -> list[tuple[float, float]]:
    """Return points of a circle between two heights above its middle, as angles [rad]."""
    angles = np.linspace(first, last, _ROUND // 2 + 1)
    return [(radius * max(exact.cos(a), 0.0), middle + radius * exact.sin(a)) for a in angles]


def _ended(profile: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return [(0.0, profile[0][1]), *profile[1:-1], (0.0, profile[-1][1])]
