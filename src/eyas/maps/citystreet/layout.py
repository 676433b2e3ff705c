"""Plan of the street city: the position of everything in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import unit
from eyas.engine.world.roads.areas import (
    Street,
    blocks,
    corners,
    corridors,
    joints,
    polygons_of,
    road_area,
    streets,
)
from eyas.lanes import exact
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.buildings import placing as buildings
from eyas.maps.buildings.lots import frame_angle, turned
from eyas.maps.citystreet.roads import road_graph
from eyas.maps.land import ground, outskirts
from eyas.maps.plan.plan import BuildingPart
from eyas.maps.plants import trees
from eyas.maps.roads import overpass
from eyas.maps.roads.overpass import Pillar, pillars
from eyas.maps.street.car_parks import CarPark, place_car_parks, place_rectangle

FLOOR = (900.0, 900.0)  # Extent of the floor [m]

EXTENT = shapely.box(*(-0.5 * np.array(FLOOR)), *(0.5 * np.array(FLOOR)))  # The floor

_BUILDINGS = 83
_TREES = 63
_TREE_SPACING = (15.0, 21.5)
_BEYOND_KERB = 4.4  # Distance from the kerb to the trunks [m]
_TREE_STRIP = 10.0  # Strip without buildings beside a row of trees, from the kerb [m]
_CAR_PARKS = ((69.0, 34.0), (58.0, 34.0), (45.0, 34.0), (64.0, 17.0), (49.0, 17.0))
_POOL = (30.0, 18.8)

_HIGH = 53.5  # z of the elevated road [m]
_PILLARS = 18
_ASIDE = 17.0  # From the middle of a street to the middle of the elevated road beside it [m]
_RAMP = ((0.0, 0.0), (0.02, 0.1), (0.09, 3.5), (0.27, 28.0), (0.42, _HIGH), (1.0, _HIGH))
"""Profile of the elevated road: share of its length, and z [m]."""

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CityLayout:
    """Positions in plan view."""

    roads: shapely.Geometry  # Asphalt of the streets [m]
    access: shapely.Geometry  # Asphalt to the foot of the ramp [m]
    blocks: list[shapely.Polygon]  # Ground between streets [m]
    outside: list[shapely.Polygon]  # Ground beyond the outer streets [m]
    turn: float  # Direction of the streets [rad]
    deck: Points  # Centre line of the elevated road [m], shape (K, 3)
    pillars: list[Pillar]  # Pillars below the elevated road
    car_parks: list[CarPark]  # Car parks with their driveways
    pools: list[shapely.Polygon]  # Water [m]
    pavement: shapely.Geometry  # Raised pavements beside the streets [m]
    trees: Points  # Trunks of the street trees [m], shape (K, 2)
    buildings: list[BuildingPart]  # Buildings, towers included

    @property
    def lots(self) -> shapely.Geometry:
        """Asphalt of the car parks [m]."""
        return shapely.difference(
            shapely.union_all([park.area for park in self.car_parks]), self.roads
        )

    @property
    def footprints(self) -> list[Points]:
        """Corners of the buildings that stand on the ground [m]."""
        return [b.footprint for b in self.buildings if b.bottom <= FLOOR_HEIGHT]


def lay_out(network: RoadNetwork, seed: int) -> CityLayout:
    """Return the plan of a city."""
    roads = road_area(network)
    closed, _ = blocks(sharp := corridors(network), EXTENT)
    middle = _overpass_path(seed)
    onwards = unit((middle[1] - middle[0])[:2])
    access = outskirts.access_road(middle[0, :2], onwards, roads)
    columns = pillars(middle, _PILLARS, FLOOR_HEIGHT, roads)
    deck = shapely.buffer(overpass.deck_area(middle), 3.0)
    rng = stream(seed, "citystreet lots")
    car_parks = place_car_parks(closed, _CAR_PARKS, rng, deck)
    lots = [park.area for park in car_parks]
    pools = _pools(closed, rng, shapely.union_all([deck, *lots]))
    bases = [shapely.buffer(pillar.base, 3.0) for pillar in columns]
    taken = shapely.union_all([roads, *bases, *(shapely.buffer(lot, 2.0) for lot in lots)])
    trunks, strips = _tree_rows(network, stream(seed, "citystreet trees"), taken)
    aprons = [shapely.buffer(lot, 2.5, join_style="mitre") for lot in (*lots, *pools)]
    free = shapely.union_all([deck, *aprons, *strips])
    # One by one, so that each cuts a corner off a building instead of moving the building.
    free = shapely.geometrycollections([*polygons_of(free), *corners(roads, sharp)])
    made = buildings.place_buildings(closed, _BUILDINGS, stream(seed, "citystreet buildings"), free)
    inside, outside = blocks(roads, EXTENT)
    return CityLayout(
        roads=roads,
        access=access,
        blocks=inside,
        outside=outside,
        turn=frame_angle(max(closed, key=shapely.area)),
        deck=middle,
        pillars=columns,
        car_parks=car_parks,
        pools=pools,
        pavement=_pavement(inside, outside, roads, access, lots, middle),
        trees=trunks,
        buildings=made,
    )


def _pavement(
    inside: Sequence[shapely.Polygon],
    outside: Sequence[shapely.Polygon],
    roads: shapely.Geometry,
    access: shapely.Geometry,
    lots: Sequence[shapely.Polygon],
    deck: Points,
) -> shapely.Geometry:
    """Return the pavements without the driveways and the foot of the ramp."""
    lanes = shapely.difference(shapely.union_all(lots), roads)
    verge = ground.verge_area(outside, shapely.union(roads, access))
    # Slightly larger than the ramp: rounding leaves a sliver between it and the access road.
    ramp = shapely.buffer(overpass.deck_area(deck[:9]), 0.01, join_style="mitre")
    verge = shapely.difference(verge, ramp)
    return shapely.union(ground.pavement_area(inside, lanes), verge)


def _overpass_path(seed: int) -> Points:
    """Return the elevated road: up a ramp in the west, then beside three streets to the east."""
    at = {node.name: np.array([node.x, node.y]) for node in road_graph(seed).nodes}
    origin = at["B2"]
    east = unit(at["C2"] - origin)
    frame = np.stack([east, [-east[1], east[0]]])
    west, third = exact.product(frame, at["A4"] - origin)
    second = exact.product(frame[0], at["C2"] - origin)
    corners = np.array(
        [
            [west - 68.0, 70.0],
            [west - 68.0, third + _ASIDE],
            [second + _ASIDE, third + _ASIDE],
            [second + _ASIDE, _ASIDE],
            [second + 600.0, _ASIDE],
        ]
    )
    world = exact.product(corners, frame) + origin
    # It leaves the map where the floor ends.
    onwards = frame[0]
    room = (np.sign(onwards) * 0.5 * np.array(FLOOR) - world[3]) / onwards
    world[4] = world[3] + (room.min() - 2.0) * onwards
    return overpass.path(world, (55.0, 70.0, 60.0), _RAMP)


def _pools(
    closed: Sequence[shapely.Polygon], rng: np.random.Generator, keep_free: shapely.Geometry
) -> list[shapely.Polygon]:
    """Return one pool, in the first block that has room for it."""
    for index in rng.permutation(len(closed)):
        found = place_rectangle(closed[int(index)], _POOL, rng, keep_free)
        if found:
            return [turned(found[0], found[1])]
    return []


def _tree_rows(
    network: RoadNetwork, rng: np.random.Generator, keep_free: shapely.Geometry
) -> tuple[Points, list[shapely.Polygon]]:
    """Return trunks along both sides of inner streets, and the strips that their crowns need."""
    meeting = joints(network)
    every = streets(network)
    rows: list[Street] = []
    for index in rng.permutation(len(every)):
        street = every[int(index)]
        if street not in rows and min(meeting[street.start], meeting[street.end]) == 4:
            rows += [s for s in every if {s.start, s.end} == {street.start, street.end}]
    trunks, strips = np.zeros((0, 2)), []
    for street in rows:
        kerb = shapely.LineString(street.right)
        line = shapely.offset_curve(kerb, -street.side * _BEYOND_KERB)
        found = trees.place_along(line, _TREE_SPACING, rng, keep_free)[: _TREES - len(trunks)]
        if len(found):
            trunks = np.concatenate([trunks, found])
            beside = -street.side * _TREE_STRIP
            strips.append(shapely.buffer(kerb, beside, cap_style="flat", single_sided=True))
    return trunks, strips
