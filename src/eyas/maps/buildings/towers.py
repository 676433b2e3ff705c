"""Towers and houses of a city block: its lots, and the prisms that a building on a lot is made of.

Lots lie in rows of houses back to back, or reach from street to street; buildings are plain
houses, stepped blocks of stone, or towers on broad feet.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.lanes import exact
from eyas.maps.buildings.lots import largest

_THROUGH = (30.0, 54.0)  # Width of a lot that reaches from one street to the next [m]
_STRETCH = (26.0, 58.0)  # Length of a stretch of the block with two rows of lots [m]
_ROW_DEPTH = (0.33, 0.44)  # Depth of a row as a share of the block's; yards lie between two rows
_WIDTH = 23.0  # Median width of a lot in a row [m]
_WIDTHS = (7.5, 40.0)
_SHALLOW = 30.0  # Blocks less deep than this have no yards [m]
_PARTY = 0.06  # Gap between two neighbours, so that their walls are not in one plane [m]

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class TowerLot:
    """The ground of one building in the frame of the grid."""

    box: Box  # West, south, east, north [m]
    through: bool  # Whether it reaches from street to street
    rear: int  # Side with a yard: 1 north, -1 south, 0 none

    @property
    def area(self) -> float:
        """Ground area [m^2]."""
        west, south, east, north = self.box
        return (east - west) * (north - south)

    @property
    def centre(self) -> tuple[float, float]:
        """Middle [m]."""
        west, south, east, north = self.box
        return (west + east) / 2, (south + north) / 2


def divided(
    block: Box,  # Ground within the building lines, in the frame of the grid [m]
    core: float,  # 0 in an old quarter to 1 among the towers, where lots are larger
    rng: np.random.Generator,
) -> list[TowerLot]:
    """Return the lots of a block."""
    west, south, east, north = block
    lots: list[TowerLot] = []
    at = west
    while east - at > 7.0:
        through = rng.random() < 0.22 + 0.38 * core or north - south < _SHALLOW
        width = _bays(float(rng.uniform(*(_THROUGH if through else _STRETCH))))
        if east - at - width < 15.0:
            width = east - at
        if through:
            lots.append(TowerLot(_apart((at, south, at + width, north)), through=True, rear=0))
        else:
            lots += _rows((at, south, at + width, north), core, rng)
        at += width
    return lots


def frontage(
    block: Box,  # The whole block [m]
    outer: tuple[bool, bool, bool, bool],  # Whether the west, east, south and north side has one
    depth: float,  # Depth of the strips [m]
) -> list[Box]:
    """Return strips of a block along those of its sides that have a street."""
    west, south, east, north = block
    depth = min(depth, 0.46 * (north - south))
    strips: list[Box] = []
    if outer[2]:
        strips.append((west, south, east, south + depth))
    if outer[3]:
        strips.append((west, north - depth, east, north))
    low, high = south + depth * outer[2], north - depth * outer[3]
    side = min(1.2 * depth, 0.46 * (east - west))
    if outer[0] and high - low > 20.0:
        strips.append((west, low, west + side, high))
    if outer[1] and high - low > 20.0:
        strips.append((east - side, low, east, high))
    return strips


def _rows(stretch: Box, core: float, rng: np.random.Generator) -> list[TowerLot]:
    """Return two rows of lots, back to back."""
    west, south, east, north = stretch
    lots: list[TowerLot] = []
    for rear in (1, -1):
        at = west
        while east - at > 0.1:
            wide = _WIDTH * (0.85 + 0.5 * core) * float(exact.exp(exact.normal(rng, 0.0, 0.42)))
            width = _bays(float(np.clip(wide, *_WIDTHS)))
            if east - at - width < 7.0:
                width = east - at
            depth = round(float(rng.uniform(*_ROW_DEPTH)) * (north - south), 1)
            low, high = (south, south + depth) if rear > 0 else (north - depth, north)
            lots.append(TowerLot(_apart((at, low, at + width, high)), through=False, rear=rear))
            at += width
    return lots


def _apart(box: Box) -> Box:
    shrunk = shapely.box(*box).buffer(-_PARTY / 2, join_style="mitre").bounds
    west, south, east, north = (round(float(value), 3) for value in shrunk)
    return west, south, east, north


def _bays(width: float) -> float:
    """Return a width as a whole number of half window bays."""
    return 1.5 * round(width / 1.5)


STOREY = 3.0  # Height of a storey [m]

_PLAIN = 9  # Up to so many storeys a house has no set-backs
_NARROWEST = 8.0  # Side below which a part is not stepped back further [m]
_SLENDER = 13.0  # Greatest height of a tower as a multiple of the shorter side of its shaft


@dataclass(frozen=True, slots=True)
class TowerPart:
    """A prism of a building."""

    shape: shapely.Polygon  # Outline in the frame of the grid [m]
    low: int  # Storeys below it
    high: int  # Storeys up to its roof


def stacked(
    lot: TowerLot, storeys: int, stepped: bool, rng: np.random.Generator
) -> list[TowerPart]:
    """Return the parts of a building, each within the one below it.

    Args:
        storeys: Storeys of the whole building.
        stepped: Whether it steps back like old towers of stone; otherwise a shaft rises at once.
    """
    if storeys <= _PLAIN:
        return [TowerPart(_house(lot, rng), 0, storeys)]
    return _steps(lot, storeys, rng) if stepped else _tower(lot, storeys, rng)


def _house(lot: TowerLot, rng: np.random.Generator) -> shapely.Polygon:
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


def _steps(lot: TowerLot, storeys: int, rng: np.random.Generator) -> list[TowerPart]:
    """Return a building that steps back above each cornice, as the law of 1916 asked for."""
    steps = min(2 + storeys // 13, 6)
    first = rng.uniform(0.45, 0.72) if storeys < 30 else rng.uniform(0.22, 0.4)
    cuts = np.round(
        storeys * (first + (1 - first) * exact.power(np.linspace(0, 1, steps), 0.8))
    ).astype(int)
    cuts[-1] = storeys
    parts: list[TowerPart] = []
    box, low = lot.box, 0
    for high in np.unique(np.maximum(cuts, 2)).tolist():
        parts.append(TowerPart(_house(lot, rng) if low == 0 else shapely.box(*box), low, high))
        deeper = _inset(box, rng.uniform(1.5, 4.6, 4) * (1.0 if low else 1.25))
        slim = min(deeper[2] - deeper[0], deeper[3] - deeper[1])
        if slim < _NARROWEST or not parts[0].shape.contains(shapely.box(*deeper)):
            parts[-1] = TowerPart(parts[-1].shape, low, max(high, round(0.8 * storeys)))
            break
        box, low = deeper, high
    return parts


def _tower(lot: TowerLot, storeys: int, rng: np.random.Generator) -> list[TowerPart]:
    """Return a shaft on a broad foot, with a narrower top."""
    west, south, east, north = lot.box
    foot = int(rng.integers(2, 8))
    least = max(12.0, STOREY * storeys / _SLENDER)
    spare = np.repeat(np.maximum(np.array([east - west, north - south]) - least, 0.0) / 2, 2)
    margin = np.minimum(rng.uniform(2.0, 9.0, 4), spare)
    slab = _inset(lot.box, np.asarray(np.round(margin, 1), np.float64))
    shaft = _cut(slab, rng)
    if storeys < 18 or margin.max() < 1.0:
        return [TowerPart(shapely.box(*lot.box), 0, storeys)]
    parts = [TowerPart(shapely.box(*lot.box), 0, foot)]
    top = storeys - int(rng.integers(2, max(4, storeys // 9)))
    crown = _inset(slab, rng.uniform(2.0, 5.0, 4))
    if min(crown[2] - crown[0], crown[3] - crown[1]) < _NARROWEST or rng.random() < 0.25:
        return [*parts, TowerPart(shaft, foot, storeys)]
    if storeys > 45 and rng.random() < 0.6:
        waist = int(storeys * rng.uniform(0.55, 0.75))
        parts.append(TowerPart(shaft, foot, waist))
        slab = _inset(slab, rng.uniform(0.0, 4.0, 4))
        parts.append(TowerPart(_within(_cut(slab, rng), parts), waist, top))
        crown = _inset(slab, rng.uniform(1.5, 4.0, 4))
    else:
        parts.append(TowerPart(shaft, foot, top))
    return [*parts, TowerPart(_within(shapely.box(*crown), parts), top, storeys)]


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


def _within(shape: shapely.Polygon, parts: Sequence[TowerPart]) -> shapely.Polygon:
    """Return a shape without what would hang over the last of the parts."""
    return largest(shapely.intersection(shape, parts[-1].shape))


def _inset(box: Box, by: NDArray[np.float64]) -> Box:
    west, south, east, north = box
    sides = (west + by[0], south + by[2], east - by[1], north - by[3])
    low_u, low_v, high_u, high_v = (round(float(value), 2) for value in sides)
    return low_u, low_v, high_u, high_v
