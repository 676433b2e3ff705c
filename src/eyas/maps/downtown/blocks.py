"""City blocks with their buildings: those between streets, those around them, those far away."""

from dataclasses import dataclass

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.lots import turned
from eyas.maps.downtown.lots import Box, Lot, divided, frontage
from eyas.maps.downtown.massing import STOREY, Part, stacked
from eyas.maps.downtown.roads import Cell, Grid
from eyas.maps.downtown.skyline import cores, facade_of, roof_of, storeys
from eyas.maps.plan.plan import BuildingPart

__all__ = ["AVENUE_WALK", "STREET_WALK", "block_lots", "built", "inner_blocks", "outer_lots"]

STREET_WALK, AVENUE_WALK = 5.6, 7.0
"""Width of the pavements along streets and avenues, from the kerb to the fronts [m]."""

_FRONT_DEPTH = 24.0  # Depth of the buildings beyond the outer streets [m]
_HALF_ROAD = 7.0  # Half the width of the outer roads [m]
_PARTY = 0.03  # Half the gap between two neighbours, so that their walls are not in one plane [m]
_BEYOND = 90.0  # Depth of the blocks beyond the grid [m]
_STEPPED = ("facade_brick", "facade_stone", "facade_concrete", "facade_plaster", "facade_old")
"""Facades of buildings that step back."""
_PYRAMID = 0.4  # Share of the stepped towers with a roof that rises to a point


def inner_blocks(grid: Grid, sharp: list[shapely.Polygon]) -> dict[Cell, Box]:
    """Return the ground between the kerbs of each block, in the frame of the grid [m].

    Args:
        grid: The grid.
        sharp: Ground between streets, with sharp corners, world frame [m].
    """
    found: dict[Cell, Box] = {}
    for block in sharp:
        west, south, east, north = turned(block, -grid.turn).bounds
        u, v = (west + east) / 2, (south + north) / 2
        column = int(np.searchsorted(grid.avenues, u)) - 1
        row = int(np.searchsorted(grid.streets, v)) - 1
        found[column, row] = (west, south, east, north)
    return {cell: found[cell] for cell in sorted(found)}


def _in_park(cell: Cell) -> bool:
    """Return whether a place of the grid, also beyond its edge, belongs to the park."""
    column, row = cell
    return row >= 7 and column < 4


def block_lots(block: Box, rng: np.random.Generator) -> list[Lot]:
    """Return the lots of a block between streets."""
    west, south, east, north = block
    inner = (west + AVENUE_WALK, south + STREET_WALK, east - AVENUE_WALK, north - STREET_WALK)
    core = float(cores(np.array([[(west + east) / 2, (south + north) / 2]]))[0])
    return divided(inner, core, rng)


def outer_lots(grid: Grid, rng: np.random.Generator) -> list[Lot]:
    """Return the lots along the far side of the outer streets, which close the canyons."""
    lots: list[Lot] = []
    for cell in _around(grid):
        box = _place(grid, cell)
        sides = [(-1, 0), (1, 0), (0, -1), (0, 1)]
        west, east, south, north = ((cell[0] + i, cell[1] + j) in grid.blocks for i, j in sides)
        if not (west or east or south or north):
            south = True  # at an outer corner of the streets
        for strip in frontage(box, (west, east, south, north), _FRONT_DEPTH):
            lots += _large(strip, rng)
    return lots


def _around(grid: Grid) -> list[Cell]:
    """Return the places around the blocks, without the park."""
    near = {(i + a, j + b) for i, j in grid.blocks for a in (-1, 0, 1) for b in (-1, 0, 1)}
    return sorted(cell for cell in near - grid.blocks if not _in_park(cell))


def _place(grid: Grid, cell: Cell) -> Box:
    """Return the ground of a place without a block, behind the pavements [m]."""
    column, row = cell
    avenues = (grid.avenues[0] - _BEYOND, *grid.avenues, grid.avenues[-1] + _BEYOND)
    streets = (grid.streets[0] - _BEYOND, *grid.streets, grid.streets[-1] + _BEYOND)
    aside, along = _HALF_ROAD + AVENUE_WALK, _HALF_ROAD + STREET_WALK
    return (
        avenues[column + 1] + aside,
        streets[row + 1] + along,
        avenues[column + 2] - aside,
        streets[row + 2] - along,
    )


def _large(strip: Box, rng: np.random.Generator) -> list[Lot]:
    """Return a strip cut across into large lots."""
    west, south, east, north = strip
    long = east - west >= north - south
    length = max(east - west, north - south)
    count = max(round(length / float(rng.uniform(36.0, 52.0))), 1)
    cuts = np.round(np.linspace(0.0, length, count + 1) / 1.5) * 1.5
    cuts[-1] = length
    boxes = [
        (west + a, south, west + b, north) if long else (west, south + a, east, south + b)
        for a, b in zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True)
    ]
    return [
        Lot((w + _PARTY, s + _PARTY, e - _PARTY, n - _PARTY), through=True, rear=0)
        for w, s, e, n in boxes
    ]


@dataclass(frozen=True, slots=True)
class _Look:
    facade: str
    tint: tuple[float, float, float]


def built(grid: Grid, lots: list[Lot], seed: int) -> list[list[BuildingPart]]:
    """Return the parts of the building on each lot, the lowest first, in the world frame."""
    rng = stream(seed, "downtown buildings")
    floors = storeys(lots, rng)
    return [_building(grid, lot, int(count), rng) for lot, count in zip(lots, floors, strict=True)]


def _building(grid: Grid, lot: Lot, floors: int, rng: np.random.Generator) -> list[BuildingPart]:
    facade, tint = facade_of(STOREY * floors, rng)
    stepped = facade in _STEPPED or rng.random() < 0.15
    parts = stacked(lot, floors, stepped, rng)
    cover = roof_of(rng)
    pointed = stepped and len(parts) > 2 and rng.random() < _PYRAMID
    made = []
    for index, part in enumerate(parts):
        last = index == len(parts) - 1
        compact = last and len(part.shape.exterior.coords) == 5 and part.shape.area < 700.0
        made.append(_part(grid, part, _Look(facade, tint), cover, pointed and compact))
    return made


def _part(grid: Grid, part: Part, look: _Look, cover: Material, pointed: bool) -> BuildingPart:
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(part.shape))[:-1]
    return BuildingPart(
        outline=shapely.Polygon(grid.world(ring)),
        bottom=FLOOR_HEIGHT + STOREY * part.low,
        height=STOREY * (part.high - part.low),
        facade=look.facade,
        tint=look.tint,
        roof="pyramid" if pointed else "flat",
        cover=cover,
    )
