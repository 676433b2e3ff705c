"""Clusters: eight triangles that are culled and projected at once.

A row of `Geometry.cluster` holds for eight triangles, a column each: x, y and z of corner a, of b
and of c [m]; `SIZE`; `LEAVES`. A row of `Geometry.bounds` holds for eight clusters: lower and upper
corner of the box around each [m]; the apex and the axis of its cone, and `CUT_OFF`; `LARGEST`. From
places in the cone all its triangles are seen from behind.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.core.lanes import (
    any_of,
    bits_of,
    ceiling,
    greater,
    lesser,
    load,
    select,
    store,
    to_f8,
    whole,
)
from eyas.render.kernels.bundles import NEAR, Planes, Point, Projection, Row, View
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.visibility.cull import in_boxes
from eyas.render.kernels.visibility.rasterise import SIXTEENTHS

__all__ = [
    "APEX",
    "AXIS",
    "BOUNDS_ROWS",
    "CLUSTER",
    "CLUSTER_ROWS",
    "CUT_OFF",
    "LARGEST",
    "LEAVES",
    "NO_CONE",
    "SIZE",
    "clusters_seen",
    "project_cluster",
]

CLUSTER = 8
"""Triangles in a cluster."""

CLUSTER_ROWS = 11

SIZE = 9
"""Root of the area [m] of each triangle that is a detail, seen before something larger, and may be
left out when it is small; infinite for others; negative where there is no triangle."""

LEAVES = 10
"""Texture tiles in a metre of leaves, 0 for triangles without holes."""

BOUNDS_ROWS = 14
APEX, AXIS = 6, 9

CUT_OFF = 12
"""A place is in the cone if the way from it to the apex is at so small an angle to the axis that
the cosine is this or more."""

NO_CONE = 2.0
"""Cut-off of a cone that holds no place."""

LARGEST = 13
"""`SIZE` of the largest triangle in the cluster."""

_SLACK = 0.02
"""How deep in a cone places must be [m]: more than float32 rounds them off."""


@inlined_kernel
def clusters_seen(
    bounds: NDArray[np.float32], row: int, planes: Planes, eye: Point, smallest: float
) -> int:
    """Return which of eight clusters may be seen, a bit each.

    Args:
        bounds: See `Geometry`.
        row: Row of `bounds`.
        planes: Planes around what is shown, in the frame of the mesh.
        eye: Optical centre in that frame [m].
        smallest: Size of the smallest detail to draw [m].
    """
    at = row * BOUNDS_ROWS * CLUSTER
    seen = in_boxes(planes, bounds, at, CLUSTER)
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


@inlined_kernel
def _along(row: Row, x: float, y: float, z: float) -> float:
    return row.x * x + row.y * y + row.z * z + row.w


@inlined_kernel
def _corner(
    cluster: NDArray[np.float32], at: int, screen: Projection, view: View
) -> tuple[float, float, float, bool]:
    """Return column and row [samples] and 1/distance of a corner, and where it is in front of the
    near plane; elsewhere the numbers mean nothing.
    """
    x = to_f8(load(cluster, at))
    y = to_f8(load(cluster, at + CLUSTER))
    z = to_f8(load(cluster, at + 2 * CLUSTER))
    distance = _along(screen.distance, x, y, z)
    front = distance >= NEAR
    inverse = 1.0 / select(front, distance, 1.0)
    column = 0.5 * view.width + _along(screen.column, x, y, z) * inverse
    row = 0.5 * view.height + _along(screen.row, x, y, z) * inverse
    return column, row, inverse, front


@inlined_kernel
def _snapped(place: float) -> float:
    return whole(place * SIXTEENTHS + 0.5)


@inlined_kernel
def _holds_centre(a: float, b: float, c: float, begin: float, end: float) -> bool:
    """Return whether there is a centre of a pixel from `begin` to `end` between three places."""
    half, step = 0.5 * SIXTEENTHS, 1.0 / SIXTEENTHS
    first = ceiling((lesser(lesser(a, b), c) - half) * step)
    last = ceiling((greater(greater(a, b), c) - half) * step)
    return greater(first, begin) < lesser(last, end)


@inlined_kernel
def project_cluster(
    cluster: NDArray[np.float32],
    number: int,
    screen: Projection,
    view: View,
    smallest: float,
    projected: NDArray[np.float64],
) -> tuple[int, int]:
    """Project the corners of a cluster; return which triangles are to be drawn, and which of them
    the near plane cuts, a bit each.

    The others are seen from behind, hold no centre of a sample in the band, or are too small.

    Args:
        cluster: See `Geometry`.
        number: Its row.
        screen: Projection of the mesh.
        view: The band.
        smallest: Size of the smallest detail to draw [m].
        projected: Filled, see `Scratch`, shape (9, 8); only the columns of triangles to be drawn
            that are not cut mean anything.
    """
    at = number * CLUSTER_ROWS * CLUSTER
    ax, ay, ai, a_front = _corner(cluster, at, screen, view)
    bx, by, bi, b_front = _corner(cluster, at + 3 * CLUSTER, screen, view)
    cx, cy, ci, c_front = _corner(cluster, at + 6 * CLUSTER, screen, view)
    large = load(cluster, at + SIZE * CLUSTER) >= f4(smallest)
    front = a_front & b_front & c_front
    cut = (a_front | b_front | c_front) & ~front & large
    x0, y0, x1, y1 = _snapped(ax), _snapped(ay), _snapped(bx), _snapped(by)
    x2, y2 = _snapped(cx), _snapped(cy)
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    leaves = load(cluster, at + LEAVES * CLUSTER) > f4(0.0)
    drawn = front & large & ((area < 0.0) | (leaves & (area > 0.0)))
    drawn &= _holds_centre(y0, y1, y2, float(view.top), float(view.top + view.rows))
    drawn &= _holds_centre(x0, x1, x2, 0.0, float(view.width))
    drawn |= cut
    if any_of(drawn):
        store(projected, 0, ax)
        store(projected, CLUSTER, ay)
        store(projected, 2 * CLUSTER, ai)
        store(projected, 3 * CLUSTER, bx)
        store(projected, 4 * CLUSTER, by)
        store(projected, 5 * CLUSTER, bi)
        store(projected, 6 * CLUSTER, cx)
        store(projected, 7 * CLUSTER, cy)
        store(projected, 8 * CLUSTER, ci)
    return bits_of(drawn), bits_of(cut)
