"""Drawing of meshes into the visibility buffer."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.core.lanes import first_bit
from eyas.render.kernels.bundles import Geometry, Point, Projection, View
from eyas.render.kernels.scalars import i8
from eyas.render.kernels.visibility.clusters import (
    CLUSTER,
    LEAVES,
    clusters_seen,
    project_cluster,
)
from eyas.render.kernels.visibility.cull import planes_of
from eyas.render.kernels.visibility.holes import holes_level, holes_of, no_holes
from eyas.render.kernels.visibility.rasterise import BOTH_SIDES, FRONT, rasterise
from eyas.render.kernels.visibility.transform import clip_near
from eyas.state.draw import DrawStage

__all__ = ["draw_mesh", "level_of_detail"]

VERTICES = int(DrawStage.VERTICES)

PIXELS_PER_TRIANGLE = 1.5
"""Size of the triangles for which a level of detail is fine enough [pixels]."""

TEXELS = 256.0
"""Texels along a side of a texture."""

ASIDE = 1.0 / 64.0
"""See `rasterise`: less would let roads rise over their paint at their far edges."""


@inlined_kernel
def level_of_detail(
    geometry: Geometry, prototype: int, radius: float, distance: float, focal: float
) -> int:
    """Return the mesh to draw for a prototype of a radius [m] at a distance [m]."""
    size = 2.0 * radius * focal / max(distance - radius, 1e-3)
    last = i8(geometry.level_first[prototype + 1]) - 1
    for mesh in range(geometry.level_first[prototype], last):
        triangles = geometry.mesh_range[mesh, 1] - geometry.mesh_range[mesh, 0]
        if triangles * PIXELS_PER_TRIANGLE <= size * size:
            return mesh
    return last


@inlined_kernel
def draw_mesh(
    until: int,
    geometry: Geometry,
    mesh: NDArray[np.int32],
    screen: Projection,
    eye: Point,
    focal: float,
    smallest: float,
    tag: int,
    view: View,
    key: NDArray[np.int64],
    projected: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw a chunk or a level of detail.

    Args:
        until: See `DrawStage`.
        geometry: Everything that can be drawn.
        mesh: Row of `chunk_range` or `mesh_range`.
        screen: Projection of the mesh.
        eye: Optical centre in the frame of the mesh [m].
        focal: Focal length over the scale of the object [pixels].
        smallest: Size of the smallest detail to draw [m].
        tag: Tag of triangle 0.
        view: The band.
        key: See `Scratch`, shape (rows, columns).
        projected: See `Scratch`, shape (9, 8).
        polygon: See `Scratch`, shape (4, 5).
    """
    bottom = view.top + view.rows
    planes = planes_of(screen, view.width, view.height, view.top, bottom)
    first, clusters = mesh[0] // CLUSTER, (mesh[1] - mesh[0] + CLUSTER - 1) // CLUSTER
    for start in range(0, clusters, CLUSTER):
        row = mesh[2] + start // CLUSTER
        left = clusters_seen(geometry.bounds, row, planes, eye, smallest)
        while left != 0:
            cluster = first + start + first_bit(left)
            left &= left - 1
            drawn, cut = project_cluster(
                geometry.cluster, cluster, screen, view, smallest, projected
            )
            if until == VERTICES:
                continue
            while drawn != 0:
                number = first_bit(drawn)
                drawn &= drawn - 1
                is_cut = (cut >> number) & 1 != 0
                _draw_triangle(
                    geometry, cluster, number, is_cut, screen, focal, tag, view, key, projected,
                    polygon,
                )  # fmt: skip


@inlined_kernel
def _draw_triangle(
    geometry: Geometry,
    cluster: int,
    number: int,
    cut: bool,
    screen: Projection,
    focal: float,
    tag: int,
    view: View,
    key: NDArray[np.int64],
    projected: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw a triangle of a cluster; for the other arguments see `draw_mesh`."""
    triangle = CLUSTER * cluster + number
    uv = geometry.corner_uv[triangle]
    corners = 3
    if cut:
        corners = clip_near(
            screen, geometry.cluster[cluster], number, uv, 0.5 * view.width, 0.5 * view.height,
            polygon,
        )  # fmt: skip
    else:
        for corner in range(3):
            for k in range(3):
                polygon[corner, k] = projected[3 * corner + k, number]
    sides, holes = FRONT, no_holes(geometry.texture)
    tiles = geometry.cluster[cluster, LEAVES, number]
    if tiles > 0.0:
        sides = BOTH_SIDES
        level = holes_level(TEXELS * tiles / (focal * polygon[0, 2]))
        if level >= 0:
            holes = holes_of(geometry.texture, geometry.layer[geometry.material[triangle]], level)
            if not cut:
                for corner in range(3):
                    polygon[corner, 3] = uv[2 * corner]
                    polygon[corner, 4] = uv[2 * corner + 1]
    for k in range(1, corners - 1):
        rasterise(
            polygon, 0, k, k + 1, view.top, view.width, key, tag + triangle, sides, ASIDE, holes
        )
