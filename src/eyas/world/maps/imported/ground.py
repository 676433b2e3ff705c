"""Ground of imported towns: each kind in its own material, none over another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from eyas.mesh.flat import flat_polygons
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass
from eyas.world.build.heights import FLOOR_HEIGHT
from eyas.world.build.materials import TEXTURES, material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground, outskirts
from eyas.world.maps.imported.paint import road_paint
from eyas.world.maps.imported.plan import Plan
from eyas.world.osm.features import Features
from eyas.world.roads import painting
from eyas.world.roads.areas import polygons_of, split_on_grid, surface
from eyas.world.roads.wear import road_wear

__all__ = ["add_ground"]

_WATER = Material("water", (0.16, 0.38, 0.50), Surface.WATER)
_WATER_DEPTH = 0.15
"""Depth of water below the road [m]."""
_BELOW_BANK = 0.4
"""How far water reaches below its banks, so that no gap is seen [m]."""

_COVERS: dict[str, tuple[ObjectClass, tuple[Material, ...]]] = {
    "plaza": (ObjectClass.PAVEMENT, (material("paving", (0.98, 0.96, 0.92)),)),
    "path": (ObjectClass.PAVEMENT, (material("concrete", (0.97, 0.93, 0.85)),)),
    "pitch": (ObjectClass.GROUND, (material("asphalt_light", (0.86, 0.55, 0.44)),
                                   material("lawn_mown", (0.86, 0.97, 0.84)))),
    "playground": (ObjectClass.GROUND, (material("sand", (0.98, 0.94, 0.86)),)),
    "sand": (ObjectClass.GROUND, (material("sand"),)),
    "rail": (ObjectClass.GROUND, (material("roof_gravel", (0.74, 0.69, 0.64)),)),
    "park": (ObjectClass.GROUND, (material("lawn_mown"),
                                  material("lawn_mown", (0.93, 0.98, 0.90)))),
    "forest": (ObjectClass.GROUND, (material("lawn", (0.66, 0.73, 0.60)),)),
    "scrub": (ObjectClass.GROUND, (material("lawn", (0.84, 0.86, 0.70)),)),
    "grass": (ObjectClass.GROUND, (material("lawn", (0.97, 0.98, 0.92)),)),
    "farmland": (ObjectClass.GROUND, (material("crops"), material("crops_ripe"),
                                      material("soil"))),
    "soil": (ObjectClass.GROUND, (material("soil"),)),
    "industrial": (ObjectClass.PAVEMENT, (material("concrete", (0.80, 0.79, 0.77)),)),
    "commercial": (ObjectClass.PAVEMENT, (material("paving", (0.90, 0.89, 0.88)),)),
    "residential": (ObjectClass.GROUND, (material("lawn_mown", (0.97, 0.97, 0.90)),
                                         material("lawn_mown", (0.92, 0.96, 0.88)))),
}  # fmt: skip
"""Class and materials of each kind of ground; one material is drawn for each area."""

_YARDS = (
    material("concrete", (0.86, 0.85, 0.83)),
    material("paving", (0.88, 0.87, 0.86)),
    material("clinker", (0.93, 0.90, 0.87)),
    material("asphalt_light", (0.97, 0.96, 0.95)),
)
_RAIL = Material(tint=(0.36, 0.33, 0.31))
_GAUGE = 0.72
"""Half the distance between the rails of a track [m]."""
_RAIL_HEIGHT = 0.12
_SHORTEST_WORN = 30.0
"""Lanes shorter than this have no wear [m]."""


def add_ground(
    builder: SceneBuilder,
    plan: Plan,
    network: RoadNetwork,
    features: Features,
    bays: Sequence[shapely.Polygon],
    rng: np.random.Generator,
) -> None:
    """Add streets with their paint, pavements, water and all other ground.

    Args:
        builder: The builder to add to.
        plan: The plan of the town.
        network: The streets.
        features: Signals and tracks.
        bays: Paint in car parks [m].
        rng: Random numbers of the ground.
    """
    paint = road_paint(network, plan, set(features.signals))
    painted = painting.painted(bays, painting.WHITE)
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint), painted)
    worn = road_wear(_worn(network), rng)
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), worn, ground.asphalt(plan.roads))
    builder.add(ObjectClass.PAVEMENT, ground.pavement(plan.pavement, plan.roads))
    builder.add(ObjectClass.ROAD, ground.asphalt(plan.ground["parking"], light=True))
    for kind, (owner, covers) in _COVERS.items():
        meshes = _covered(plan.ground[kind], covers, rng)
        if meshes:
            builder.add(owner, *meshes)
    builder.add(ObjectClass.PAVEMENT, *_covered(plan.yards, _YARDS, rng))
    nothing, west = shapely.difference(plan.extent, plan.lawn), shapely.Polygon()
    lawn = ground.lawn(plan.extent, nothing, rng, west, 0.0)
    size = plan.extent.bounds[2] - plan.extent.bounds[0], plan.extent.bounds[3] * 2
    builder.add(ObjectClass.GROUND, lawn, outskirts.fields(size, FLOOR_HEIGHT, rng))
    water = plan.ground["water"]
    if not water.is_empty:
        below = shapely.buffer(water, _BELOW_BANK, join_style="mitre")
        below = shapely.intersection(below, plan.extent)
        tile = TEXTURES["water"]
        builder.add(ObjectClass.WATER, surface(below, -_WATER_DEPTH, _WATER, tile))
    if features.rails:
        builder.add(ObjectClass.STRUCTURE, _rails(features))


def _covered(
    shape: shapely.Geometry, covers: tuple[Material, ...], rng: np.random.Generator
) -> list[Mesh]:
    """Return ground whose separate areas each have one of some materials."""
    areas = polygons_of(shape)
    kinds = rng.integers(len(covers), size=len(areas))
    made = []
    for index, cover in enumerate(covers):
        some = [area for area, kind in zip(areas, kinds, strict=True) if kind == index]
        pieces = [piece for area in some for piece in split_on_grid(area)]
        if pieces:
            tile = TEXTURES[cover.texture]
            made.append(flat_polygons(pieces, FLOOR_HEIGHT, cover, tile))
    return made


def _worn(network: RoadNetwork) -> RoadNetwork:
    """Return only those lanes that are long and wide enough to show wear."""
    kept, first, points = [], [0], []
    for lane in range(len(network.lane_width)):
        line = network.lane_points[network.lane_first[lane] : network.lane_first[lane + 1]]
        long = shapely.length(shapely.LineString(line)) >= _SHORTEST_WORN
        if long and network.lane_width[lane] >= 3.0:
            kept.append(lane)
            points.append(line)
            first.append(first[-1] + len(line))
    chosen = np.array(kept, np.int64)
    return replace(
        network,
        lane_points=np.concatenate([np.zeros((0, 2)), *points]),
        lane_first=np.array(first, np.int32),
        lane_width=network.lane_width[chosen],
        lane_speed=network.lane_speed[chosen],
        lane_edge=network.lane_edge[chosen],
        lane_index=network.lane_index[chosen],
    )


def _rails(features: Features) -> Mesh:
    strips = []
    for line in features.rails:
        for side in (-_GAUGE, _GAUGE):
            beside = shapely.offset_curve(line, side)
            strip = shapely.buffer(beside, 0.06, cap_style="flat", quad_segs=2)
            strips += [piece for part in polygons_of(strip) for piece in split_on_grid(part)]
    return flat_polygons(strips, FLOOR_HEIGHT + _RAIL_HEIGHT, _RAIL, 1.0)
