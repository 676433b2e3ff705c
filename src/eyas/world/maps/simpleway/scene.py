"""The scene of the simple maps: roads, and the ground of a skin."""

from dataclasses import replace

import shapely

from eyas.core.rng import stream
from eyas.mesh.flat import flat_polygons
from eyas.state.mesh import Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground
from eyas.world.land.plain import blob, far_plain, plain, rectangle
from eyas.world.maps.simpleway.drifts import sand_bars
from eyas.world.maps.simpleway.roads import NAME, is_loop, road_lines
from eyas.world.maps.simpleway.skins import SKINS, Skin
from eyas.world.roads import markings, painting
from eyas.world.roads.areas import corridors, streets
from eyas.world.roads.curves import rounded_kerbs
from eyas.world.roads.wear import road_wear
from eyas.world.weather import Season

__all__ = ["FLOOR", "build_scene", "paved"]

FLOOR = (7000.0, 5000.0)
"""Extent of the floor, as in the original [m]."""

_NEAR = 80.0
"""Reach of the ground that is cut into small squares beside a road [m]."""
_BANK = 2.5
"""Bare ground between a road and a strip, at least [m]."""
_SPOTS = 320
_SPOT = (8.0, 40.0)
"""Number and mean radius of the patches of another tint [m]."""
_DRIFTS = ((0.975, 0.98, 0.985), (0.985, 0.985, 0.98))
"""Their tints in snow: no grass shows through it."""


def build_scene(skin_name: str, network: RoadNetwork, seed: int, season: Season) -> Scene:
    """Return a simple map.

    Args:
        skin_name: One of `SKINS`.
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
        season: Season of the ground.
    """
    skin, roads = SKINS[skin_name], paved(network)
    if season is Season.WINTER and not skin.bars:  # sand stays bare
        skin = replace(skin, ground=skin.winter, tints=_DRIFTS)
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    _add_roads(builder, network, roads, seed)
    if skin.bars:
        bars = sand_bars(road_lines(seed), roads, stream(seed, "simpleway bars"))
        builder.add(
            ObjectClass.GROUND,
            flat_polygons(bars, 0.03, skin.ground, TEXTURES[skin.ground.texture]),
        )
    rest = shapely.difference(rectangle(*FLOOR), roads)
    banks, near = shapely.buffer(roads, _BANK), shapely.buffer(roads, _NEAR, join_style="mitre")
    patches = skin.patches(road_lines(seed), season, stream(seed, "simpleway strips"))
    for patch in patches:
        kind = patch.cover.surface == Surface.WATER
        area = shapely.difference(patch.area, banks)
        builder.add(
            ObjectClass.WATER if kind else ObjectClass.GROUND, plain(area, near, patch.cover)
        )
        rest = shapely.difference(rest, area)
    builder.add(
        ObjectClass.GROUND, *_spotted(rest, near, skin, seed), far_plain(FLOOR, skin.ground)
    )
    return builder.build(network, horizon=skin.horizon)


def paved(network: RoadNetwork) -> shapely.Geometry:
    """Return the asphalt [m]."""
    return rounded_kerbs(corridors(network), [])


def _add_roads(
    builder: SceneBuilder, network: RoadNetwork, roads: shapely.Geometry, seed: int
) -> None:
    paint = replace(markings.road_paint(network), zebras=[])
    # A line runs along the inner edge of a loop; `road_paint` draws it on one half only.
    for edge, street in zip(network.edges, streets(network), strict=True):
        if is_loop(edge):
            paint.lines.extend(painting.stripes(street.left, 0.2))
    wear = road_wear(network, stream(seed, "simpleway road wear"), apart=5.0)
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(roads))


def _spotted(area: shapely.Geometry, near: shapely.Geometry, skin: Skin, seed: int) -> list[Mesh]:
    """Return the ground, with patches of other tints along the roads."""
    rng = stream(seed, "simpleway spots")
    count = len(skin.tints)
    spots: list[list[shapely.Polygon]] = [[] for _ in range(count)]
    lines = road_lines(seed)
    for index in range(_SPOTS):
        south, north = lines[int(rng.integers(len(lines)))]
        middle = south + rng.random() * (north - south) + rng.uniform(-60.0, 60.0, 2)
        spots[index % count].append(blob(middle, float(rng.uniform(*_SPOT)), rng))
    made, rest = [], area
    for tint, shapes in zip(skin.tints, spots, strict=True):
        some = shapely.union_all(shapes)
        red, green, blue = (a * b for a, b in zip(skin.ground.tint, tint, strict=True))
        cover = replace(skin.ground, tint=(red, green, blue))
        made.append(plain(shapely.intersection(rest, some), near, cover))
        rest = shapely.difference(rest, some)
    return [*made, plain(rest, near, skin.ground)]
