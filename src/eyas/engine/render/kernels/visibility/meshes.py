"""Drawing of meshes into the visibility buffer."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import (
    SHADING_COLUMNS,
    Band,
    Geometry,
    Planes,
    Point,
    Projection,
    View,
)
from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.visibility.clusters import (
    BOUNDS_ROWS,
    CLUSTER,
    CLUSTER_ROWS,
    UV_ROWS,
    clusters_seen,
    has_leaves,
    project_cluster,
)
from eyas.engine.render.kernels.visibility.cull import planes_of, sides_of
from eyas.engine.render.kernels.visibility.fill import fill
from eyas.engine.render.kernels.visibility.holes import holes_of
from eyas.engine.render.kernels.visibility.leaves import leaves_of, tiles_of
from eyas.engine.render.kernels.visibility.records import record_triangles
from eyas.engine.render.kernels.visibility.transform import clip_near
from eyas.engine.render.kernels.visibility.triangles import (
    Corners,
    load_corners,
    set_up,
    set_up_leaves,
)
from eyas.engine.state.draw import DrawStage
from eyas.lanes import kernel
from eyas.lanes.vector import any_of, bits_of, first_bit, lane_numbers, prefetch, splat

VERTICES = int(DrawStage.VERTICES)

PIXELS_PER_TRIANGLE = 1.5
"""Size of the triangles for which a level of detail is fine enough [pixels]."""

_ROWS_IN_LINE = 2  # Rows of eight float32 in a line of the cache

ASIDE = 1.0 / 64.0  # See `rasterise`: less would let roads rise over their paint at their far edges


@kernel(inline=True)
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


@kernel(inline=True)
def _fetch(array: NDArray[np.float32], number: int, rows: int) -> None:
    """Have a cluster, or bounds, with that many rows of eight numbers brought into the cache."""
    for row in range(0, rows, _ROWS_IN_LINE):
        prefetch(array, (number * rows + row) * CLUSTER)


@kernel(inline=True)
def draw_mesh(
    band: Band,
    key: NDArray[np.int64],  # Drawn into: its `key` or `alone`
    mesh: NDArray[np.int32],  # Row of `chunk_range` or `mesh_range`
    screen: Projection,  # Projection of the mesh
    eye: Point,  # Optical centre in the frame of the mesh [m]
    focal: float,  # Focal length over the scale of the object [pixels]
    smallest: float,  # Size of the smallest detail to draw [m]
    tag: int,  # Tag of triangle 0
) -> None:
    """Draw a chunk or a level of detail."""
    geometry, view = band.geometry, band.camera
    bottom = view.top + view.rows
    planes = planes_of(screen, view.width, view.height, view.top, bottom)
    sides = sides_of(planes)
    first, clusters = mesh[0] // CLUSTER, (mesh[1] - mesh[0] + CLUSTER - 1) // CLUSTER
    for start in range(0, clusters, CLUSTER):
        row = mesh[2] + start // CLUSTER
        left = clusters_seen(geometry.bounds, row, sides, eye, smallest)
        while left != 0:
            cluster = first + start + first_bit(left)
            left &= left - 1
            if left != 0:
                _fetch(geometry.cluster, first + start + first_bit(left), CLUSTER_ROWS)
            draw_cluster(band, key, cluster, screen, planes, focal, smallest, tag)


@kernel(inline=True)
def fetch_mesh(geometry: Geometry, mesh: NDArray[np.int32]) -> None:
    """Have what is read first of a mesh, see `draw_mesh`, brought into the cache."""
    _fetch(geometry.bounds, mesh[2], BOUNDS_ROWS)
    _fetch(geometry.cluster, mesh[0] // CLUSTER, CLUSTER_ROWS)


@kernel(inline=True)
def draw_cluster(
    band: Band,  # See `draw_mesh`
    key: NDArray[np.int64],
    cluster: int,  # Row of `Geometry.cluster`
    screen: Projection,
    planes: Planes,  # Planes around what the band shows, in the frame of the mesh
    focal: float,
    smallest: float,
    tag: int,
) -> None:
    """Draw eight triangles of a mesh."""
    geometry, view, triangle = band.geometry, band.camera, band.triangle
    corners, front, cut = project_cluster(geometry.cluster, cluster, screen, planes, view, smallest)
    leafy = has_leaves(geometry.cluster, cluster)
    drawn = bits_of(_prepared(corners, front, leafy, view, triangle))
    if band.until == VERTICES:
        return
    if drawn != 0 and any_of(leafy):
        set_up_leaves(
            corners, geometry.corner_uv, UV_ROWS * CLUSTER * geometry.uv_row[cluster], triangle
        )
    _draw_triangles(band, key, cluster, drawn, bits_of(cut), screen, focal, tag)


@kernel(inline=True)
def _prepared(
    corners: Corners, wanted: bool, leafy: bool, view: View, triangle: NDArray[np.float64]
) -> bool:
    """Prepare triangles of a cluster; return which are to be drawn."""
    top, bottom, width = float(view.top), float(view.top + view.rows), float(view.width)
    return set_up(corners, wanted, leafy, top, bottom, width, ASIDE, triangle)


@kernel(inline=True)
def _draw_triangles(
    band: Band,
    key: NDArray[np.int64],
    cluster: int,
    drawn: int,
    cut: int,
    screen: Projection,
    focal: float,
    tag: int,
) -> None:
    """Draw triangles of a cluster, then those that the near plane cuts, a bit each."""
    geometry, view, triangle = band.geometry, band.camera, band.triangle
    whole, number = True, i8(0)
    if band.members > 1 and drawn != 0:
        drawn = record_triangles(band, drawn, cluster, i8(-1), focal, tag)
    while drawn != 0 or cut != 0:
        if drawn == 0:
            whole, number = False, first_bit(cut)
            cut &= cut - 1
            drawn = _cut_triangle(band, cluster, number, screen, focal, tag)
            continue
        column = first_bit(drawn)
        drawn &= drawn - 1
        if whole:
            number = column
        at = CLUSTER * cluster + number
        holes = holes_of(geometry.texture, leaves_of(geometry, at, triangle, column, focal))
        # It will be shaded, unless something nearer is drawn over it.
        prefetch(geometry.shading, at * SHADING_COLUMNS)
        fill(triangle, column, view.top, view.width, key, tag + at, holes, band.span)


@kernel(inline=True, apart=True)
def _cut_triangle(
    band: Band, cluster: int, number: int, screen: Projection, focal: float, tag: int
) -> int:
    """Prepare what the near plane leaves of a triangle, and record it, if workers share the band;
    return what is to be filled: none, one or two, a bit each.
    """
    geometry, view, triangle, polygon = band.geometry, band.camera, band.triangle, band.polygon
    pieces = clip_near(
        screen, geometry.cluster[cluster], geometry.corner_uv[geometry.uv_row[cluster]], number,
        0.5 * view.width, 0.5 * view.height, polygon,
    )  # fmt: skip
    corners, numbers = load_corners(polygon), lane_numbers()
    leafy = splat(tiles_of(geometry, CLUSTER * cluster + number) >= 0.0)
    drawn = bits_of(_prepared(corners, numbers < i4(pieces), leafy, view, triangle))
    if drawn != 0:
        set_up_leaves(corners, polygon, 9 * CLUSTER, triangle)
        if band.members > 1:
            drawn = record_triangles(band, drawn, cluster, number, focal, tag)
    return drawn
