"""The scene of the desert."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.core import exact
from eyas.core.rng import stream
from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import flat_polygons, quads
from eyas.mesh.panels import cells, closed
from eyas.state.lighting import Horizon
from eyas.state.mesh import Mesh
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass, Scene
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES
from eyas.world.build.millimetres import rounded
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.buildings.cottages import add_cottages
from eyas.world.land import ground
from eyas.world.land.cut import cut
from eyas.world.land.facets import Relief, relief, surface_of, terrain_of
from eyas.world.land.mounds import Mound, highest
from eyas.world.land.plain import far_plain
from eyas.world.maps.desert.looks import DUSTY, HOUSES, SAND, SNOW, THIN_SNOW
from eyas.world.maps.desert.plan import EXTENT, FLOOR, HALF, Plan, make_plan
from eyas.world.maps.desert.roads import NAME
from eyas.world.roads import markings, painting
from eyas.world.roads import wear as road_wear
from eyas.world.roads.areas import surface
from eyas.world.street.lamps import add_lamps
from eyas.world.street.signals import add_signals, signal_places
from eyas.world.weather import Season

__all__ = ["DRIFT_HEIGHT", "DUNES", "build_scene"]

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
_SLOPE = 1.4
"""Width of the slope around a heap of sand [m]."""

_SNOWED = 22
"""Number of dunes under snow in winter, as in the original."""
_SNOW_LINES = (2.5, 6.0)
"""Heights from which thin and closed snow lies on them [m]."""
_MARGINS = (0.0, 2.5)
"""How much higher than a dune beside it a white one is there [m]."""
_WAVE = 1.5
"""By how much the lines rise and fall [m]."""


def build_scene(network: RoadNetwork, seed: int, season: Season) -> Scene:
    """Return the desert.

    Args:
        network: Made of `road_graph(seed)`.
        seed: Seed of the map, >= 0.
        season: In winter, nearly every second dune is white; the ground is not.
    """
    plan = make_plan(network, seed)
    dunes = _relief(plan, stream(seed, "desert facets"))
    builder = SceneBuilder(NAME, seed, FLOOR, terrain_of(dunes, FLOOR_HEIGHT, HALF))
    white = _white(plan.dunes, season, stream(seed, "desert snow"))
    sloping, cover = _snowed(dunes, plan.dunes, white)
    sides = surface_of(sloping, FLOOR_HEIGHT, (SAND, THIN_SNOW, SNOW), cover, smooth=True)
    builder.add(ObjectClass.GROUND, sides)
    add_cottages(builder, plan.houses, HOUSES)
    _add_ground(builder, plan, network, dunes.area, seed)
    add_signals(builder, network)
    poles = shapely.buffer(shapely.points([place for place, _ in signal_places(network)]), 2.0)
    taken = shapely.union_all([plan.roads, plan.walls, *poles])
    lights = add_lamps(builder, network, _LAMPS, taken, stream(seed, "desert lamps"))
    return builder.build(network, lights, DUNES)


def _relief(plan: Plan, rng: np.random.Generator) -> Relief:
    """Return the dunes as triangles."""
    flat = shapely.union(shapely.buffer(plan.roads, 5.0), shapely.buffer(plan.walls, 3.0))

    def heights(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return highest(plan.dunes, points)[0]

    return relief(heights, (_CORE, HALF), _SPACING, flat, rng)


def _white(dunes: Sequence[Mound], season: Season, rng: np.random.Generator) -> set[int]:
    """Return which dunes are white: about every second."""
    if season is not Season.WINTER:
        return set()
    share = _SNOWED / len(dunes)
    kept = np.floor(share * np.arange(len(dunes) + 1) + rng.uniform())
    return set(np.flatnonzero(np.diff(kept) > 0).tolist())


def _snowed(
    ground_: Relief, dunes: Sequence[Mound], white: set[int]
) -> tuple[Relief, NDArray[np.intp]]:
    """Cut the relief where snow begins; return it and what covers each triangle: sand, thin, snow.

    Snow lies where a white dune is the highest, above lines that rise and fall along its foot.
    """
    points = ground_.points
    own, _ = highest([dunes[index] for index in sorted(white)], points[:, :2])
    others, _ = highest([d for index, d in enumerate(dunes) if index not in white], points[:, :2])
    over = points[:, 2] + _WAVE * exact.sin(0.11 * points[:, 0]) * exact.sin(0.13 * points[:, 1])
    thin, closed_ = (
        np.minimum(own - others - margin, over - line)
        for line, margin in zip(_SNOW_LINES, _MARGINS, strict=True)
    )
    levels = rounded(np.column_stack([thin, closed_]))
    for which in range(2):
        ground_, levels = cut(ground_, levels, which)
    return ground_, (levels[ground_.triangles].mean(axis=1) > 0).sum(axis=1)


def _heap(area: shapely.Polygon, top: float) -> Mesh:
    """Return a flat heap of sand, whose sides slope down to the ground.

    Args:
        area: Its top in plan view [m].
        top: z of its top [m].
    """
    rim = shapely.get_coordinates(shapely.geometry.polygon.orient(area).exterior)[:-1]
    ahead = np.roll(rim, -1, axis=0) - np.roll(rim, 1, axis=0)
    away = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1)
    foot = rim + _SLOPE * away / np.linalg.norm(away, axis=1, keepdims=True)
    low = np.column_stack([foot, np.full(len(foot), FLOOR_HEIGHT - 0.02)])
    high = np.column_stack([rim, np.full(len(rim), top)])
    sides = cells(closed([low, high]))
    tile = TEXTURES[SAND.texture]
    return concatenate(
        [quads(sides, sides[..., :2] / tile, SAND), flat_polygons([area], top, SAND, tile)]
    )


def _add_ground(
    builder: SceneBuilder, plan: Plan, network: RoadNetwork, dunes: shapely.Geometry, seed: int
) -> None:
    paint = markings.road_paint(network, crossings=False)
    sand = shapely.union_all([drift.area for drift in plan.drifts])
    dusty = shapely.union_all([drift.fringe for drift in plan.drifts])
    edge = shapely.intersection(shapely.difference(dusty, sand), plan.roads)
    tile = TEXTURES["sand"]
    builder.add(
        ObjectClass.GROUND,
        *(_heap(drift.area, DRIFT_HEIGHT) for drift in plan.drifts),
        *(_heap(tongue, _FRINGE_HEIGHT) for tongue in plan.tongues),
        flat_polygons([edge], _FRINGE_HEIGHT, DUSTY, TEXTURES[DUSTY.texture]),
    )
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint))
    wear = road_wear.road_wear(network, stream(seed, "desert road wear"))
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, ground.asphalt(plan.roads))
    # Slightly below the feet of the dunes, so that rounding leaves no gap between them.
    rest = shapely.buffer(dunes, -0.4, join_style="mitre")
    level = shapely.difference(EXTENT, shapely.union(plan.roads, rest))
    builder.add(
        ObjectClass.GROUND,
        surface(level, FLOOR_HEIGHT, SAND, tile),
        far_plain((2 * HALF, 2 * HALF), SAND),
    )
