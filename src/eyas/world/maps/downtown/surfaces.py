"""The ground of downtown: pavements with broad pale kerbs, courts, the park, the land around."""

import shapely

from eyas.core.rng import stream
from eyas.state.mesh import Material, Surface
from eyas.state.scene import ObjectClass
from eyas.world.build.materials import material
from eyas.world.land import ground
from eyas.world.maps.downtown.layout import EXTENT, Layout
from eyas.world.plan.plan import (
    Chance,
    Far,
    Flat,
    Ground,
    Layer,
    Paint,
    Paved,
    Streets,
    state_of,
)

__all__ = ["surfaces"]

_KERB_WIDTH = 0.8
"""As wide as the original's [m]."""
_KERB = material("paving", (1.0, 0.94, 0.90))
_SLABS = material("paving", (0.84, 0.91, 0.95))
_COURT = material("concrete", (0.97, 0.97, 0.93))
_TRAIL = material("asphalt_light", (1.0, 0.97, 0.90))
_RIM = material("stone", (0.98, 0.95, 0.92))
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_STONES = material("stone", (0.80, 0.78, 0.76))
_WALL, _WALL_TOP = 0.5, 1.0
"""Thickness of the wall around the park, and z of its top [m]."""
_LAND = (
    material("concrete", (0.90, 0.90, 0.87)),
    material("concrete", (0.80, 0.80, 0.79)),
    material("asphalt_light", (1.0, 0.99, 0.96)),
    material("lawn", (0.84, 0.90, 0.80)),
)
"""What covers the land around: courts, yards, car parks, some lawn."""
_LAND_SHARES = (0.34, 0.26, 0.2, 0.2)


def surfaces(city: Layout, seed: int) -> list[Layer]:
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
        Streets(
            area=city.roads,
            bays=bays,
            paint=Paint(shapes=tuple(city.kerbs.lines)),
            wear=Chance(stream="downtown road wear"),
        ),
        _paved(city.pavement, shapely.union(city.roads, bays), turn, _SLABS),
        Ground(pieces=tuple(lawn)),
        Ground(kind=ObjectClass.PAVEMENT, pieces=(Flat(area=park.paths, cover=_TRAIL),)),
        _paved(park.rim, nowhere, 0.0, _RIM),
        *(Ground(kind=ObjectClass.WATER, pieces=(pond,)) for pond in ponds),
        Ground(kind=ObjectClass.STRUCTURE, pieces=(_park_wall(city),)),
        Ground(pieces=(court, land)),
    ]


def _paved(area: shapely.Geometry, road: shapely.Geometry, turn: float, slabs: Material) -> Paved:
    return Paved(
        area=area,
        beside=road,
        slabs=slabs,
        kerb=_KERB,
        kerb_width=_KERB_WIDTH,
        kerb_turn=turn,
        turn=turn,
    )


def _park_wall(city: Layout) -> Flat:
    """Return the low wall between the streets and the park, with gaps where paths enter."""
    park = city.park
    line = shapely.intersection(shapely.buffer(park.walk, _WALL, join_style="mitre"), park.ground)
    gates = shapely.buffer(park.paths, 0.6)
    wall = shapely.difference(line, shapely.union(park.walk, gates))
    return Flat(area=wall, z=_WALL_TOP, cover=_RIM, turn=city.grid.turn, sides=_STONES)
