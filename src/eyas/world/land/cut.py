"""Relief cut along a line, so that what covers it ends there and not at edges of triangles."""

import numpy as np
from numpy.typing import NDArray

from eyas.world.build.millimetres import rounded
from eyas.world.land.facets import Points, Relief

__all__ = ["cut"]

_NEAREST = 0.02
"""Least distance of a cut from the end of an edge, as a share of it: no triangle vanishes."""


def cut(ground: Relief, levels: Points, which: int) -> tuple[Relief, Points]:
    """Cut the triangles of a relief where a level passes zero; return it and its points' levels.

    Args:
        ground: The relief.
        levels: L levels of each point, which change linearly over triangles, shape (V, L).
        which: Number of the level.
    """
    above = levels[:, which] >= 0
    count = above[ground.triangles].sum(axis=1)
    some = (count == 1) | (count == 2)
    mixed = ground.triangles[some]
    # The corner that is alone on its side comes first.
    alone = np.argmax(above[mixed] == (count[some] == 1)[:, None], axis=1)
    mixed = np.take_along_axis(mixed, (alone[:, None] + np.arange(3)) % 3, axis=1)
    a, b, c = mixed.T
    edges = np.sort(np.concatenate([mixed[:, :2], mixed[:, ::2]]), axis=1)
    edges, place = np.unique(edges, axis=0, return_inverse=True)
    share = _shares(levels[edges, which])
    p, q = (len(levels) + place.reshape(2, -1)).astype(np.int64)
    pieces = np.concatenate([np.stack(each, axis=1) for each in ((a, p, q), (p, b, c), (p, c, q))])
    points = np.concatenate([ground.points, rounded(_between(ground.points, edges, share))])
    between = _between(levels, edges, share)
    between[:, which] = 0.0
    triangles = np.concatenate([ground.triangles[~some], pieces])
    return Relief(points, triangles), np.concatenate([levels, between])


def _shares(level: Points) -> Points:
    """Return how far along edges a level is zero, from its two ends, shape (E, 2)."""
    share = level[:, 0] / (level[:, 0] - level[:, 1])
    return np.asarray(np.clip(share, _NEAREST, 1.0 - _NEAREST), np.float64)


def _between(values: Points, edges: NDArray[np.int64], share: Points) -> Points:
    """Return values on edges, shape (E, .)."""
    first, last = values[edges[:, 0]], values[edges[:, 1]]
    return np.asarray(first + share[:, None] * (last - first), np.float64)
