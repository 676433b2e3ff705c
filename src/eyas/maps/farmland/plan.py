"""The plan of the farmland."""

import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import road_area
from eyas.maps.farmland.layout import CROPS, FLOOR, VERGE, lay_out
from eyas.maps.farmland.roads import NAME, road_graph
from eyas.maps.farmland.scenery import BALK, DITCH, SHOULDER, bales, far_fields, field, lamps_of
from eyas.maps.land.ground import rectangle
from eyas.maps.land.outlines import wavy
from eyas.maps.plan.library import STREET_KINDS
from eyas.maps.plan.plan import (
    Chance,
    Flat,
    GroundCover,
    LampLight,
    MapPlan,
    Paint,
    Roadway,
    ThingKind,
    things,
)

MOUNTAINS = Horizon("farmland", height=0.075, ridges=1.0, woods=0.25)
"""What stands beyond the fields."""

_MARGIN, _CORNERS = 1.3, 13.0
"""Most by which a field's edge wanders, and the distance between its corners [m]."""
_VERGE = 1.2  # Width of the gravel and grass beside roads [m]
_DITCH = 0.5  # Width of the ditches around fields [m]
_LIGHT = LampLight(axis=(0.7, 0.0, -1.0), intensity=45.0, cut_off=1.57)
"""The beams lean over the road, as in the original."""


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the farmland."""
    nodes = [(node.x, node.y) for node in road_graph(seed).nodes]
    x, y = (sorted(set(places)) for places in zip(*nodes, strict=True))
    roads = road_area(network)
    # Kerbs are round at the corners, and so are the verges.
    verge = shapely.buffer(roads, VERGE - 0.01)
    lots = lay_out(x, y, stream(seed, "farmland fields"))
    rng = stream(seed, "farmland margins")
    areas = [
        snapped(wavy(shapely.difference(lot.area, verge), _MARGIN, rng, _CORNERS)) for lot in lots
    ]
    fields = [field(lot, area) for lot, area in zip(lots, areas, strict=True)]
    # Tan fields are harvested.
    harvested = [
        area for lot, area in zip(lots, areas, strict=True) if CROPS[lot.crop].name == "tan"
    ]
    ditches = [
        snapped(shapely.buffer(area, _DITCH, join_style="mitre").difference(verge))
        for area in areas
    ]
    covered = shapely.union_all([roads, *areas, *ditches])
    ditches = snapped(shapely.union_all(ditches).difference(shapely.union_all(areas)))
    between = shapely.difference(rectangle(*FLOOR), covered)
    verge = shapely.buffer(roads, _VERGE, quad_segs=4)
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(ThingKind(name="bale"), *STREET_KINDS),
        layers=(
            Roadway(area=roads, paint=Paint(crossings=0), wear=Chance(stream="farmland road wear")),
            GroundCover(pieces=tuple(fields)),
            GroundCover(
                pieces=(
                    Flat(area=shapely.difference(between, verge), cover=BALK),
                    Flat(area=shapely.intersection(between, verge), cover=SHOULDER, beside=roads),
                    Flat(area=ditches, cover=DITCH),
                    far_fields(),
                )
            ),
            things(bales(harvested, CROPS[2].height, stream(seed, "farmland bales")), ("bale",)),
            things(lamps_of(network, seed)),
        ),
        lamps=_LIGHT,
        horizon=MOUNTAINS,
    )
