"""Bare layouts: the roads of a map on plain ground, without scenery or anything that hides."""

import numpy as np
import shapely

from eyas.core.rng import stream
from eyas.state.lighting import Horizon
from eyas.state.mesh import Material, Mesh
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground
from eyas.world.land.plain import blob, far_plain, rectangle
from eyas.world.roads import markings, painting
from eyas.world.roads.areas import road_area, surface
from eyas.world.roads.wear import road_wear

__all__ = ["build_bare_scene"]

_PATCHES = 70
_PATCH = (8.0, 34.0)
"""Number and mean radius of the patches of another tint [m]."""
_PALER, _DARKER = 1.06, 0.93
"""Factors on the ground's colour in them."""


def build_bare_scene(
    name: str,
    network: RoadNetwork,
    seed: int,
    floor: tuple[float, float],
    cover: Material,
    horizon: Horizon,
    centre: markings.Centre = markings.Centre.WHITE,
) -> Scene:
    """Return roads on plain ground.

    Args:
        name: Name of the map.
        network: The roads.
        seed: Seed of the map, >= 0.
        floor: Extent of the floor [m].
        cover: Material of the ground.
        horizon: Hills beyond the map.
        centre: The line between the two directions of a road.
    """
    builder = SceneBuilder(name, seed, floor, Terrain.flat(FLOOR_HEIGHT))
    roads = road_area(network)
    paint = markings.road_paint(network, centre=centre, crossings=False)
    wear = road_wear(network, stream(seed, f"{name} road wear"))
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(roads))
    bare = shapely.difference(rectangle(*floor), roads)
    meshes = _patchy(bare, floor, cover, stream(seed, f"{name} ground"))
    builder.add(ObjectClass.GROUND, *meshes, far_plain(floor, cover))
    return builder.build(network, horizon=horizon)


def _patchy(
    area: shapely.Geometry, floor: tuple[float, float], cover: Material, rng: np.random.Generator
) -> list[Mesh]:
    """Return ground with paler and darker patches, so that a camera sees that it moves."""
    made: list[Mesh] = []
    half = 0.5 * np.array(floor)
    for shade in (_PALER, _DARKER):
        middles = rng.uniform(-half, half, (_PATCHES, 2))
        spots = shapely.union_all([blob(at, float(rng.uniform(*_PATCH)), rng) for at in middles])
        red, green, blue = (min(1.0, shade * channel) for channel in cover.tint)
        tinted = Material(cover.texture, (red, green, blue), cover.surface)
        patch = shapely.intersection(area, spots)
        made.append(surface(patch, FLOOR_HEIGHT, tinted, TEXTURES[cover.texture]))
        area = shapely.difference(area, spots)
    return [*made, surface(area, FLOOR_HEIGHT, cover, TEXTURES[cover.texture])]
