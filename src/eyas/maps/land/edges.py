"""Ground that changes along an edge: u is the distance from it, see
`eyas.engine.state.mesh.Surface`.
"""

from itertools import pairwise

import numpy as np
import shapely

from eyas.engine.mesh.flat import flat_polygons
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.millimetres import snapped
from eyas.engine.world.roads.areas import polygons_of, split_on_grid

__all__ = ["edged"]

_CELL = 64.0  # Side of the squares into which it is cut [m]
_RINGS = (0.0, 1.2, 3.0, 6.0, 10.0)
_INSETS = (0.0, 0.35)
"""Distances where it is cut too, so that u is right between them [m]: from what it lies beside,
and from its own edge."""


def edged(
    area: shapely.Geometry, beside: shapely.Geometry | None, cover: Material, z: float
) -> Mesh:
    """Return level ground of a material whose u is a distance.

    Args:
        area: The ground [m].
        beside: From what the distance is measured; None: from the edge of the area inwards.
        z: Its height [m].
    """
    if beside is None:
        edge, rings = shapely.boundary(area), [shapely.buffer(area, -inset) for inset in _INSETS]
        rings = [*rings, shapely.Polygon()]
    else:
        edge = beside
        rings = [
            shapely.difference(area, shapely.buffer(beside, away)) if away else area
            for away in _RINGS
        ]
    pieces = []
    for outer, inner in pairwise(rings):
        for piece in split_on_grid(snapped(shapely.difference(outer, inner)), _CELL):
            pieces += polygons_of(piece)
    mesh = flat_polygons(pieces, z, cover, 1.0)
    shapely.prepare(edge)
    away = shapely.distance(shapely.points(mesh.positions[:, :2].astype(np.float64)), edge)
    mesh.uvs[:, 0], mesh.uvs[:, 1] = np.round(away, 3), 0.0
    return mesh
