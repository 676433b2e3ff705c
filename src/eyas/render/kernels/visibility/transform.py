"""Transformation from the world to the screen: cameras, poses, the near plane."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import NEAR

__all__ = ["clip_near", "set_object_rows", "set_world_rows", "to_screen"]


@inner_kernel
def set_world_rows(
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    rows: NDArray[np.float64],
) -> None:
    """Compute the rows that map a world point to column * w, row * w (from the centre) and w."""
    for k in range(3):
        rows[0, k] = -lens[0] * axes[1, k]
        rows[1, k] = -lens[4] * axes[2, k]
        rows[2, k] = axes[0, k]
    for i in range(3):
        rows[i, 3] = -(rows[i, 0] * eye[0] + rows[i, 1] * eye[1] + rows[i, 2] * eye[2])


@inner_kernel
def set_object_rows(
    world: NDArray[np.float64],
    poses: NDArray[np.float32],
    index: int,
    rows: NDArray[np.float64],
) -> None:
    """Compute the same rows for points in the frame of pose `index`."""
    for i in range(3):
        for k in range(4):
            rows[i, k] = (
                world[i, 0] * poses[index, 0, k]
                + world[i, 1] * poses[index, 1, k]
                + world[i, 2] * poses[index, 2, k]
            )
        rows[i, 3] += world[i, 3]


@inner_kernel
def to_screen(
    rows: NDArray[np.float64],
    positions: NDArray[np.float32],
    first: int,
    last: int,
    middle_x: float,
    middle_y: float,
    screen: NDArray[np.float64],
) -> None:
    """Project vertices `first` to `last`: column, row, 1/w, w.

    Behind the near plane 1/w is 0, and column and row are not yet divided by w.
    """
    r00, r01, r02, r03 = rows[0, 0], rows[0, 1], rows[0, 2], rows[0, 3]
    r10, r11, r12, r13 = rows[1, 0], rows[1, 1], rows[1, 2], rows[1, 3]
    r20, r21, r22, r23 = rows[2, 0], rows[2, 1], rows[2, 2], rows[2, 3]
    for i in range(last - first):
        x, y, z = positions[first + i, 0], positions[first + i, 1], positions[first + i, 2]
        column = r00 * x + r01 * y + r02 * z + r03
        row = r10 * x + r11 * y + r12 * z + r13
        w = r20 * x + r21 * y + r22 * z + r23
        inverse = 0.0
        if w >= NEAR:
            inverse = 1.0 / w
            column = middle_x + column * inverse
            row = middle_y + row * inverse
        screen[i, 0] = column
        screen[i, 1] = row
        screen[i, 2] = inverse
        screen[i, 3] = w


@inner_kernel
def clip_near(
    screen: NDArray[np.float64],
    uvs: NDArray[np.float32],
    offset: int,
    a: int,
    b: int,
    c: int,
    middle_x: float,
    middle_y: float,
    polygon: NDArray[np.float64],
) -> int:
    """Cut a triangle at the near plane; return the number of corners left: 0, 3 or 4.

    A cut point is always computed from the visible end of its edge, so both triangles
    at an edge get the very same point.

    Args:
        screen: Output of `to_screen`.
        uvs: Texture coordinates of all vertices.
        offset: Index in `uvs` of the first row of `screen`.
        a: First corner, a row of `screen`.
        b: Second corner.
        c: Third corner.
        middle_x: Column of the optical axis.
        middle_y: Row of the optical axis.
        polygon: Filled with column, row, 1/w, u, v, shape (4, 5).
    """
    count = 0
    for j in range(3):
        i = a if j == 0 else (b if j == 1 else c)
        k = b if j == 0 else (c if j == 1 else a)
        if screen[i, 2] > 0.0:
            polygon[count, 0] = screen[i, 0]
            polygon[count, 1] = screen[i, 1]
            polygon[count, 2] = screen[i, 2]
            polygon[count, 3] = uvs[offset + i, 0]
            polygon[count, 4] = uvs[offset + i, 1]
            count += 1
        if (screen[i, 2] > 0.0) != (screen[k, 2] > 0.0):
            front, back = (i, k) if screen[i, 2] > 0.0 else (k, i)
            w = screen[front, 3]
            t = (NEAR - w) / (screen[back, 3] - w)
            column = (screen[front, 0] - middle_x) * w
            row = (screen[front, 1] - middle_y) * w
            polygon[count, 0] = middle_x + (column + t * (screen[back, 0] - column)) / NEAR
            polygon[count, 1] = middle_y + (row + t * (screen[back, 1] - row)) / NEAR
            polygon[count, 2] = 1.0 / NEAR
            for m in range(2):
                start = uvs[offset + front, m]
                polygon[count, 3 + m] = start + t * (uvs[offset + back, m] - start)
            count += 1
    return count
