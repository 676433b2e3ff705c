"""The plan of the desert."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import facade, material
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.street.signals import signal_places, signals_along
from eyas.maps.desert.layout import EXTENT, FLOOR, HALF, DesertLayout, lay_out
from eyas.maps.desert.roads import NAME
from eyas.maps.desert.scenery import scattered_over, wheel_tracks
from eyas.maps.land.relief import relief_of
from eyas.maps.plan.library import STREET_KINDS, houses, wild_kinds
from eyas.maps.plan.plan import (
    Chance,
    Far,
    Flat,
    GroundCover,
    Heap,
    Hills,
    MapPlan,
    Paint,
    Roadway,
    things,
)
from eyas.maps.street.lamps import lamps_along

SAND = replace(material("sand", (1.0, 0.96, 0.88)), surface=Surface.DESERT)
"""The ground, the dunes, and the drifts on the roads."""

_DUSTY = replace(SAND, surface=Surface.DESERT_DRIFT)  # Asphalt under a thin layer of sand

_SNOW = replace(SAND, surface=Surface.DESERT_SNOW)  # Dunes under snow

_TRACK = replace(SAND, surface=Surface.DESERT_TRACK)  # Ruts of wheels that have left the road

_HOUSES = (
    (facade("facade_plaster", (1.0, 0.95, 0.82)), material("roof_tiles", (1.0, 0.90, 0.80))),
    (facade("facade_plaster", (0.98, 0.90, 0.74)), material("roof_tiles", (0.94, 0.84, 0.74))),
    (facade("facade_stone", (1.0, 0.96, 0.84)), material("roof_tiles", (0.98, 0.88, 0.78))),
)

DUNES = Horizon(name="desert", height=0.03, ridges=0.1, woods=0.0)  # What stands beyond the map

_LAMPS = 38
_CORE = 345.0
_SPACING = (6.0, 13.0)
"""Half the side of the square with the smaller triangles, and distances of their corners [m]."""
DRIFT_HEIGHT = 0.03  # z of the drifts: above all paint [m]
_FRINGE_HEIGHT, _TONGUE_HEIGHT = 0.022, 0.026
"""z of the thin sand around them, and of the tongues at the kerbs, which cross it [m]."""
_THIN = 1.2  # Width of the thin sand around tongues [m]
_SNOWED = 22  # Number of dunes under snow in winter, as in the original


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the desert; in winter, nearly every second dune is white."""
    desert = lay_out(network, seed)
    dunes = Hills(
        mounds=tuple(desert.dunes),
        flat=shapely.union(shapely.buffer(desert.roads, 5.0), shapely.buffer(desert.walls, 3.0)),
        half=(_CORE, HALF),
        spacing=_SPACING,
        chance=Chance(stream="desert facets"),
        covers=(SAND, _SNOW),
        white=_white(len(desert.dunes), stream(seed, "desert snow")),
        smooth=True,
    )
    ground = relief_of(dunes, seed)
    # Slightly below the feet of the dunes, so that rounding leaves no gap between them.
    rest = shapely.buffer(ground.area, -0.4, join_style="mitre")
    level = shapely.difference(EXTENT, shapely.union(desert.roads, rest))
    # Ruts end where dunes begin, not below their feet, which look different.
    driven = shapely.difference(level, ground.area)
    tracks = snapped(
        shapely.intersection(wheel_tracks(desert, stream(seed, "desert tracks")), driven)
    )
    sand = Flat(area=shapely.difference(level, tracks), cover=SAND)
    far = Far(rule="plain", covers=(SAND,), beyond=(2 * HALF, 2 * HALF))
    kinds, placed = houses(desert.houses, _HOUSES)
    poles = shapely.buffer(shapely.points([place for place, _ in signal_places(network)]), 2.0)
    taken = shapely.union_all([desert.roads, desert.walls, *poles])
    wild = wild_kinds("dry tuft", "dry bush", shapes=3)
    stones = wild_kinds("stones", looks=(0, 1)) + wild_kinds("boulder", looks=(0, 1))
    litter = scattered_over(desert, ground, taken, stream(seed, "desert stones"))
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(*kinds, *STREET_KINDS, *wild, *stones),
        layers=(
            dunes,
            things(placed),
            GroundCover(pieces=tuple(_sand(desert))),
            Roadway(
                area=desert.roads, paint=Paint(crossings=0), wear=Chance(stream="desert road wear")
            ),
            GroundCover(pieces=(sand, Flat(area=tracks, cover=_TRACK), far)),
            things(signals_along(network)),
            things(lamps_along(network, _LAMPS, taken, stream(seed, "desert lamps"))),
            things(litter, [kind.name for kind in (*wild, *stones)]),
        ),
        horizon=DUNES,
    )


def _white(dunes: int, rng: np.random.Generator) -> tuple[int, ...]:
    """Return which dunes are white in winter: about every second."""
    kept = np.floor(_SNOWED / dunes * np.arange(dunes + 1) + rng.uniform())
    return tuple(np.flatnonzero(np.diff(kept) > 0).tolist())


def _sand(desert: DesertLayout) -> Sequence[Heap | Flat]:
    """Return the drifts on the roads, with thin sand around them."""
    sand = shapely.union_all([*(drift.area for drift in desert.drifts), *desert.tongues])
    thin = shapely.buffer(shapely.union_all(desert.tongues), _THIN, quad_segs=1)
    thin = shapely.simplify(thin, 0.3)
    dusty = shapely.union_all([thin, *(drift.fringe for drift in desert.drifts)])
    edge = shapely.intersection(shapely.difference(dusty, sand), desert.roads)
    return [
        *(Heap(area=drift.area, z=DRIFT_HEIGHT, cover=SAND) for drift in desert.drifts),
        *(Heap(area=tongue, z=_TONGUE_HEIGHT, cover=SAND) for tongue in desert.tongues),
        Flat(area=edge, z=_FRINGE_HEIGHT, cover=_DUSTY, beside=sand),
    ]
