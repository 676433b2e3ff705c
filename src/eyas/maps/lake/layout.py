"""Plan of the lake district: what each block holds, the lakes, the houses."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import FACADES, material
from eyas.engine.world.build.millimetres import rounded, unit
from eyas.engine.world.roads.areas import blocks, road_area, streets
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.lake.roads import COLUMNS, ROWS, Lattice, lattice
from eyas.maps.land.ground import blob
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.plants.forest import SPECIES
from eyas.maps.street.car_parks import CarPark, place_car_parks

FLOOR = (5000.0, 5000.0)  # Extent of the floor, as in the original [m]
EXTENT = shapely.box(-FLOOR[0] / 2, -FLOOR[1] / 2, FLOOR[0] / 2, FLOOR[1] / 2)

MIXED = len(SPECIES)  # Number of the strip with trees of all kinds

_POND_WIDTH, _POND_LENGTH = 35.0, (150.0, 180.0)
_ODD_PONDS = ((60.0, 35.0), (70.0, 90.0), (110.0, 60.0), (160.0, 70.0))
"""Width and length of the ponds outside the grid [m]."""
_STRIP, _WIDE_STRIP = (40.0, 190.0), (80.0, 180.0)
_LAKES = ((-1030.0, -420.0, 252.0), (-960.0, 700.0, 288.0), (-330.0, -1180.0, 314.0),
          (690.0, -1150.0, 329.0), (1830.0, 260.0, 769.0))  # fmt: skip
"""Middle and mean radius of the five lakes: 0.20 to 1.86 km^2, as in the original [m]."""
_HOUSES = 50
_CAR_PARKS = ((185.0, 51.0),)

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Strip:
    """A strip of forest."""

    area: shapely.Polygon  # [m]
    kind: int  # Index into `SPECIES`, or `MIXED`


@dataclass(frozen=True, slots=True)
class LakeLayout:
    """Positions in plan view."""

    roads: shapely.Geometry  # Asphalt of the roads [m]
    ponds: list[shapely.Polygon]  # [m]
    lakes: list[shapely.Polygon]  # [m]
    strips: list[Strip]
    car_parks: list[CarPark]
    houses: list[BuildingPart]


def lay_out(network: RoadNetwork, seed: int) -> LakeLayout:
    """Return the plan."""
    roads, grid, rng = road_area(network), lattice(seed), stream(seed, "lake blocks")
    cells = _cells(grid)
    pairs = [cell for cell in cells if cell not in (grid.double, _beside(grid.double))]
    chosen = _regular(pairs)
    strips = [
        Strip(_rectangle(_middle(grid, cell), _STRIP), kind)
        for kind, cell in enumerate(sorted(chosen))
    ]
    both = (_middle(grid, grid.double) + _middle(grid, _beside(grid.double))) / 2
    strips.append(Strip(_rectangle(both, _WIDE_STRIP), MIXED))
    free = [cell for cell in pairs if cell not in chosen]
    spared = {free[int(k)] for k in rng.permutation(len(free))[: len(free) - 21]}
    ponds = [
        _rectangle(_middle(grid, cell), (_POND_WIDTH, float(round(rng.uniform(*_POND_LENGTH)))))
        for cell in free
        if cell not in spared
    ]
    lakes = [blob(np.array([x, y]), radius, rng) for x, y, radius in _LAKES]
    closed, _ = blocks(roads, EXTENT)
    covered = shapely.union_all([*ponds, *lakes, *(strip.area for strip in strips)])
    parks = place_car_parks(closed, _CAR_PARKS, rng, covered)
    covered = shapely.union_all([covered, *(park.area for park in parks)])
    ponds += _odd_ponds(closed, covered, rng)
    covered = shapely.union_all([covered, *ponds])
    taken = shapely.union(shapely.buffer(covered, 4.0), shapely.buffer(roads, 4.2))
    houses = _houses(network, taken, stream(seed, "lake houses"))
    return LakeLayout(roads, ponds, lakes, strips, parks, houses)


def _cells(grid: Lattice) -> list[tuple[int, int]]:
    return [(i, j) for i in range(COLUMNS) for j in range(ROWS)]


def _beside(cell: tuple[int, int]) -> tuple[int, int]:
    return cell[0] + 1, cell[1]


def _regular(cells: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return every fourth or fifth block, one for each kind of tree."""
    count = len(SPECIES)
    return [cells[(2 * k + 1) * len(cells) // (2 * count)] for k in range(count)]


def _middle(grid: Lattice, cell: tuple[int, int]) -> Points:
    i, j = cell
    return np.array([grid.x[i : i + 2].mean(), grid.y[j : j + 2].mean()])


def _rectangle(middle: Points, size: tuple[float, float]) -> shapely.Polygon:
    (x, y), (width, length) = rounded(middle), size
    return shapely.box(x - width / 2, y - length / 2, x + width / 2, y + length / 2)


def _odd_ponds(
    grounds: Sequence[shapely.Polygon], taken: shapely.Geometry, rng: np.random.Generator
) -> list[shapely.Polygon]:
    """Return the ponds in the large blocks outside the grid."""
    large = sorted(grounds, key=shapely.area)[-8:]
    room = shapely.difference(
        shapely.union_all([shapely.buffer(block, -14.0) for block in large]),
        shapely.buffer(taken, 12.0),
    )
    made: list[shapely.Polygon] = []
    west, south, east, north = room.bounds
    for size in _ODD_PONDS:
        for _ in range(300):
            pond = _rectangle(rng.uniform((west, south), (east, north)), size)
            if room.contains(pond) and not any(pond.distance(one) < 40.0 for one in made):
                made.append(pond)
                break
    return made


def _houses(
    network: RoadNetwork, taken: shapely.Geometry, rng: np.random.Generator
) -> list[BuildingPart]:
    """Return houses beside roads, most of them along the diagonal main road."""
    sites = []
    for street in streets(network):
        kerb = shapely.LineString(street.right)
        for along in np.arange(18.0, kerb.length - 18.0, 27.0):
            here, there = (
                shapely.get_coordinates(kerb.interpolate(s))[0] for s in (along, along + 1)
            )
            far = abs(here[0] - here[1] - 330.0) + 300.0 * rng.random() - 0.4 * here[1]
            sites.append((far, here, unit(there - here), street.side))
    made: list[BuildingPart] = []
    shapely.prepare(taken)
    shapes: list[shapely.Polygon] = []
    for _, here, onwards, side in sorted(sites, key=lambda site: float(site[0])):
        outline = _footprint(here, onwards, side, rng)
        shape = shapely.Polygon(outline)
        free = not taken.intersects(shape) and all(shape.distance(other) > 7.0 for other in shapes)
        if free and len(made) < _HOUSES:
            shapes.append(shape)
            made.append(_house(outline, rng))
    return made


def _footprint(here: Points, onwards: Points, side: float, rng: np.random.Generator) -> Points:
    """Return the corners of a house beyond a kerb, counter-clockwise [m]."""
    wide, deep = rng.uniform(11.0, 24.0), rng.uniform(10.0, 16.0)
    outwards = side * np.array([onwards[1], -onwards[0]])
    front = here + rng.uniform(4.5, 9.0) * outwards
    half, back = side * wide / 2 * onwards, deep * outwards
    return rounded([front - half, front - half + back, front + half + back, front + half])


def _house(outline: Points, rng: np.random.Generator) -> BuildingPart:
    sloping = bool(rng.random() < 0.6)
    light = float(rng.uniform(0.82, 1.0))
    return BuildingPart(
        outline=shapely.Polygon(outline),
        bottom=FLOOR_HEIGHT,
        height=float(
            rng.choice([6.0, 9.0, 9.0, 9.0, 12.0, 18.0], p=[0.2, 0.25, 0.2, 0.2, 0.1, 0.05])
        ),
        facade=FACADES[int(rng.choice([1, 2, 3, 7, 9]))],
        tint=(light, 0.98 * light, 0.95 * light),
        roof="pyramid" if sloping else "flat",
        cover=material("roof_tiles" if sloping else "roof_terrace", (light, light, light)),
    )
