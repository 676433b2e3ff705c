"""Transformation from the world to the screen: cameras, poses, the near plane."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import NEAR, Job, Point, Projection, Row, Task, View
from eyas.engine.render.kernels.scalars import i8
from eyas.engine.render.kernels.visibility.cull import planes_of
from eyas.lanes import kernel


@kernel(inline=True)
def view_of(task: Task, band: int) -> View:
    """Return a band of a view, row `band` of `Job.band`."""
    job = task.job
    number, top, bottom = job.band[band, 0], job.band[band, 1], job.band[band, 2]
    eye = Point(job.eye[number, 0], job.eye[number, 1], job.eye[number, 2])
    ahead, left, up = _axis(job, number, 0), _axis(job, number, 1), _axis(job, number, 2)
    focal = job.focal[number, 0], job.focal[number, 1]
    return view_along(eye, (ahead, left, up), focal, (task.width, task.height), (top, bottom), task)


@kernel(inline=True)
def view_along(
    eye: Point,  # Optical centre
    axes: tuple[Point, Point, Point],  # Forward, left and up
    focal: tuple[float, float],  # Focal length along rows and along columns [pixels]
    size: tuple[int, int],  # Width and height of the whole picture [pixels]
    rows: tuple[int, int],  # Its first row, and the row after the last [pixels]
    task: Task,  # Tells how many samples each pixel has
) -> View:
    """Return a band of a view."""
    ahead, left, up = axes
    pixels_x, pixels_y = focal
    across, down = task.across, task.down
    focal_x, focal_y = pixels_x * across, pixels_y * down
    screen = Projection(
        _through(eye, -focal_x, left), _through(eye, -focal_y, up), _through(eye, 1.0, ahead)
    )
    columns, lines = i8(size[0] * across), i8(size[1] * down)
    first, last = i8(rows[0] * down), i8(rows[1] * down)
    return View(
        eye, ahead, left, up, focal_x, focal_y, math.sqrt(pixels_x * pixels_y), columns, lines,
        first, last - first, i8(across), i8(down), screen,
        planes_of(screen, columns, lines, first, last),
    )  # fmt: skip


@kernel(inline=True)
def _axis(job: Job, view: int, axis: int) -> Point:
    return Point(job.axes[view, axis, 0], job.axes[view, axis, 1], job.axes[view, axis, 2])


@kernel(inline=True)
def _through(eye: Point, scale: float, axis: Point) -> Row:
    """Return the row that gives the place along an axis from the eye, times a scale."""
    x, y, z = scale * axis.x, scale * axis.y, scale * axis.z
    return Row(x, y, z, -(x * eye.x + y * eye.y + z * eye.z))


@kernel(inline=True)
def _posed(row: Row, poses: NDArray[np.float32], index: int) -> Row:
    """Return a row for points in the frame of pose `index`."""
    p = poses[index]
    return Row(
        row.x * p[0, 0] + row.y * p[1, 0] + row.z * p[2, 0],
        row.x * p[0, 1] + row.y * p[1, 1] + row.z * p[2, 1],
        row.x * p[0, 2] + row.y * p[1, 2] + row.z * p[2, 2],
        row.x * p[0, 3] + row.y * p[1, 3] + row.z * p[2, 3] + row.w,
    )


@kernel(inline=True)
def object_projection(world: Projection, poses: NDArray[np.float32], index: int) -> Projection:
    """Return the projection of points in the frame of pose `index`."""
    return Projection(
        _posed(world.column, poses, index),
        _posed(world.row, poses, index),
        _posed(world.distance, poses, index),
    )


@kernel(inline=True)
def scale_of(poses: NDArray[np.float32], index: int) -> float:
    """Return the scale of pose `index`."""
    x, y, z = float(poses[index, 0, 0]), float(poses[index, 1, 0]), float(poses[index, 2, 0])
    return math.sqrt(x * x + y * y + z * z)


@kernel(inline=True)
def in_frame(point: Point, poses: NDArray[np.float32], index: int) -> Point:
    """Return a world point in the frame of pose `index`, a rotation and a scale."""
    p = poses[index]
    x, y, z = point.x - p[0, 3], point.y - p[1, 3], point.z - p[2, 3]
    square = scale_of(poses, index) ** 2
    return Point(
        (x * p[0, 0] + y * p[1, 0] + z * p[2, 0]) / square,
        (x * p[0, 1] + y * p[1, 1] + z * p[2, 1]) / square,
        (x * p[0, 2] + y * p[1, 2] + z * p[2, 2]) / square,
    )


@kernel(inline=True)
def _projected(
    screen: Projection, cluster: NDArray[np.float32], number: int, corner: int
) -> tuple[float, float, float]:
    """Return column and row, from the middle of the picture and times the distance, and distance
    of a corner of a triangle.
    """
    x = float(cluster[3 * corner, number])
    y = float(cluster[3 * corner + 1, number])
    z = float(cluster[3 * corner + 2, number])
    c, r, d = screen.column, screen.row, screen.distance
    return (
        c.x * x + c.y * y + c.z * z + c.w,
        r.x * x + r.y * y + r.z * z + r.w,
        d.x * x + d.y * y + d.z * z + d.w,
    )


@kernel(inline=True)
def _write(
    polygon: NDArray[np.float64],
    count: int,
    column: float,
    row: float,
    inverse: float,
    u: float,
    v: float,
) -> None:
    """Write corner `count` of a polygon into the triangles that have it: 0 1 2 and 0 2 3."""
    if count <= 2:
        _write_corner(polygon, 0, count, column, row, inverse, u, v)
    if count != 1:
        _write_corner(polygon, 1, max(count - 1, 0), column, row, inverse, u, v)


@kernel(inline=True)
def _write_corner(
    polygon: NDArray[np.float64],
    piece: int,
    corner: int,
    column: float,
    row: float,
    inverse: float,
    u: float,
    v: float,
) -> None:
    polygon[3 * corner, piece] = column
    polygon[3 * corner + 1, piece] = row
    polygon[3 * corner + 2, piece] = inverse
    polygon[9 + 2 * corner, piece] = u
    polygon[10 + 2 * corner, piece] = v


@kernel
def clip_near(
    screen: Projection,  # Projection of the triangle's corners
    cluster: NDArray[np.float32],  # Its cluster, a row of `Geometry.cluster`
    uv: NDArray[np.float32],  # That row of `Geometry.corner_uv`
    number: int,  # Its number in the cluster
    middle_x: float,  # Column of the optical axis
    middle_y: float,  # Row of the optical axis
    polygon: NDArray[np.float64],  # Columns 0 and 1 are filled, see `Scratch`, shape (15, 8)
) -> int:
    """Cut a triangle at the near plane; return how many triangles are left: 0, 1 or 2.

    A cut point is always computed from the visible end of its edge, so both triangles
    at an edge get the very same point.
    """
    count = 0
    for j in range(3):
        k = j + 1 if j < 2 else 0
        cj, rj, wj = _projected(screen, cluster, number, j)
        ck, rk, wk = _projected(screen, cluster, number, k)
        uj, vj = float(uv[2 * j, number]), float(uv[2 * j + 1, number])
        uk, vk = float(uv[2 * k, number]), float(uv[2 * k + 1, number])
        if wj >= NEAR:
            inverse = 1.0 / wj
            _write(
                polygon, count, middle_x + cj * inverse, middle_y + rj * inverse, inverse, uj, vj
            )
            count += 1
        if (wj >= NEAR) != (wk >= NEAR):
            if wk >= NEAR:
                cj, rj, wj, ck, rk, wk = ck, rk, wk, cj, rj, wj
                uj, vj, uk, vk = uk, vk, uj, vj
            t = (NEAR - wj) / (wk - wj)
            column = middle_x + (cj + t * (ck - cj)) / NEAR
            row = middle_y + (rj + t * (rk - rj)) / NEAR
            _write(polygon, count, column, row, 1.0 / NEAR, uj + t * (uk - uj), vj + t * (vk - vj))
            count += 1
    return max(count - 2, 0)
