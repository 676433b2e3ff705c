"""Rising ground of a plan: its relief, and what covers it."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.world.build.millimetres import rounded
from eyas.world.land.facets import Points, Relief, relief
from eyas.world.land.mounds import Mound, highest
from eyas.world.plan import plan

__all__ = ["cut", "kinds_of", "relief_of", "snowed"]

_NEAREST = 0.02
"""Least distance of a cut from the end of an edge, as a share of it: no triangle vanishes."""
_TOP = 45.0
"""Height from which the last cover lies [m]."""
_SNOW_LINES = (2.5, 6.0)
"""Heights from which thin and closed snow lies on a white mound [m]."""
_MARGINS = (0.0, 2.5)
"""How much higher than a mound beside it a white one is there [m]."""
_WAVE = 1.5
"""By how much the lines rise and fall [m]."""


def relief_of(layer: plan.Hills, seed: int) -> Relief:
    """Return the triangles of rising ground."""
    rng = layer.chance.generator(seed)

    def heights(points: Points) -> Points:
        smooth, _ = highest(layer.mounds, points)
        if not layer.rough:
            return smooth
        return np.round(smooth * (1.0 + rng.uniform(-layer.rough, layer.rough, len(points))), 3)

    return relief(heights, layer.half, layer.spacing, layer.flat or shapely.Polygon(), rng)


def kinds_of(ground: Relief, covers: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Return which cover each triangle has: higher up mostly a later one."""
    height = ground.corners[..., 2].mean(axis=1)
    level = np.clip(height / _TOP, 0.0, 1.0) * (covers - 2) + rng.uniform(0.0, 1.8, len(height))
    return np.asarray(np.clip(level.astype(np.intp), 0, covers - 1), np.intp)


def snowed(
    ground_: Relief, dunes: Sequence[Mound], white: set[int]
) -> tuple[Relief, NDArray[np.intp]]:
    """Cut the relief where snow begins; return it and what covers each triangle: sand, thin, snow.

    Snow lies where a white dune is the highest, above lines that rise and fall along its foot.
    """
    points = ground_.points
    own, _ = highest([dunes[index] for index in sorted(white)], points[:, :2])
    others, _ = highest([d for index, d in enumerate(dunes) if index not in white], points[:, :2])
    over = points[:, 2] + _WAVE * exact.sin(0.11 * points[:, 0]) * exact.sin(0.13 * points[:, 1])
    thin, closed_ = (
        np.minimum(own - others - margin, over - line)
        for line, margin in zip(_SNOW_LINES, _MARGINS, strict=True)
    )
    levels = rounded(np.column_stack([thin, closed_]))
    for which in range(2):
        ground_, levels = cut(ground_, levels, which)
    return ground_, (levels[ground_.triangles].mean(axis=1) > 0).sum(axis=1)


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
