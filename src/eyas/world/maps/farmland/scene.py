"""The scene of the farmland."""

from dataclasses import replace

import numpy as np
import shapely

from eyas.core import exact
from eyas.core.rng import stream
from eyas.state.lighting import Horizon
from eyas.state.mesh import Mesh
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES, material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground, outskirts
from eyas.world.land.plain import rectangle
from eyas.world.maps.farmland.fields import CROPS, VERGE, Field, field_mesh, lay_out
from eyas.world.maps.farmland.roads import NAME, ROAD_WIDTH, road_graph
from eyas.world.roads import markings, painting
from eyas.world.roads.areas import road_area, surface
from eyas.world.roads.wear import road_wear
from eyas.world.street.hay import add_bales
from eyas.world.street.lamps import add_lamps_at
from eyas.world.weather import Season

__all__ = ["FLOOR", "MOUNTAINS", "SOIL", "build_scene"]

FLOOR = (982.0, 998.0)
"""Extent of the floor, as in the original [m]."""

SOIL = material("soil", (1.0, 0.90, 0.66))
"""The ground between fields."""
_MEADOW = material("lawn", (0.9, 0.94, 0.84))
MOUNTAINS = Horizon("farmland", height=0.075, ridges=1.0, woods=0.25)
"""What stands beyond the fields."""
_LAMPS_APART = 64.0
"""Along a road, from the first lamp of a link to the second, across the road [m]."""
_FROM_KERB = 1.4
_LEAN = (0.7, 0.0, -1.0)
"""Axis of the lamps' beams over the road, not of length 1, as in the original."""


def build_scene(network: RoadNetwork, seed: int, season: Season) -> Scene:
    """Return the farmland in a season.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
        season: Season of the crops.
    """
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    x, y = (sorted(set(places)) for places in zip(*_nodes(seed), strict=True))
    # Kerbs are round at the corners, and so are the verges.
    verge = shapely.buffer(road_area(network), VERGE - 0.01)
    fields = [
        replace(field, area=shapely.difference(field.area, verge))
        for field in lay_out(x, y, stream(seed, "farmland fields"))
    ]
    _add_roads(builder, network, seed)
    crops = shapely.union_all([field.area for field in fields])
    builder.add(ObjectClass.GROUND, *(field_mesh(field, season) for field in fields))
    soil = _soil(shapely.union(road_area(network), crops))
    builder.add(ObjectClass.GROUND, soil, _far_fields(season, seed))
    add_bales(builder, _stubble(fields), CROPS[2].height, stream(seed, "farmland bales"))
    lamps = add_lamps_at(builder, _lamp_places(network, seed), _LEAN)
    return builder.build(network, replace(lamps, intensity=45.0, cut_off=1.57), MOUNTAINS)


def _nodes(seed: int) -> list[tuple[float, float]]:
    return [(node.x, node.y) for node in road_graph(seed).nodes]


def _add_roads(builder: SceneBuilder, network: RoadNetwork, seed: int) -> None:
    """Add the roads, which have no crossings for people."""
    paint = replace(markings.road_paint(network), zebras=[])
    wear = road_wear(network, stream(seed, "farmland road wear"))
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint))
    asphalt = ground.asphalt(road_area(network))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, asphalt)


def _soil(covered: shapely.Geometry) -> Mesh:
    """Return the soil of the floor where nothing else covers it."""
    bare = shapely.difference(rectangle(*FLOOR), covered)
    return surface(bare, FLOOR_HEIGHT, SOIL, TEXTURES["soil"])


def _far_fields(season: Season, seed: int) -> Mesh:
    """Return larger fields of the same crops, up to the mountains."""
    crops = [(SOIL, 0.24), (_MEADOW, 0.2)]
    crops += [(crop.look(season), 0.56 * crop.share) for crop in CROPS]
    rng = stream(seed, "farmland far fields")
    return outskirts.fields(FLOOR, FLOOR_HEIGHT, rng, crops)


def _stubble(fields: list[Field]) -> list[shapely.Polygon]:
    """Return the tan fields, which are harvested."""
    return [field.area for field in fields if CROPS[field.crop].name == "tan"]


def _lamp_places(network: RoadNetwork, seed: int) -> list[tuple[tuple[float, float], float]]:
    """Return the foot [m] of two lamps at each link, and the direction of their arms [rad]."""
    at = {node.name: np.array([node.x, node.y]) for node in road_graph(seed).nodes}
    places = []
    for start, end in zip(network.edge_start, network.edge_end, strict=True):
        along = at[end] - at[start]
        onwards = along / np.abs(along).sum()  # along an axis
        leftwards = np.array([-onwards[1], onwards[0]])
        # One for each direction: beyond the middle of the link, on the right.
        middle = at[start] + along / 2 + _LAMPS_APART / 2 * onwards
        foot = middle - (ROAD_WIDTH / 2 + _FROM_KERB) * leftwards
        places.append(((float(foot[0]), float(foot[1])), float(exact.atan2(*leftwards[::-1]))))
    return places
