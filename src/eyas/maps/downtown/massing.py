"""Shapes of buildings: plain houses, stepped blocks of stone, towers on broad feet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.lanes import exact
from eyas.maps.buildings.lots import largest
from eyas.maps.downtown.lots import Box, Lot

__all__ = ["STOREY", "Part", "stacked"]

STOREY = 3.0  # Height of a storey [m]

_PLAIN = 9  # Up to so many storeys a house has no set-backs
_NARROWEST = 8.0  # Side below which a part is not stepped back further [m]
_SLENDER = 13.0  # Greatest height of a tower as a multiple of the shorter side of its shaft


@dataclass(frozen=True, slots=True)
class Part:
    """A prism of a building."""

    shape: shapely.Polygon  # Outline in the frame of the grid [m]
    low: int  # Storeys below it
    high: int  # Storeys up to its roof


def stacked(lot: Lot, storeys: int, stepped: bool, rng: np.random.Generator) -> list[Part]:
    """Return the parts of a building, each within the one below it.

    Args:
        lot: Its ground.
        storeys: Storeys of the whole building.
        stepped: Whether it steps back like old towers of stone; otherwise a shaft rises at once.
        rng: Random numbers of the buildings.
    """
    if storeys <= _PLAIN:
        return [Part(_house(lot, rng), 0, storeys)]
    return _steps(lot, storeys, rng) if stepped else _tower(lot, storeys, rng)


def _house(lot: Lot, rng: np.random.Generator) -> shapely.Polygon:
    """Return the outline of a house; deep ones have a light well at the back."""
    west, south, east, north = lot.box
    shape = shapely.box(*lot.box)
    width, depth = east - west, north - south
    if lot.rear and width > 10.0 and depth > 15.0 and rng.random() < 0.55:
        deep, wide = depth * rng.uniform(0.22, 0.45), width * rng.uniform(0.28, 0.5)
        # Past a side rather than along it: rounding would leave a sliver there.
        at = float(rng.choice([west - 1.0, east - wide + 1.0, west + (width - wide) / 2]))
        low = north - deep if lot.rear > 0 else south - 1.0
        high = north + 1.0 if lot.rear > 0 else south + deep
        shape = largest(shapely.difference(shape, shapely.box(at, low, at + wide, high)))
    return shape


def _steps(lot: Lot, storeys: int, rng: np.random.Generator) -> list[Part]:
    """Return a building that steps back above each cornice, as the law of 1916 asked for."""
    steps = min(2 + storeys // 13, 6)
    first = rng.uniform(0.45, 0.72) if storeys < 30 else rng.uniform(0.22, 0.4)
    cuts = np.round(
        storeys * (first + (1 - first) * exact.power(np.linspace(0, 1, steps), 0.8))
    ).astype(int)
    cuts[-1] = storeys
    parts: list[Part] = []
    box, low = lot.box, 0
    for high in np.unique(np.maximum(cuts, 2)).tolist():
        parts.append(Part(_house(lot, rng) if low == 0 else shapely.box(*box), low, high))
        deeper = _inset(box, rng.uniform(1.5, 4.6, 4) * (1.0 if low else 1.25))
        slim = min(deeper[2] - deeper[0], deeper[3] - deeper[1])
        if slim < _NARROWEST or not parts[0].shape.contains(shapely.box(*deeper)):
            parts[-1] = Part(parts[-1].shape, low, max(high, round(0.8 * storeys)))
            break
        box, low = deeper, high
    return parts


def _tower(lot: Lot, storeys: int, rng: np.random.Generator) -> list[Part]:
    """Return a shaft on a broad foot, with a narrower top."""
    west, south, east, north = lot.box
    foot = int(rng.integers(2, 8))
    least = max(12.0, STOREY * storeys / _SLENDER)
    spare = np.repeat(np.maximum(np.array([east - west, north - south]) - least, 0.0) / 2, 2)
    margin = np.minimum(rng.uniform(2.0, 9.0, 4), spare)
    slab = _inset(lot.box, np.asarray(np.round(margin, 1), np.float64))
    shaft = _cut(slab, rng)
    if storeys < 18 or margin.max() < 1.0:
        return [Part(shapely.box(*lot.box), 0, storeys)]
    parts = [Part(shapely.box(*lot.box), 0, foot)]
    top = storeys - int(rng.integers(2, max(4, storeys // 9)))
    crown = _inset(slab, rng.uniform(2.0, 5.0, 4))
    if min(crown[2] - crown[0], crown[3] - crown[1]) < _NARROWEST or rng.random() < 0.25:
        return [*parts, Part(shaft, foot, storeys)]
    if storeys > 45 and rng.random() < 0.6:
        waist = int(storeys * rng.uniform(0.55, 0.75))
        parts.append(Part(shaft, foot, waist))
        slab = _inset(slab, rng.uniform(0.0, 4.0, 4))
        parts.append(Part(_within(_cut(slab, rng), parts), waist, top))
        crown = _inset(slab, rng.uniform(1.5, 4.0, 4))
    else:
        parts.append(Part(shaft, foot, top))
    return [*parts, Part(_within(shapely.box(*crown), parts), top, storeys)]


def _cut(box: Box, rng: np.random.Generator) -> shapely.Polygon:
    """Return the outline of a shaft: a rectangle, or one with its corners cut or notched."""
    shape = shapely.box(*box)
    side = min(box[2] - box[0], box[3] - box[1])
    choice = rng.random()
    if side < 14.0 or choice < 0.55:
        return shape
    if choice < 0.75:
        bevel = round(float(rng.uniform(0.12, 0.27)) * side, 1)
        inner = shapely.buffer(shape, -bevel, join_style="mitre")
        return largest(shapely.buffer(inner, bevel, join_style="bevel", quad_segs=1))
    notch = round(float(rng.uniform(0.1, 0.2)) * side, 1)
    corners = shapely.get_coordinates(shape)[:4]
    squares = [shapely.box(x - notch, y - notch, x + notch, y + notch) for x, y in corners]
    return largest(shapely.difference(shape, shapely.union_all(squares)))


def _within(shape: shapely.Polygon, parts: Sequence[Part]) -> shapely.Polygon:
    """Return a shape without what would hang over the last of the parts."""
    return largest(shapely.intersection(shape, parts[-1].shape))


def _inset(box: Box, by: NDArray[np.float64]) -> Box:
    west, south, east, north = box
    sides = (west + by[0], south + by[2], east - by[1], north - by[3])
    low_u, low_v, high_u, high_v = (round(float(value), 2) for value in sides)
    return low_u, low_v, high_u, high_v
