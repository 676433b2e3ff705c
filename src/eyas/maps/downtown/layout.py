"""Plan of downtown: the position of everything in it."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.roads.areas import blocks, corridors, road_area
from eyas.maps.buildings.lots import turned
from eyas.maps.downtown.blocks import (
    AVENUE_WALK,
    STREET_WALK,
    block_lots,
    built,
    inner_blocks,
    outer_lots,
)
from eyas.maps.downtown.kerbs import Kerbs, make_kerbs
from eyas.maps.downtown.park import Park, make_park
from eyas.maps.downtown.roads import Grid, grid
from eyas.maps.downtown.skyways import make_skyways
from eyas.maps.downtown.viaduct import cut, make_viaduct
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.things.railway import Viaduct
from eyas.maps.things.skyways import Skyway

__all__ = ["EXTENT", "FLOOR", "DowntownLayout", "lay_out"]

FLOOR = (2000.0, 1500.0)  # Extent of the floor [m]

EXTENT = shapely.box(*(-0.5 * np.array(FLOOR)), *(0.5 * np.array(FLOOR)))  # The floor

_OUTER_WALK = 6.5  # Width of the pavement on the far side of the outer streets [m]

_CROWN = 5.0  # No skyway comes nearer to a trunk [m]

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DowntownLayout:
    """Positions in plan view."""

    grid: Grid  # The grid of the streets
    roads: shapely.Geometry  # Asphalt of the streets [m]
    park: Park  # The park
    kerbs: Kerbs  # Parked cars and trees along the streets
    pavement: shapely.Geometry  # Raised pavements beside the streets, without parking bays [m]
    buildings: list[list[BuildingPart]]  # Parts of each building, the lowest first
    viaduct: Viaduct  # The elevated railway
    skyways: list[Skyway]  # Bridges between buildings

    @property
    def footprints(self) -> list[Points]:
        """Corners of the buildings on the ground [m]."""
        return [parts[0].footprint for parts in self.buildings]


def lay_out(network: RoadNetwork, seed: int) -> DowntownLayout:
    """Return the plan of a city.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    plan = grid(seed)
    roads = road_area(network)
    closed, _ = blocks(corridors(network), EXTENT)
    cells = inner_blocks(plan, closed)
    rng = stream(seed, "downtown lots")
    lots = [lot for block in cells.values() for lot in block_lots(block, rng)]
    lots = cut(lots + outer_lots(plan, rng), plan)
    viaduct = make_viaduct(network, plan)
    park = make_park(plan, roads, EXTENT, stream(seed, "downtown park"))
    kerbs = make_kerbs(network, plan, viaduct.ground, stream(seed, "downtown kerbs"))
    inside, outside = blocks(roads, EXTENT)
    courts = [
        turned(
            shapely.box(w + AVENUE_WALK, s + STREET_WALK, e - AVENUE_WALK, n - STREET_WALK),
            plan.turn,
        )
        for w, s, e, n in cells.values()
    ]
    rings = shapely.difference(shapely.union_all(inside), shapely.union_all(courts))
    verge = shapely.intersection(
        shapely.union_all(outside),
        shapely.buffer(roads, _OUTER_WALK, join_style="mitre", mitre_limit=2.0),
    )
    verge = shapely.difference(verge, park.ground)
    pavement = shapely.union_all([rings, verge, park.walk])
    buildings = built(plan, lots, seed)
    trunks = shapely.points(np.concatenate([kerbs.great_trees, kerbs.slim_trees]))
    taken = shapely.union_all([viaduct.ground, *shapely.buffer(trunks, _CROWN)])
    rng = stream(seed, "downtown skyways")
    return DowntownLayout(
        grid=plan,
        roads=roads,
        park=park,
        kerbs=kerbs,
        pavement=shapely.difference(pavement, kerbs.bays),
        buildings=buildings,
        viaduct=viaduct,
        skyways=make_skyways(plan, lots, buildings, roads, taken, rng),
    )
