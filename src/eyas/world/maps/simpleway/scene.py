"""The scene of the simple maps: roads, and the ground of a skin."""

from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core.rng import stream
from eyas.mesh.flat import flat_polygons
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.state.terrain import Terrain
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES
from eyas.world.build.millimetres import rounded
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground
from eyas.world.maps.simpleway.drifts import sand_bars
from eyas.world.maps.simpleway.roads import NAME, is_loop, road_lines
from eyas.world.maps.simpleway.skins import SKINS, Skin
from eyas.world.roads import markings
from eyas.world.roads.areas import corridors, split_on_grid, streets
from eyas.world.roads.curves import rounded_kerbs
from eyas.world.roads.wear import road_wear
from eyas.world.weather import Season

__all__ = ["FLOOR", "build_scene", "paved"]

FLOOR = (7000.0, 5000.0)
"""Extent of the floor, as in the original [m]."""

_CELL = 128.0
"""Side of the squares into which the ground is cut [m]."""
_FAR, _FAR_CELL = 14_000.0, 1750.0
"""The ground goes on to this distance, in larger squares [m]."""
_BELOW = 0.05
_BANK = 2.5
"""Bare ground between a road and a strip, at least [m]."""
_SPOTS = 700
_SPOT = (8.0, 40.0)
"""Number and mean radius of the patches of another tint [m]."""


def build_scene(skin_name: str, network: RoadNetwork, seed: int, season: Season) -> Scene:
    """Return a simple map.

    Args:
        skin_name: One of `SKINS`.
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
        season: Season of the ground.
    """
    skin, roads = SKINS[skin_name], paved(network)
    builder = SceneBuilder(NAME, seed, FLOOR, Terrain.flat(FLOOR_HEIGHT))
    _add_roads(builder, network, roads, seed)
    if skin.bars:
        bars = sand_bars(road_lines(seed), roads, stream(seed, "simpleway bars"))
        builder.add(ObjectClass.GROUND, flat_polygons(bars, 0.03, skin.ground, _tile(skin.ground)))
    rest = shapely.difference(shapely.box(*_bounds(*FLOOR)), roads)
    banks = shapely.buffer(roads, _BANK)
    patches = skin.patches(road_lines(seed), season, stream(seed, "simpleway strips"))
    for patch in patches:
        kind = patch.cover.surface == Surface.WATER
        area = shapely.difference(patch.area, banks)
        builder.add(ObjectClass.WATER if kind else ObjectClass.GROUND, _wide(area, patch.cover))
        rest = shapely.difference(rest, area)
    builder.add(ObjectClass.GROUND, *_spotted(rest, skin, seed), _far(skin.ground))
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
            paint.lines.extend(markings.stripes(street.left, 0.2))
    wear = road_wear(network, stream(seed, "simpleway road wear"))
    builder.add(ObjectClass.MARKING, markings.mesh_of(paint))
    builder.add(ObjectClass.ROAD, markings.margins_of(paint), wear, ground.asphalt(roads))


def _spotted(area: shapely.Geometry, skin: Skin, seed: int) -> list[Mesh]:
    """Return the ground, with patches of other tints along the roads."""
    rng = stream(seed, "simpleway spots")
    count = len(skin.tints)
    spots: list[list[shapely.Polygon]] = [[] for _ in range(count)]
    lines = road_lines(seed)
    for index in range(_SPOTS):
        south, north = lines[int(rng.integers(len(lines)))]
        middle = south + rng.random() * (north - south) + rng.uniform(-60.0, 60.0, 2)
        spots[index % count].append(_blob(middle, float(rng.uniform(*_SPOT)), rng))
    made, rest = [], area
    for tint, shapes in zip(skin.tints, spots, strict=True):
        some = shapely.union_all(shapes)
        red, green, blue = (a * b for a, b in zip(skin.ground.tint, tint, strict=True))
        cover = replace(skin.ground, tint=(red, green, blue))
        made.append(_wide(shapely.intersection(rest, some), cover))
        rest = shapely.difference(rest, some)
    return [*made, _wide(rest, skin.ground)]


def _blob(middle: NDArray[np.float64], size: float, rng: np.random.Generator) -> shapely.Polygon:
    """Return a round patch with an uneven outline."""
    angle = np.linspace(0.0, 2 * np.pi, 18, endpoint=False)
    phase, swing = rng.uniform(0, 2 * np.pi, (3, 1)), rng.uniform(0.05, 0.16, (3, 1))
    waves = 1.0 + (swing * np.sin(angle * [[1], [2], [3]] + phase)).sum(axis=0)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return shapely.Polygon(rounded(middle + size * waves[:, None] * ring))


def _far(cover: Material) -> Mesh:
    """Return the ground beyond the floor, slightly below it so that it never shows through."""
    ring = shapely.difference(
        shapely.box(*_bounds(2 * _FAR, 2 * _FAR)), shapely.box(*_bounds(*FLOOR))
    )
    return flat_polygons(split_on_grid(ring, _FAR_CELL), FLOOR_HEIGHT - _BELOW, cover, _tile(cover))


def _wide(area: shapely.Geometry, cover: Material) -> Mesh:
    return flat_polygons(split_on_grid(area, _CELL), FLOOR_HEIGHT, cover, _tile(cover))


def _tile(cover: Material) -> float:
    return TEXTURES[cover.texture]


def _bounds(east_west: float, north_south: float) -> tuple[float, float, float, float]:
    return -east_west / 2, -north_south / 2, east_west / 2, north_south / 2
