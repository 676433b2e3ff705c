"""Rising ground of a plan: its relief, and what covers it."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.world.build.millimetres import rounded
from eyas.lanes import exact
from eyas.maps.land.facets import Points, Relief, relief
from eyas.maps.land.mounds import Mound, highest
from eyas.maps.plan import plan

__all__ = ["kinds_of", "relief_of", "snow_over"]

_TOP = 45.0  # Height from which the last cover lies [m]
_SNOW_LINE = 4.0  # Height from which snow lies on a white mound [m]
_MARGIN = 1.0  # How much higher than a mound beside it a white one is there [m]
_WAVE = 1.5  # By how much the line rises and falls [m]


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


def snow_over(ground: Relief, dunes: Sequence[Mound], white: set[int]) -> Points:
    """Return how far the points of a relief lie above the line where snow begins, shape (V,) [m].

    Snow lies where a white dune is the highest, above a line that rises and falls along its foot.
    """
    points = ground.points
    own, _ = highest([dunes[index] for index in sorted(white)], points[:, :2])
    others, _ = highest([d for index, d in enumerate(dunes) if index not in white], points[:, :2])
    over = points[:, 2] + _WAVE * exact.sin(0.11 * points[:, 0]) * exact.sin(0.13 * points[:, 1])
    return rounded(np.minimum(own - others - _MARGIN, over - _SNOW_LINE))
