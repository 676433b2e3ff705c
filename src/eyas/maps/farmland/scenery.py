"""Scenery of the farmland: what grows on the fields and beyond them, bales of hay, lamps."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.placed import Placed
from eyas.engine.world.weather import Season
from eyas.lanes import exact
from eyas.maps.farmland.layout import CROPS, FieldLot
from eyas.maps.farmland.roads import ROAD_WIDTH, road_graph
from eyas.maps.plan.plan import Chance, Far, Field
from eyas.maps.plants.gardens import scattered

SOIL = material("soil", (1.0, 0.96, 0.90))
_MEADOW = material("lawn", (0.96, 0.92, 0.88))
BALK = _MEADOW  # The ground between fields
DITCH = material("soil", (0.30, 0.32, 0.26))  # Wet earth and weeds around fields
SHOULDER = replace(_MEADOW, surface=Surface.HILLSIDE_VERGE)
_LAMPS_APART = 64.0
"""Along a road, from the first lamp of a link to the second, across the road [m]."""
_FROM_KERB = 1.4
_BALES_APART, _BALES = 17.0, 0.0035
"""Least distance between bales of hay [m], and number of attempts on a square metre."""
_FROM_EDGE = 7.0  # Distance from the edge of a field to its bales [m]
_SEASONS = (Season.SUMMER, Season.WINTER)  # Seasons in which crops differ


def field(lot: FieldLot, area: shapely.Polygon) -> Field:
    """Return a field with its crop, in both seasons."""
    crop = CROPS[lot.crop]
    summer, winter = (_shaded(crop.look(season), lot.shade) for season in _SEASONS)
    return Field(area=area, z=crop.height, cover=summer, winter=winter, north=lot.north)


def _shaded(look: Material, shade: float) -> Material:
    red, green, blue = (shade * part for part in look.tint)
    return Material(look.texture, (red, green, blue), look.surface)


def far_fields() -> Far:
    """Return larger fields of the same crops, up to the mountains."""
    summer, winter = ((SOIL, _MEADOW, *(crop.look(one) for crop in CROPS)) for one in _SEASONS)
    shares = (0.1, 0.34, *(0.56 * crop.share for crop in CROPS))
    chance = Chance(stream="farmland far fields")
    return Far(rule="fields", covers=summer, winter=winter, shares=shares, chance=chance)


def bales(areas: Sequence[shapely.Polygon], z: float, rng: np.random.Generator) -> list[Placed]:
    """Return bales of hay on some of the harvested fields, at the height of the stubble."""
    made = []
    for area in areas:
        if rng.random() < 0.5:
            continue
        room = shapely.buffer(area, -_FROM_EDGE)
        for x, y in scattered(room, _BALES_APART, _BALES, rng).tolist():
            made.append(Placed("bale", x, y, z, float(rng.uniform(0, np.pi))))
    return made


def lamps_of(network: RoadNetwork, seed: int) -> list[Placed]:
    """Return two lamps at each link, their arms over the road."""
    at = {node.name: np.array([node.x, node.y]) for node in road_graph(seed).nodes}
    places, side = [], -1.0 if network.left_hand else 1.0
    for start, end in zip(network.edge_start, network.edge_end, strict=True):
        along = at[end] - at[start]
        onwards = along / np.abs(along).sum()  # along an axis
        inwards = side * np.array([-onwards[1], onwards[0]])
        # One for each direction: beyond the middle of the link, at its own kerb.
        middle = at[start] + along / 2 + _LAMPS_APART / 2 * onwards
        foot = middle - (ROAD_WIDTH / 2 + _FROM_KERB) * inwards
        turn = float(exact.atan2(*inwards[::-1]))
        places.append(Placed.at("street lamp", foot, 0.0, turn))
    return places
