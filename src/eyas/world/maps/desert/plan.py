"""The plan of the desert."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.core.rng import stream
from eyas.state.lighting import Horizon
from eyas.state.roads import RoadNetwork
from eyas.world.land.rising import relief_of
from eyas.world.maps.desert.layout import EXTENT, FLOOR, HALF, Layout, lay_out
from eyas.world.maps.desert.looks import DUSTY, HOUSES, SAND, SNOW, THIN_SNOW
from eyas.world.maps.desert.roads import NAME
from eyas.world.plan.library import STREET_KINDS, houses
from eyas.world.plan.plan import (
    Chance,
    Far,
    Flat,
    Ground,
    Heap,
    MapPlan,
    Paint,
    Relief,
    Streets,
    things,
)
from eyas.world.street.lamps import lamps_along
from eyas.world.street.signals import signal_places, signals_along

__all__ = ["DRIFT_HEIGHT", "DUNES", "make_plan"]

DUNES = Horizon(name="desert", height=0.03, ridges=0.1, woods=0.0)
"""What stands beyond the map."""

_LAMPS = 38
_CORE = 345.0
_SPACING = (6.0, 13.0)
"""Half the side of the square with the smaller triangles, and distances of their corners [m]."""
DRIFT_HEIGHT = 0.03
"""z of the drifts: above all paint [m]."""
_FRINGE_HEIGHT = 0.022
"""z of the thin sand around them, and of the tongues at the kerbs [m]."""
_SNOWED = 22
"""Number of dunes under snow in winter, as in the original."""


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the desert; in winter, nearly every second dune is white.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    desert = lay_out(network, seed)
    dunes = Relief(
        mounds=tuple(desert.dunes),
        flat=shapely.union(shapely.buffer(desert.roads, 5.0), shapely.buffer(desert.walls, 3.0)),
        half=(_CORE, HALF),
        spacing=_SPACING,
        chance=Chance(stream="desert facets"),
        covers=(SAND, THIN_SNOW, SNOW),
        white=_white(len(desert.dunes), stream(seed, "desert snow")),
        smooth=True,
    )
    # Slightly below the feet of the dunes, so that rounding leaves no gap between them.
    rest = shapely.buffer(relief_of(dunes, seed).area, -0.4, join_style="mitre")
    level = Flat(area=shapely.difference(EXTENT, shapely.union(desert.roads, rest)), cover=SAND)
    far = Far(rule="plain", covers=(SAND,), beyond=(2 * HALF, 2 * HALF))
    kinds, placed = houses(desert.houses, HOUSES)
    poles = shapely.buffer(shapely.points([place for place, _ in signal_places(network)]), 2.0)
    taken = shapely.union_all([desert.roads, desert.walls, *poles])
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(*kinds, *STREET_KINDS),
        layers=(
            dunes,
            things(placed),
            Ground(pieces=tuple(_sand(desert))),
            Streets(
                area=desert.roads, paint=Paint(crossings=0), wear=Chance(stream="desert road wear")
            ),
            Ground(pieces=(level, far)),
            things(signals_along(network)),
            things(lamps_along(network, _LAMPS, taken, stream(seed, "desert lamps"))),
        ),
        horizon=DUNES,
    )


def _white(dunes: int, rng: np.random.Generator) -> tuple[int, ...]:
    """Return which dunes are white in winter: about every second."""
    kept = np.floor(_SNOWED / dunes * np.arange(dunes + 1) + rng.uniform())
    return tuple(np.flatnonzero(np.diff(kept) > 0).tolist())


def _sand(desert: Layout) -> Sequence[Heap | Flat]:
    """Return the drifts on the roads, with thin sand around them."""
    sand = shapely.union_all([drift.area for drift in desert.drifts])
    dusty = shapely.union_all([drift.fringe for drift in desert.drifts])
    edge = shapely.intersection(shapely.difference(dusty, sand), desert.roads)
    return [
        *(Heap(area=drift.area, z=DRIFT_HEIGHT, cover=SAND) for drift in desert.drifts),
        *(Heap(area=tongue, z=_FRINGE_HEIGHT, cover=SAND) for tongue in desert.tongues),
        Flat(area=edge, z=_FRINGE_HEIGHT, cover=DUSTY, cells="whole"),
    ]
