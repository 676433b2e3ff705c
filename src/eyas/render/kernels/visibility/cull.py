"""Culling: boxes and spheres against the planes of a band of a view."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import GROUP, NEAR
from eyas.render.kernels.scalars import i8

__all__ = ["box_is_visible", "set_planes", "sphere_is_visible", "visible_chunks"]


@inner_kernel
def set_planes(
    rows: NDArray[np.float64],
    width: float,
    height: float,
    top: float,
    bottom: float,
    planes: NDArray[np.float64],
) -> None:
    """Compute the planes around the space that rows `top` to `bottom` of a picture show.

    A point is inside a plane if `plane[:3] @ point + plane[3] >= 0`; `plane[4]` is the length
    of the normal.
    """
    for k in range(4):
        planes[0, k] = rows[0, k] + 0.5 * width * rows[2, k]
        planes[1, k] = 0.5 * width * rows[2, k] - rows[0, k]
        planes[2, k] = rows[1, k] + (0.5 * height - top) * rows[2, k]
        planes[3, k] = (bottom - 0.5 * height) * rows[2, k] - rows[1, k]
        planes[4, k] = rows[2, k]
    planes[4, 3] -= NEAR
    for i in range(5):
        planes[i, 4] = math.sqrt(planes[i, 0] ** 2 + planes[i, 1] ** 2 + planes[i, 2] ** 2)


@inner_kernel
def box_is_visible(planes: NDArray[np.float64], boxes: NDArray[np.float32], i: int) -> bool:
    """Return whether box `i` may reach inside all planes."""
    for k in range(5):
        reach = planes[k, 3]
        for axis in range(3):
            normal = planes[k, axis]
            reach += normal * (boxes[i, 3 + axis] if normal > 0.0 else boxes[i, axis])
        if reach < 0.0:
            return False
    return True


@inner_kernel
def sphere_is_visible(
    planes: NDArray[np.float64], x: float, y: float, z: float, radius: float
) -> bool:
    """Return whether a sphere reaches inside all planes."""
    for k in range(5):
        height = planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z + planes[k, 3]
        if height < -radius * planes[k, 4]:
            return False
    return True


@inner_kernel
def visible_chunks(
    planes: NDArray[np.float64],
    eye: NDArray[np.float64],
    boxes: NDArray[np.float32],
    groups: NDArray[np.float32],
    order: NDArray[np.int64],
) -> int:
    """List the chunks to draw in `order`, nearest first; return how many there are.

    The low 32 bits of each entry hold the chunk, the bits above its distance in millimetres, so
    that no two entries are equal and the order does not depend on the band.
    """
    count = 0
    for group in range(len(groups)):
        if not box_is_visible(planes, groups, group):
            continue
        for i in range(group * GROUP, min((group + 1) * GROUP, len(boxes))):
            if not box_is_visible(planes, boxes, i):
                continue
            square = 0.0
            for axis in range(3):
                gap = max(boxes[i, axis] - eye[axis], eye[axis] - boxes[i, 3 + axis], 0.0)
                square += gap * gap
            order[count] = (i8(1000.0 * math.sqrt(square)) << i8(32)) | i8(i)
            count += 1
    _shell_sort(order, count)
    return count


@inner_kernel
def _shell_sort(values: NDArray[np.int64], count: int) -> None:
    """Sort the first `count` values in place; np.sort would allocate."""
    gap = 1
    while gap < count // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            value = values[i]
            j = i
            while j >= gap and values[j - gap] > value:
                values[j] = values[j - gap]
                j -= gap
            values[j] = value
        gap //= 3
