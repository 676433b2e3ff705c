"""Clusters: eight triangles that are culled and projected at once.

A row of `Geometry.cluster` holds for eight triangles, a column each: x, y and z of corner a, of b
and of c [m]; `SIZE`; `LEAVES`. A row of `Geometry.bounds` holds for eight clusters: lower and upper
corner of the box around each [m]; the apex and the axis of its cone, and `CUT_OFF`; `LARGEST`. From
places in the cone all its triangles are seen from behind.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import NEAR, Plane, Planes, Point, Projection, Row, View
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.engine.render.kernels.visibility.cull import Sides, in_boxes
from eyas.engine.render.kernels.visibility.triangles import Corners
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, bits_of, greater, lane_numbers, load, select, to_f8

CLUSTER = 8  # Triangles in a cluster

CLUSTER_ROWS = 11

SIZE = 9
"""Root of the area [m] of each triangle that is a detail, seen before something larger, and may be
left out when it is small; infinite for others; negative where there is no triangle."""

LEAVES = 10  # Texture tiles in a metre of leaves, negative for triangles without holes

UV_ROWS = 6  # Rows of `Geometry.corner_uv`: u and v of corner a, of b and of c.

BOUNDS_ROWS = 14
APEX, AXIS = 6, 9

CUT_OFF = 12
"""A place is in the cone if the way from it to the apex is at so small an angle to the axis that
the cosine is this or more."""

NO_CONE = 2.0  # Cut-off of a cone that holds no place

LARGEST = 13  # `SIZE` of the largest triangle in the cluster

_SLACK = 0.02  # How deep in a cone places must be [m]: more than float32 rounds them off


@kernel(inline=True)
def clusters_seen(
    bounds: NDArray[np.float32],  # See `Geometry`
    row: int,  # Row of `bounds`
    sides: Sides,  # Planes around what is shown, in the frame of the mesh
    eye: Point,  # Optical centre in that frame [m]
    smallest: float,  # Size of the smallest detail to draw [m]
) -> int:
    """Return which of eight clusters may be seen, a bit each."""
    at = row * BOUNDS_ROWS * CLUSTER
    seen = in_boxes(sides, bounds, at, CLUSTER)
    seen &= load(bounds, at + LARGEST * CLUSTER) >= f4(smallest)
    if not any_of(seen):
        return 0
    x = load(bounds, at + APEX * CLUSTER) - f4(eye.x)
    y = load(bounds, at + (APEX + 1) * CLUSTER) - f4(eye.y)
    z = load(bounds, at + (APEX + 2) * CLUSTER) - f4(eye.z)
    along = x * load(bounds, at + AXIS * CLUSTER)
    along += y * load(bounds, at + (AXIS + 1) * CLUSTER)
    along += z * load(bounds, at + (AXIS + 2) * CLUSTER)
    along = greater(along - f4(_SLACK), f4(0.0))
    cut_off = load(bounds, at + CUT_OFF * CLUSTER)
    return bits_of(seen & ~(along * along > cut_off * cut_off * (x * x + y * y + z * z)))


@kernel(inline=True)
def along_row(row: Row, x: float, y: float, z: float) -> float:
    """Return a coordinate on the screen, times the distance; or the distance."""
    return row.x * x + row.y * y + row.z * z + row.w


@kernel(inline=True)
def _corner(
    cluster: NDArray[np.float32], at: int, screen: Projection, view: View
) -> tuple[float, float, float, bool]:
    """Return column and row [samples] and 1/distance of a corner, and where it is in front of the
    near plane; elsewhere the numbers mean nothing.
    """
    x = to_f8(load(cluster, at))
    y = to_f8(load(cluster, at + CLUSTER))
    z = to_f8(load(cluster, at + 2 * CLUSTER))
    distance = along_row(screen.distance, x, y, z)
    front = distance >= NEAR
    inverse = 1.0 / select(front, distance, 1.0)
    column = 0.5 * view.width + along_row(screen.column, x, y, z) * inverse
    row = 0.5 * view.height + along_row(screen.row, x, y, z) * inverse
    return column, row, inverse, front


@kernel(inline=True)
def _reaches(plane: Plane, cluster: NDArray[np.float32], at: int) -> bool:
    """Return which triangles reach inside a plane."""
    row, inside = Row(plane.x, plane.y, plane.z, plane.w), lane_numbers() < i4(0)
    for corner in range(0, 9 * CLUSTER, 3 * CLUSTER):
        x, y = to_f8(load(cluster, at + corner)), to_f8(load(cluster, at + corner + CLUSTER))
        inside |= along_row(row, x, y, to_f8(load(cluster, at + corner + 2 * CLUSTER))) >= 0.0
    return inside


@kernel(inline=True)
def project_cluster(
    cluster: NDArray[np.float32],  # See `Geometry`
    number: int,  # Its row
    screen: Projection,  # Projection of the mesh
    planes: Planes,  # Planes around what is shown, in the frame of the mesh
    view: View,  # The band
    smallest: float,  # Size of the smallest detail to draw [m]
) -> tuple[Corners, bool, bool]:
    """Project the corners of a cluster.

    Returns:
        The corners; which triangles are in front of the near plane and large enough; which of
        those that the near plane cuts may be seen.
    """
    at = number * CLUSTER_ROWS * CLUSTER
    ax, ay, ai, a_front = _corner(cluster, at, screen, view)
    bx, by, bi, b_front = _corner(cluster, at + 3 * CLUSTER, screen, view)
    cx, cy, ci, c_front = _corner(cluster, at + 6 * CLUSTER, screen, view)
    large = load(cluster, at + SIZE * CLUSTER) >= f4(smallest)
    front = a_front & b_front & c_front
    cut = (a_front | b_front | c_front) & ~front & large
    if any_of(cut):
        for plane in (planes.left, planes.right, planes.top, planes.bottom):
            cut &= _reaches(plane, cluster, at)
    return Corners(ax, ay, ai, bx, by, bi, cx, cy, ci), front & large, cut


@kernel(inline=True)
def has_leaves(cluster: NDArray[np.float32], number: int) -> bool:
    """Return which triangles of a cluster are leaves."""
    return load(cluster, (number * CLUSTER_ROWS + LEAVES) * CLUSTER) >= f4(0.0)
