"""The ground of downtown: pavements with broad pale kerbs, courts, the park, the land around."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.build.materials import facade, material
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.downtown.layout import EXTENT, DowntownLayout
from eyas.maps.downtown.massing import STOREY
from eyas.maps.downtown.roads import Grid
from eyas.maps.downtown.skyline import facade_of, roof_of
from eyas.maps.land import ground
from eyas.maps.plan.plan import (
    Backdrop,
    Chance,
    Far,
    Flat,
    GroundCover,
    Layer,
    Paint,
    Paved,
    Roadway,
    state_of,
)

__all__ = ["backdrop", "surfaces"]

_STEP = (72.0, 66.0)
"""Distances between the middles of neighbours, along the streets and the avenues [m]."""
_REACH = 420.0  # From the outermost roads to the farthest [m]
_APART = 36.0  # Least distance from blocks, fronts and the park [m]
_FROM_EDGE = 30.0
_SHARE = 0.7  # Share of the places that are built on
_SIDES = (17.0, 40.0)
_MEDIAN, _SPREAD, _HIGHEST = 26.0, 0.75, 150.0
"""Median height [m], spread of its logarithm, and limit [m]."""

_KERB_WIDTH = 0.8  # As wide as the original's [m]
_KERB = material("paving", (1.0, 0.94, 0.90))
_SLABS = material("paving", (0.84, 0.91, 0.95))
_COURT = material("concrete", (0.97, 0.97, 0.93))
_TRAIL = material("asphalt_light", (1.0, 0.97, 0.90))
_RIM = material("stone", (0.98, 0.95, 0.92))
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_STONES = material("stone", (0.80, 0.78, 0.76))
_WALL, _WALL_TOP = 0.5, 1.0  # Thickness of the wall around the park, and z of its top [m]
_LAND = (
    material("concrete", (0.90, 0.90, 0.87)),
    material("concrete", (0.80, 0.80, 0.79)),
    material("asphalt_light", (1.0, 0.99, 0.96)),
    material("lawn", (0.84, 0.90, 0.80)),
)
"""What covers the land around: courts, yards, car parks, some lawn."""
_LAND_SHARES = (0.34, 0.26, 0.2, 0.2)


def surfaces(city: DowntownLayout, seed: int) -> list[Layer]:
    """Return paint, roads, pavements, courts, the park and the land around."""
    park, turn, rng = city.park, city.grid.turn, stream(seed, "downtown lawn")
    bays = shapely.difference(city.kerbs.bays, city.roads)
    wet = shapely.union(park.water, park.rim)
    green = shapely.difference(park.ground, shapely.union_all([park.walk, park.paths, wet]))
    nowhere = shapely.Polygon()
    lawn = ground.lawn(park.ground, shapely.difference(EXTENT, green), rng, nowhere, 0.0)
    land = Far(rule="city", covers=_LAND, shares=_LAND_SHARES, chance=state_of(rng))
    covered = shapely.union_all([city.roads, bays, city.pavement, park.ground])
    court = Flat(area=shapely.difference(EXTENT, covered), cover=_COURT, turn=turn)
    ponds = (Flat(area=pond, z=-0.15, cover=_WATER) for pond in shapely.get_parts(park.water))
    return [
        Roadway(
            area=city.roads,
            bays=bays,
            paint=Paint(shapes=tuple(city.kerbs.lines)),
            wear=Chance(stream="downtown road wear"),
        ),
        _paved(city.pavement, shapely.union(city.roads, bays), turn, _SLABS),
        GroundCover(pieces=tuple(lawn)),
        GroundCover(kind=ObjectClass.PAVEMENT, pieces=(Flat(area=park.paths, cover=_TRAIL),)),
        _paved(park.rim, nowhere, 0.0, _RIM),
        *(GroundCover(kind=ObjectClass.WATER, pieces=(pond,)) for pond in ponds),
        GroundCover(kind=ObjectClass.STRUCTURE, pieces=(_park_wall(city),)),
        GroundCover(pieces=(court, land)),
    ]


def _paved(area: shapely.Geometry, road: shapely.Geometry, turn: float, slabs: Material) -> Paved:
    return Paved(
        area=area,
        beside=road,
        slabs=slabs,
        kerb=_KERB,
        kerb_width=_KERB_WIDTH,
        turn=turn,
    )


def _park_wall(city: DowntownLayout) -> Flat:
    """Return the low wall between the streets and the park, with gaps where paths enter."""
    park = city.park
    line = shapely.intersection(shapely.buffer(park.walk, _WALL, join_style="mitre"), park.ground)
    gates = shapely.buffer(park.paths, 0.6)
    wall = shapely.difference(line, shapely.union(park.walk, gates))
    return Flat(area=wall, z=_WALL_TOP, cover=_RIM, turn=city.grid.turn, sides=_STONES)


def backdrop(
    grid: Grid, floor: shapely.Polygon, city: shapely.Geometry, rng: np.random.Generator
) -> Backdrop:
    """Return the city beyond the outer streets.

    Args:
        grid: The grid of the streets.
        floor: The whole floor [m].
        city: Roads, fronts and park [m].
        rng: Random numbers of the backdrop.
    """
    free = shapely.difference(shapely.buffer(floor, -_FROM_EDGE), shapely.buffer(city, _APART))
    shapely.prepare(free)
    u = np.arange(grid.avenues[0] - _REACH, grid.avenues[-1] + _REACH, _STEP[0])
    v = np.arange(grid.streets[0] - _REACH, grid.streets[-1] + _REACH, _STEP[1])
    places = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    places += rng.uniform(-9.0, 9.0, places.shape)
    made: list[tuple[NDArray[np.float64], float, Material, Material, NDArray[np.int64]]] = []
    for place in places:
        side = np.round(rng.uniform(*_SIDES, 2) / 3.0) * 1.5
        height = min(_MEDIAN * float(exact.exp(exact.normal(rng, 0.0, _SPREAD))), _HIGHEST)
        top = FLOOR_HEIGHT + STOREY * max(round(height / STOREY), 2)
        corners = place + side * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        outline = grid.world(corners)
        if rng.random() < _SHARE and shapely.contains(free, shapely.Polygon(outline)):
            walls, roof = facade(*facade_of(top, rng)), roof_of(rng)
            made.append((outline, top, walls, roof, rng.integers(0, 4, (4, 2))))
    outlines, tops, walls_, roofs, bays = zip(*made, strict=True) if made else ((),) * 5
    return Backdrop(
        outlines=outlines, tops=np.array(tops, np.float64), walls=walls_, roofs=roofs, bays=bays
    )
