"""Layout of downtown: its lots and buildings, and where the elevated railway runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.roads.areas import blocks, corridors, road_area
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings.looks import Tint, wall_tint
from eyas.maps.buildings.lots import turned
from eyas.maps.buildings.towers import STOREY, Box, TowerLot, TowerPart, divided, frontage, stacked
from eyas.maps.downtown.roads import Cell, Grid, grid
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.things.railway import BESIDE, SECTION, Viaduct

_HEIGHT = ((0.0, 6.0), (0.25, 19.0), (0.5, 28.0), (0.75, 58.0), (0.88, 105.0),
           (0.95, 190.0), (0.985, 290.0), (1.0, 436.0))  # fmt: skip
"""Share of the buildings and height [m]: quantiles of the original's downtown."""
_CORES = ((-60.0, -40.0, 190.0), (290.0, 90.0, 150.0))
"""Quarters of towers: u, v and reach of each [m]."""
_SLENDER = 12.0  # Greatest height as a multiple of the shorter side of the lot

# order: bytes of plans depend on it, which draw an index of these tables by their shares
_OLD = (("facade_brick", 0.38), ("facade_stone", 0.18), ("facade_concrete", 0.12),
        ("facade_red_white", 0.09), ("facade_old", 0.10), ("facade_plaster", 0.13))  # fmt: skip
_MIDDLE = (("facade_brick", 0.20), ("facade_stone", 0.22), ("facade_concrete", 0.22),
           ("facade_office", 0.14), ("facade_highrise", 0.12), ("facade_bands", 0.05),
           ("facade_glass", 0.05))  # fmt: skip
_TALL = (("facade_glass", 0.36), ("facade_highrise", 0.20), ("facade_stone", 0.14),
         ("facade_office", 0.16), ("facade_concrete", 0.14))  # fmt: skip
"""Facades and their shares for low, middle and high buildings."""

_PANES: tuple[Tint, ...] = (
    (1.0, 1.0, 1.0),
    (0.80, 0.92, 1.0),
    (0.74, 0.90, 0.84),
    (0.52, 0.55, 0.60),
    (1.0, 0.88, 0.72),
)
"""Tints of glass towers: clear, blue, green, black, bronze."""

_ROOFS: tuple[tuple[float, str, Tint], ...] = (
    (0.30, "bitumen", (0.97, 0.97, 0.97)),
    (0.12, "roof_gravel", (0.92, 0.91, 0.90)),
    (0.11, "roof_membrane", (0.88, 0.89, 0.90)),
    (0.27, "roof_terrace", (1.0, 0.96, 0.94)),
    (0.20, "roof_terrace", (0.86, 0.84, 0.84)),
)
"""Share, texture and tint: a little more than half are grey, the others orange."""


def cores(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how much places (u, v) belong to a quarter of towers, 0 to 1, shape (K,)."""
    near = [
        exact.exp(-(np.square(places[:, 0] - u) + np.square(places[:, 1] - v)) / np.square(reach))
        for u, v, reach in _CORES
    ]
    # Exponentials differ from processor to processor in their last bits.
    return np.asarray(np.round(np.max(near, axis=0), 6), np.float64)


def storeys(lots: Sequence[TowerLot], rng: np.random.Generator) -> NDArray[np.int64]:
    """Return the number of storeys of the building on each lot, shape (K,)."""
    share, value = np.array(_HEIGHT).T
    at = (np.arange(len(lots)) + rng.uniform(0.2, 0.8, len(lots))) / max(len(lots), 1)
    heights = np.round(exact.exp(np.interp(at, share, exact.log(value))), 3)
    core = cores(np.array([lot.centre for lot in lots]))
    area = np.array([lot.area for lot in lots])
    wide = np.round(np.sqrt(np.minimum(area, 2400.0)) / 49.0, 6)
    ticket = wide + 0.45 * core + rng.uniform(0.0, 0.42, len(lots))
    made = np.empty(len(lots))
    made[np.argsort(ticket, kind="stable")] = heights
    slim = np.array([min(lot.box[2] - lot.box[0], lot.box[3] - lot.box[1]) for lot in lots])
    made = np.minimum(made, _SLENDER * slim)
    return np.maximum(np.round(made / STOREY), 2).astype(np.int64)


def facade_of(
    height: float,  # Height of the building [m]
    rng: np.random.Generator,
) -> tuple[str, Tint]:
    """Return the facade of a building and the factor on its colour."""
    table = _OLD if height < 36.0 else _MIDDLE if height < 110.0 else _TALL
    shares = np.array([odds for _, odds in table])
    kind = table[int(rng.choice(len(table), p=shares / shares.sum()))][0]
    if kind in ("facade_glass", "facade_office") and rng.random() < 0.75:
        return kind, _PANES[int(rng.integers(len(_PANES)))]
    return kind, wall_tint(rng)


def roof_of(rng: np.random.Generator) -> Material:
    """Return the cover of a building's flat roofs."""
    shares = np.array([share for share, _, _ in _ROOFS])
    _, name, (red, green, blue) = _ROOFS[int(rng.choice(len(_ROOFS), p=shares / shares.sum()))]
    age = float(rng.uniform(0.86, 1.0))
    return material(name, (red * age, green * age, blue * age))


STREET_WALK, AVENUE_WALK = 5.6, 7.0
"""Width of the pavements along streets and avenues, from the kerb to the fronts [m]."""

_FRONT_DEPTH = 24.0  # Depth of the buildings beyond the outer streets [m]
_HALF_ROAD = 7.0  # Half the width of the outer roads [m]
_PARTY = 0.03  # Half the gap between two neighbours, so that their walls are not in one plane [m]
_BEYOND = 90.0  # Depth of the blocks beyond the grid [m]
_STEPPED = ("facade_brick", "facade_stone", "facade_concrete", "facade_plaster", "facade_old")
"""Facades of buildings that step back."""
_PYRAMID = 0.4  # Share of the stepped towers with a roof that rises to a point


def inner_blocks(
    grid: Grid,
    sharp: list[shapely.Polygon],  # Ground between streets, with sharp corners, world frame [m]
) -> dict[Cell, Box]:
    """Return the ground between the kerbs of each block, in the frame of the grid [m]."""
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


def block_lots(block: Box, rng: np.random.Generator) -> list[TowerLot]:
    """Return the lots of a block between streets."""
    west, south, east, north = block
    inner = (west + AVENUE_WALK, south + STREET_WALK, east - AVENUE_WALK, north - STREET_WALK)
    core = float(cores(np.array([[(west + east) / 2, (south + north) / 2]]))[0])
    return divided(inner, core, rng)


def outer_lots(grid: Grid, rng: np.random.Generator) -> list[TowerLot]:
    """Return the lots along the far side of the outer streets, which close the canyons."""
    lots: list[TowerLot] = []
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


def _large(strip: Box, rng: np.random.Generator) -> list[TowerLot]:
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
        TowerLot((w + _PARTY, s + _PARTY, e - _PARTY, n - _PARTY), through=True, rear=0)
        for w, s, e, n in boxes
    ]


@dataclass(frozen=True, slots=True)
class _Look:
    facade: str
    tint: tuple[float, float, float]


def built(grid: Grid, lots: list[TowerLot], seed: int) -> list[list[BuildingPart]]:
    """Return the parts of the building on each lot, the lowest first, in the world frame."""
    rng = stream(seed, "downtown buildings")
    floors = storeys(lots, rng)
    return [_building(grid, lot, int(count), rng) for lot, count in zip(lots, floors, strict=True)]


def _building(
    grid: Grid, lot: TowerLot, floors: int, rng: np.random.Generator
) -> list[BuildingPart]:
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


def _part(grid: Grid, part: TowerPart, look: _Look, cover: Material, pointed: bool) -> BuildingPart:
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


_COLUMN = 4  # The column of blocks in whose middle it runs
_STOP = 4  # The street over which the station lies
_REACH = 1248.0  # Distance from the middle of the floor to either end, beyond its edges [m]
_BESIDE_ROAD = 3.2  # Distance from a kerb to the columns beside it: behind parked cars [m]
_BETWEEN = 15.0  # Greatest distance between columns off the roads [m]
_NARROWEST = 8.0  # Narrower rests of lots that it cuts stay empty [m]

Points = NDArray[np.float64]


def make_viaduct(network: RoadNetwork, grid: Grid) -> Viaduct:
    """Return the railway of a city."""
    u = _middle(grid)
    start, end = grid.world(np.array([[u, -_REACH], [u, _REACH]]))
    line = shapely.LineString([start, end])
    length = 2 * _REACH
    crossed = shapely.get_parts(shapely.intersection(line, road_area(network)))
    origin = shapely.Point(start)
    ends = np.sort([[shapely.distance(origin, shapely.Point(p)) for p in part.coords]
                    for part in crossed], axis=1)  # fmt: skip
    ends = np.round(ends[np.argsort(ends[:, 0], kind="stable")], 3)
    beside = (ends + np.array([-_BESIDE_ROAD, _BESIDE_ROAD])).ravel()
    stops = [SECTION / 2, *beside.tolist(), length - SECTION / 2]
    bents = [stops[0]]
    for k, (low, high) in enumerate(pairwise(stops)):
        parts = 1 if k % 2 else max(int(np.ceil((high - low) / _BETWEEN)), 1)
        bents += np.round(np.linspace(low, high, parts + 1)[1:], 3).tolist()
    over = ends.mean(axis=1)
    return Viaduct(
        start=start,
        along=np.array([-exact.sin(grid.turn), exact.cos(grid.turn)]),
        length=length,
        bents=np.array(bents),
        over=over,
        station=float(over[_STOP]),
    )


def _middle(grid: Grid) -> float:
    return round((grid.avenues[_COLUMN] + grid.avenues[_COLUMN + 1]) / 2, 3)


def cut(lots: list[TowerLot], grid: Grid) -> list[TowerLot]:
    """Return lots without the ground of the railway: what it crosses becomes two lots or one."""
    low, high = _middle(grid) - BESIDE, _middle(grid) + BESIDE
    made: list[TowerLot] = []
    for lot in lots:
        west, south, east, north = lot.box
        if east <= low or west >= high:
            made.append(lot)
            continue
        rests: list[Box] = [(west, south, low, north), (high, south, east, north)]
        made += [
            TowerLot(box, lot.through, lot.rear) for box in rests if box[2] - box[0] >= _NARROWEST
        ]
    return made


FLOOR = (2000.0, 1500.0)  # Extent of the floor [m]

EXTENT = shapely.box(*(-0.5 * np.array(FLOOR)), *(0.5 * np.array(FLOOR)))  # The floor


@dataclass(frozen=True, slots=True)
class DowntownLayout:
    """Positions in plan view."""

    grid: Grid  # The grid of the streets
    roads: shapely.Geometry  # Asphalt of the streets [m]
    courts: list[shapely.Geometry]  # Ground of each block within its building lines [m]
    lots: list[TowerLot]  # Ground of each building, in the frame of the grid
    buildings: list[list[BuildingPart]]  # Parts of the building on each lot, the lowest first
    viaduct: Viaduct  # The elevated railway

    @property
    def footprints(self) -> list[Points]:
        """Corners of the buildings on the ground [m]."""
        return [parts[0].footprint for parts in self.buildings]


def lay_out(network: RoadNetwork, seed: int) -> DowntownLayout:
    """Return the layout of a city."""
    plan = grid(seed)
    closed, _ = blocks(corridors(network), EXTENT)
    cells = inner_blocks(plan, closed)
    rng = stream(seed, "downtown lots")
    lots = [lot for block in cells.values() for lot in block_lots(block, rng)]
    lots = cut(lots + outer_lots(plan, rng), plan)
    courts = [
        turned(
            shapely.box(w + AVENUE_WALK, s + STREET_WALK, e - AVENUE_WALK, n - STREET_WALK),
            plan.turn,
        )
        for w, s, e, n in cells.values()
    ]
    return DowntownLayout(
        grid=plan,
        roads=road_area(network),
        courts=courts,
        lots=lots,
        buildings=built(plan, lots, seed),
        viaduct=make_viaduct(network, plan),
    )
