"""The plan of the farmland."""

from collections.abc import Sequence

import numpy as np
import shapely

from eyas.engine.core.rng import stream
from eyas.engine.state.lighting import Horizon
from eyas.engine.state.mesh import Material
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.roads.areas import road_area
from eyas.engine.world.weather import Season
from eyas.lanes import exact
from eyas.maps.farmland.fields import CROPS, VERGE, FieldLot, lay_out
from eyas.maps.farmland.roads import NAME, ROAD_WIDTH, road_graph
from eyas.maps.land.plain import rectangle
from eyas.maps.plan.library import STREET_KINDS
from eyas.maps.plan.plan import (
    Chance,
    Far,
    Field,
    Flat,
    GroundCover,
    LampLight,
    MapPlan,
    Paint,
    Roadway,
    ThingKind,
    things,
)
from eyas.maps.plants.gardens import scattered

__all__ = ["FLOOR", "MOUNTAINS", "SOIL", "make_plan"]

FLOOR = (982.0, 998.0)  # Extent of the floor, as in the original [m]

SOIL = material("soil", (1.0, 0.90, 0.66))  # The ground between fields
_MEADOW = material("lawn", (0.9, 0.94, 0.84))

MOUNTAINS = Horizon("farmland", height=0.075, ridges=1.0, woods=0.25)
"""What stands beyond the fields."""

_LAMPS_APART = 64.0
"""Along a road, from the first lamp of a link to the second, across the road [m]."""
_FROM_KERB = 1.4
_LIGHT = LampLight(axis=(0.7, 0.0, -1.0), intensity=45.0, cut_off=1.57)
"""The beams lean over the road, as in the original."""
_BALES_APART, _BALES = 17.0, 0.0035
"""Least distance between bales of hay [m], and number of attempts on a square metre."""
_SEASONS = (Season.SUMMER, Season.WINTER)  # Seasons in which crops differ
_FROM_EDGE = 7.0  # From the edge of a field to its bales [m]


def make_plan(network: RoadNetwork, seed: int) -> MapPlan:
    """Return the plan of the farmland.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
    """
    nodes = [(node.x, node.y) for node in road_graph(seed).nodes]
    x, y = (sorted(set(places)) for places in zip(*nodes, strict=True))
    roads = road_area(network)
    # Kerbs are round at the corners, and so are the verges.
    verge = shapely.buffer(roads, VERGE - 0.01)
    lots = lay_out(x, y, stream(seed, "farmland fields"))
    areas = [shapely.difference(lot.area, verge) for lot in lots]
    fields = [_field(lot, area) for lot, area in zip(lots, areas, strict=True)]
    # Tan fields are harvested.
    harvested = [
        area for lot, area in zip(lots, areas, strict=True) if CROPS[lot.crop].name == "tan"
    ]
    covered = shapely.union(roads, shapely.union_all(areas))
    soil = Flat(area=shapely.difference(rectangle(*FLOOR), covered), cover=SOIL)
    return MapPlan(
        name=NAME,
        seed=seed,
        size=FLOOR,
        library=(ThingKind(name="bale"), *STREET_KINDS),
        layers=(
            Roadway(area=roads, paint=Paint(crossings=0), wear=Chance(stream="farmland road wear")),
            GroundCover(pieces=tuple(fields)),
            GroundCover(pieces=(soil, _far_fields())),
            things(_bales(harvested, CROPS[2].height, stream(seed, "farmland bales")), ("bale",)),
            things(_lamps(network, seed)),
        ),
        lamps=_LIGHT,
        horizon=MOUNTAINS,
    )


def _field(lot: FieldLot, area: shapely.Polygon) -> Field:
    crop = CROPS[lot.crop]
    summer, winter = (_shaded(crop.look(season), lot.shade) for season in _SEASONS)
    return Field(area=area, z=crop.height, cover=summer, winter=winter, north=lot.north)


def _shaded(look: Material, shade: float) -> Material:
    red, green, blue = (shade * part for part in look.tint)
    return Material(look.texture, (red, green, blue), look.surface)


def _far_fields() -> Far:
    """Return larger fields of the same crops, up to the mountains."""
    summer, winter = ((SOIL, _MEADOW, *(crop.look(one) for crop in CROPS)) for one in _SEASONS)
    shares = (0.24, 0.2, *(0.56 * crop.share for crop in CROPS))
    chance = Chance(stream="farmland far fields")
    return Far(rule="fields", covers=summer, winter=winter, shares=shares, chance=chance)


def _bales(areas: Sequence[shapely.Polygon], z: float, rng: np.random.Generator) -> list[Placed]:
    """Return bales of hay on some of the harvested fields, at the height of the stubble."""
    made = []
    for area in areas:
        if rng.random() < 0.5:
            continue
        room = shapely.buffer(area, -_FROM_EDGE)
        for x, y in scattered(room, _BALES_APART, _BALES, rng).tolist():
            made.append(Placed("bale", x, y, z, float(rng.uniform(0, np.pi))))
    return made


def _lamps(network: RoadNetwork, seed: int) -> list[Placed]:
    """Return two lamps at each link, their arms over the road."""
    at = {node.name: np.array([node.x, node.y]) for node in road_graph(seed).nodes}
    places = []
    for start, end in zip(network.edge_start, network.edge_end, strict=True):
        along = at[end] - at[start]
        onwards = along / np.abs(along).sum()  # along an axis
        leftwards = np.array([-onwards[1], onwards[0]])
        # One for each direction: beyond the middle of the link, on the right.
        middle = at[start] + along / 2 + _LAMPS_APART / 2 * onwards
        foot = middle - (ROAD_WIDTH / 2 + _FROM_KERB) * leftwards
        turn = float(exact.atan2(*leftwards[::-1]))
        places.append(Placed.at("street lamp", foot, 0.0, turn))
    return places
