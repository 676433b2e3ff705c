"""Solid prisms as triangles."""

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.mesh.flat import flat_polygon
from eyas.engine.state.mesh import Material
from eyas.maps.exports.welding import distinct

__all__ = ["prism"]


def prism(
    outline: NDArray[np.float64], span: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Return the points and triangles of a prism on a counter-clockwise outline."""
    count = len(outline)
    sides = np.concatenate([np.column_stack([outline, np.full(count, z)]) for z in span])
    here, there = np.arange(count), (np.arange(count) + 1) % count
    walls = [[here, there, there + count], [here, there + count, here + count]]
    floor, roof = (flat_polygon(shapely.Polygon(outline), z, Material(), 1.0) for z in span)
    below = 2 * count
    above = below + len(floor.positions)
    triangles: list[NDArray[np.signedinteger]] = [np.stack(wall, axis=1) for wall in walls]
    triangles += [floor.triangles[:, ::-1] + below, roof.triangles + above]
    every = np.concatenate([sides, floor.positions, roof.positions])
    # Floor and roof have single numbers: so must the sides, or they share no point with these.
    points, where = distinct(every.astype(np.float32).astype(np.float64))
    return points, where[np.concatenate(triangles)].astype(np.int32)
