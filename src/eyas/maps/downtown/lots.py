"""Lots of a city block: rows of houses back to back, and large buildings from street to street."""

from dataclasses import dataclass

import numpy as np
import shapely

from eyas.lanes import exact

__all__ = ["Lot", "divided", "frontage"]

_THROUGH = (30.0, 54.0)  # Width of a lot that reaches from one street to the next [m]
_STRETCH = (26.0, 58.0)  # Length of a stretch of the block with two rows of lots [m]
_ROW_DEPTH = (0.33, 0.44)  # Depth of a row as a share of the block's; yards lie between two rows
_WIDTH = 23.0  # Median width of a lot in a row [m]
_WIDTHS = (7.5, 40.0)
_SHALLOW = 30.0  # Blocks less deep than this have no yards [m]
_PARTY = 0.06  # Gap between two neighbours, so that their walls are not in one plane [m]

Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Lot:
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


def divided(block: Box, core: float, rng: np.random.Generator) -> list[Lot]:
    """Return the lots of a block.

    Args:
        block: Ground within the building lines, in the frame of the grid [m].
        core: 0 in an old quarter to 1 among the towers, where lots are larger.
        rng: Random numbers of the lots.
    """
    west, south, east, north = block
    lots: list[Lot] = []
    at = west
    while east - at > 7.0:
        through = rng.random() < 0.22 + 0.38 * core or north - south < _SHALLOW
        width = _bays(float(rng.uniform(*(_THROUGH if through else _STRETCH))))
        if east - at - width < 15.0:
            width = east - at
        if through:
            lots.append(Lot(_apart((at, south, at + width, north)), through=True, rear=0))
        else:
            lots += _rows((at, south, at + width, north), core, rng)
        at += width
    return lots


def frontage(block: Box, outer: tuple[bool, bool, bool, bool], depth: float) -> list[Box]:
    """Return strips of a block along those of its sides that have a street.

    Args:
        block: The whole block [m].
        outer: Whether the west, east, south and north side has one.
        depth: Depth of the strips [m].
    """
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


def _rows(stretch: Box, core: float, rng: np.random.Generator) -> list[Lot]:
    """Return two rows of lots, back to back."""
    west, south, east, north = stretch
    lots: list[Lot] = []
    for rear in (1, -1):
        at = west
        while east - at > 0.1:
            wide = _WIDTH * (0.85 + 0.5 * core) * float(exact.exp(exact.normal(rng, 0.0, 0.42)))
            width = _bays(float(np.clip(wide, *_WIDTHS)))
            if east - at - width < 7.0:
                width = east - at
            depth = round(float(rng.uniform(*_ROW_DEPTH)) * (north - south), 1)
            low, high = (south, south + depth) if rear > 0 else (north - depth, north)
            lots.append(Lot(_apart((at, low, at + width, high)), through=False, rear=rear))
            at += width
    return lots


def _apart(box: Box) -> Box:
    shrunk = shapely.box(*box).buffer(-_PARTY / 2, join_style="mitre").bounds
    west, south, east, north = (round(float(value), 3) for value in shrunk)
    return west, south, east, north


def _bays(width: float) -> float:
    """Return a width as a whole number of half window bays."""
    return 1.5 * round(width / 1.5)
