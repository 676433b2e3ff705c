"""The ground of downtown: pavements with broad pale kerbs, courts, the park, the land around."""

import numpy as np
import shapely

from eyas.core.rng import stream
from eyas.mesh.assembly import concatenate
from eyas.mesh.flat import quads
from eyas.state.mesh import Material, Mesh, Surface
from eyas.state.roads import RoadNetwork
from eyas.state.scene import ObjectClass
from eyas.world.build import materials
from eyas.world.build.heights import FLOOR_HEIGHT, KERB_HEIGHT
from eyas.world.build.materials import TEXTURES, material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.land import ground
from eyas.world.maps.downtown.plan import EXTENT, FLOOR, Plan
from eyas.world.roads import markings, painting
from eyas.world.roads import wear as road_wear
from eyas.world.roads.areas import skirt, surface

__all__ = ["add_surfaces"]

_KERB_WIDTH = 0.8
"""As wide as the original's [m]."""
_KERB = material("paving", (1.0, 0.94, 0.90))
_SLABS = material("paving", (0.84, 0.91, 0.95))
_COURT = material("concrete", (0.97, 0.97, 0.93))
_TRAIL = material("asphalt_light", (1.0, 0.97, 0.90))
_RIM = material("stone", (0.98, 0.95, 0.92))
_WATER = Material("water", (0.16, 0.42, 0.54), Surface.WATER)
_STONES = material("stone", (0.80, 0.78, 0.76))
_WALL, _WALL_TOP = 0.5, 1.0
"""Thickness of the wall around the park, and z of its top [m]."""
_LAND = (
    material("concrete", (0.90, 0.90, 0.87)),
    material("concrete", (0.80, 0.80, 0.79)),
    material("asphalt_light", (1.0, 0.99, 0.96)),
    material("lawn", (0.84, 0.90, 0.80)),
)
"""What covers the land around: courts, yards, car parks, some lawn."""
_LAND_LINES = (1000.0, 1400.0, 2100.0, 3200.0, 5000.0, 10000.0)
_BELOW = 0.05
"""Depth of the land below the floor, so that rounding never makes it show through [m]."""


def add_surfaces(builder: SceneBuilder, plan: Plan, network: RoadNetwork, seed: int) -> None:
    """Add paint, roads, pavements, courts, the park and the land around."""
    park, rng = plan.park, stream(seed, "downtown lawn")
    bays = shapely.difference(plan.kerbs.bays, plan.roads)
    asphalt = shapely.union(plan.roads, bays)
    paint = markings.road_paint(network)
    lines = painting.painted(plan.kerbs.lines, painting.WHITE)
    builder.add(ObjectClass.MARKING, painting.mesh_of(paint), lines)
    wear = road_wear.road_wear(network, stream(seed, "downtown road wear"))
    smooth = [ground.asphalt(plan.roads), ground.asphalt(bays, light=True)]
    builder.add(ObjectClass.ROAD, painting.margins_of(paint), wear, *smooth)
    builder.add(ObjectClass.PAVEMENT, _pavement(plan.pavement, asphalt, plan.grid.turn))
    wet = shapely.union(park.water, park.rim)
    green = shapely.difference(park.ground, shapely.union_all([park.walk, park.paths, wet]))
    nowhere = shapely.Polygon()
    builder.add(
        ObjectClass.GROUND,
        ground.lawn(park.ground, shapely.difference(EXTENT, green), rng, nowhere, 0.0),
    )
    builder.add(
        ObjectClass.PAVEMENT, surface(park.paths, FLOOR_HEIGHT, _TRAIL, TEXTURES["asphalt_light"])
    )
    builder.add(ObjectClass.PAVEMENT, _pavement(park.rim, nowhere, 0.0, _RIM))
    for pond in shapely.get_parts(park.water):
        water = surface(pond, -0.15, _WATER, materials.TEXTURES["water"])
        builder.add(ObjectClass.WATER, water)
    builder.add(ObjectClass.STRUCTURE, _park_wall(plan))
    covered = shapely.union_all([plan.roads, bays, plan.pavement, park.ground])
    rest = shapely.difference(EXTENT, covered)
    court = surface(rest, FLOOR_HEIGHT, _COURT, TEXTURES["concrete"], plan.grid.turn)
    builder.add(ObjectClass.GROUND, court, _land(rng))


def _pavement(
    area: shapely.Geometry, road: shapely.Geometry, turn: float, slabs: Material = _SLABS
) -> Mesh:
    """Return raised pavements with kerb stones where they meet the asphalt."""
    kerb = shapely.intersection(area, shapely.buffer(road, _KERB_WIDTH))
    inside = shapely.difference(area, kerb)
    return concatenate(
        [
            surface(kerb, KERB_HEIGHT, _KERB, TEXTURES["paving"], turn),
            surface(inside, KERB_HEIGHT, slabs, TEXTURES[slabs.texture], turn),
            skirt(area, FLOOR_HEIGHT, KERB_HEIGHT, _KERB, TEXTURES["paving"]),
        ]
    )


def _park_wall(plan: Plan) -> Mesh:
    """Return the low wall between the streets and the park, with gaps where paths enter."""
    park = plan.park
    line = shapely.intersection(shapely.buffer(park.walk, _WALL, join_style="mitre"), park.ground)
    gates = shapely.buffer(park.paths, 0.6)
    wall = shapely.difference(line, shapely.union(park.walk, gates))
    return concatenate(
        [
            surface(wall, _WALL_TOP, _RIM, TEXTURES["stone"], plan.grid.turn),
            skirt(wall, FLOOR_HEIGHT, _WALL_TOP, _STONES, TEXTURES["stone"]),
        ]
    )


def _land(rng: np.random.Generator) -> Mesh:
    """Return the land around the floor up to the horizon, in large patches."""
    x = np.array([*(-np.array(_LAND_LINES[::-1])), -330.0, 330.0, *_LAND_LINES])
    y = np.where(np.abs(x) == _LAND_LINES[0], np.sign(x) * 0.5 * FLOOR[1], x)
    east, north = np.meshgrid(x, y, indexing="ij")
    corner = np.stack([east, north, np.full_like(east, FLOOR_HEIGHT - _BELOW)], axis=-1)
    cells = np.stack(
        [corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]], axis=2
    ).reshape(-1, 4, 3)
    middle = np.abs(cells[..., :2].mean(axis=1))
    cells = cells[(middle[:, 0] > 0.5 * FLOOR[0]) | (middle[:, 1] > 0.5 * FLOOR[1])]
    kind = rng.choice(len(_LAND), size=len(cells), p=(0.34, 0.26, 0.2, 0.2))
    made = []
    for index, cover in enumerate(_LAND):
        some = cells[kind == index]
        made.append(quads(some, some[..., :2] / TEXTURES[cover.texture], cover))
    return concatenate(made)
