"""What lies flat: lawn, asphalt, pavements. Each is cut out of the others, so nothing overlaps."""

from collections.abc import Sequence

import shapely

from eyas.state.mesh import Mesh, concatenate
from eyas.world.materials import TEXTURES, material
from eyas.world.roads import skirt, surface

__all__ = ["FLOOR_HEIGHT", "PAVEMENT_WIDTH", "asphalt", "lawn", "pavement", "pavement_area"]

FLOOR_HEIGHT = -0.1
"""z of the lawn, the original's [m]."""

PAVEMENT_WIDTH = 2.6
"""From the kerb to the lawn [m]."""

_KERB_WIDTH, _KERB_HEIGHT = 0.35, 0.15
_KERB = material("stone", (1.0, 0.95, 0.92))
_PAVING = material("paving")
_CONCRETE = material("concrete")


def pavement_area(blocks: Sequence[shapely.Polygon], cut: shapely.Geometry) -> shapely.Geometry:
    """Return the pavements along the inner side of the kerbs of blocks.

    Args:
        blocks: Ground between kerbs [m].
        cut: Driveways and the like, which interrupt pavements.
    """
    rings = [
        shapely.difference(block, shapely.buffer(block, -PAVEMENT_WIDTH, join_style="mitre"))
        for block in blocks
    ]
    return shapely.difference(shapely.union_all(rings), cut)


def pavement(area: shapely.Geometry, road: shapely.Geometry) -> Mesh:
    """Return raised pavements with kerb stones where they meet the road."""
    kerb = shapely.intersection(area, shapely.buffer(road, _KERB_WIDTH))
    slabs = shapely.difference(area, kerb)
    return concatenate(
        [
            surface(kerb, _KERB_HEIGHT, _KERB, TEXTURES["stone"]),
            surface(slabs, _KERB_HEIGHT, _PAVING, TEXTURES["paving"]),
            skirt(area, FLOOR_HEIGHT, _KERB_HEIGHT, _KERB, TEXTURES["stone"]),
        ]
    )


def asphalt(area: shapely.Geometry, *, light: bool = False) -> Mesh:
    """Return a road surface at z = 0 with its edge down to the floor."""
    kind = "asphalt_light" if light else "asphalt"
    return concatenate(
        [
            surface(area, 0.0, material(kind), TEXTURES[kind]),
            skirt(area, FLOOR_HEIGHT, 0.0, _CONCRETE, TEXTURES["concrete"]),
        ]
    )


def lawn(extent: shapely.Polygon, covered: shapely.Geometry) -> Mesh:
    """Return the floor where nothing else covers it."""
    open_ground = shapely.difference(extent, covered)
    return surface(open_ground, FLOOR_HEIGHT, material("lawn"), TEXTURES["lawn"])
