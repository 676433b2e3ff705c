"""Ground areas and heights of the buildings of a city, drawn to the original's statistics."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

FLOOR = 3.0  # Height of a storey [m]

TOWER_SHARE = 0.22  # Share of the buildings that stand on another one

# Quantiles of the original's street city: share of buildings and ground area [m^2] or height [m].
_AREA = ((0.0, 9), (0.04, 60), (0.25, 445), (0.5, 915), (0.75, 2015), (0.95, 4800), (1.0, 9141))
_HEIGHT = ((0.0, 5.6), (0.25, 12), (0.5, 30), (0.61, 48), (0.75, 57), (0.867, 76),
           (0.9, 104), (0.95, 152), (1.0, 228))  # fmt: skip


def ground_areas(count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return the ground areas of `count` buildings [m^2], shape (count,)."""
    return _stratified(_AREA, count, rng)


def storeys(
    side: NDArray[np.float64],  # Square root of the footprints' areas [m], shape (B,)
    base: NDArray[np.int64],
    rng: np.random.Generator,
) -> NDArray[np.int64]:
    """Return the number of storeys of each building, counted from the ground.

    The drawn heights are assigned at random, with better chances for wide buildings and towers; a
    building that carries a tower is low, and none is more than 7 times as high as wide.
    """
    is_tower = base >= 0
    carries = np.isin(np.arange(len(side)), base[is_tower])
    ticket = np.minimum(side, 45.0) * rng.uniform(0.35, 1.0, len(side))
    ticket = np.where(is_tower, ticket + 40.0, np.where(carries, ticket - 40.0, ticket))
    height = np.empty(len(side))
    height[np.argsort(ticket, kind="stable")] = np.sort(_stratified(_HEIGHT, len(side), rng))
    floors = np.clip(np.round(height / FLOOR), 2, np.maximum(2, np.floor(7 * side / FLOOR)))
    floors[carries] = np.minimum(floors[carries], rng.integers(2, 8, int(carries.sum())))
    floors[is_tower] = np.maximum(floors[is_tower], floors[base[is_tower]] + 3)
    return np.asarray(floors, np.int64)


def evenly(names: Sequence[str], count: int, rng: np.random.Generator) -> list[str]:
    """Return `count` of the names in random order, each about as often as the others."""
    return [names[i % len(names)] for i in rng.permutation(count)]


def _stratified(
    points: Sequence[tuple[float, float]], count: int, rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return one value from each of `count` equal shares of a distribution, shuffled."""
    share, value = np.array(points).T
    at = (np.arange(count) + rng.uniform(0.2, 0.8, count)) / max(count, 1)
    drawn = exact.exp(np.interp(at, share, exact.log(value)))
    # Logarithms differ from processor to processor in their last bits.
    return np.asarray(rng.permutation(np.round(drawn, 3)), np.float64)
