"""Soft shadows of moving things: each is two upright boxes, as a car is a body and a cabin, and a
shadow is drawn where the way to the sun leads through one.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import Geometry
from eyas.render.kernels.cull import sphere_is_visible
from eyas.render.kernels.shadow_boxes import darken

__all__ = ["cast_shadows", "set_caster"]


SMALLEST = 1.0
"""Things whose half diagonal is smaller cast no shadow [pixels]."""


@inner_kernel
def set_caster(
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    first: int,
    last: int,
    caster: NDArray[np.float64],
) -> None:
    """Compute the box around slots `first` to `last`, turned like the largest part.

    `caster`: centre x, y; direction of its length x, y; half length, half width; bottom, top; then
    of its upper part the bottom, and back, front, right and left end from the centre.
    """
    body, largest, axis_x, axis_y, origin_x, origin_y = first, -1.0, 1.0, 0.0, 0.0, 0.0
    for slot in range(first, last):
        box = geometry.box[geometry.part_first + parts[slot]]
        size = (box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2])
        flat = math.sqrt(float(poses[slot, 0, 0]) ** 2 + float(poses[slot, 1, 0]) ** 2)
        if size > largest and flat > 1e-6:
            body, largest = slot, size
            axis_x, axis_y = poses[slot, 0, 0] / flat, poses[slot, 1, 0] / flat
            origin_x, origin_y = poses[slot, 0, 3], poses[slot, 1, 3]
    front, back, left, right, low, high = -1e9, 1e9, -1e9, 1e9, 1e9, -1e9
    for slot in range(first, last):
        box = geometry.box[geometry.part_first + parts[slot]]
        for corner in range(8):
            x = box[3 * (corner & 1)]
            y = box[1 + 3 * ((corner >> 1) & 1)]
            z = box[2 + 3 * (corner >> 2)]
            pose = poses[slot]
            wx = pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3] - origin_x
            wy = pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3] - origin_y
            wz = pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3]
            along, aside = wx * axis_x + wy * axis_y, wy * axis_x - wx * axis_y
            front, back = max(front, along), min(back, along)
            left, right = max(left, aside), min(right, aside)
            low, high = min(low, wz), max(high, wz)
    along, aside = 0.5 * (front + back), 0.5 * (left + right)
    caster[0] = origin_x + along * axis_x - aside * axis_y
    caster[1] = origin_y + along * axis_y + aside * axis_x
    caster[2], caster[3] = axis_x, axis_y
    caster[4], caster[5] = 0.5 * (front - back), 0.5 * (left - right)
    caster[6], caster[7] = low, high
    upper = geometry.upper[geometry.part_first + parts[body]]
    caster[8] = poses[body, 2, 3] + upper[0]
    caster[9], caster[10] = upper[1] - along, upper[2] - along
    caster[11], caster[12] = upper[3] - aside, upper[4] - aside


@inner_kernel
def _throw(caster: NDArray[np.float64], sun: NDArray[np.float32]) -> float:
    """Return how far the shadow's end is off, for each unit of the sun's x and y.

    A sun near the horizon would throw it without end: it is cut after four heights.
    """
    return float(min(1.0 / max(float(sun[2]), 1e-3), 4.0) * (caster[7] - caster[6]))


@inner_kernel
def _may_show(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    planes: NDArray[np.float64],
    focal: float,
) -> bool:
    """Return whether a shadow may be in the picture, and large enough to see."""
    half = 0.5 * _throw(caster, sun)
    x, y, z = caster[0] - half * sun[0], caster[1] - half * sun[1], 0.5 * (caster[6] + caster[7])
    length = math.sqrt(caster[4] ** 2 + caster[5] ** 2)
    w = planes[4, 0] * x + planes[4, 1] * y + planes[4, 2] * z + planes[4, 3]
    if focal * length < SMALLEST * w:
        return False
    return sphere_is_visible(planes, x, y, z, length + half + 0.5 * (caster[7] - caster[6]) + 0.7)


@inner_kernel
def _screen_box(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    rows: NDArray[np.float64],
    lens: NDArray[np.float64],
) -> tuple[float, float, float, float]:
    """Return left, top, right, bottom of the box and its shadow on the ground, in samples."""
    left, top, right, bottom = 1e9, 1e9, -1e9, -1e9
    throw = _throw(caster, sun)
    for corner in range(16):
        along = (caster[4] + 0.5) * (1.0 if corner & 1 else -1.0)
        aside = (caster[5] + 0.5) * (1.0 if corner & 2 else -1.0)
        x = caster[0] + along * caster[2] - aside * caster[3]
        y = caster[1] + along * caster[3] + aside * caster[2]
        z = caster[7] if corner & 4 else caster[6] - 0.3
        if corner & 8:
            x -= throw * sun[0]
            y -= throw * sun[1]
            z = caster[6] - 0.3
        w = rows[2, 0] * x + rows[2, 1] * y + rows[2, 2] * z + rows[2, 3]
        if w < 0.1:
            return 0.0, 0.0, lens[1], lens[2]
        column = rows[0, 0] * x + rows[0, 1] * y + rows[0, 2] * z + rows[0, 3]
        row = rows[1, 0] * x + rows[1, 1] * y + rows[1, 2] * z + rows[1, 3]
        column, row = 0.5 * lens[1] + column / w, 0.5 * lens[2] + row / w
        left, right = min(left, column), max(right, column)
        top, bottom = min(top, row), max(bottom, row)
    return left, top, right, bottom


@inner_kernel
def _cast_one(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    fixtures: int,
    first: int,
    last: int,
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    box: tuple[float, float, float, float],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    shade: NDArray[np.uint8],
) -> None:
    """Darken the samples in `box` that slots `first` to `last` shade, but not these themselves."""
    rows, width = depth.shape
    for line in range(max(int(box[1]) - top, 0), min(int(box[3]) + 1 - top, rows)):
        up = (0.5 * lens[2] - (line + top + 0.5)) / lens[4]
        for column in range(max(int(box[0]), 0), min(int(box[2]) + 1, width)):
            if depth[line, column] <= 0.0:
                continue
            slot = (owner[line, column] >> 32) - 1 - fixtures
            if first <= slot < last:
                continue
            left = (0.5 * lens[1] - (column + 0.5)) / lens[0]
            w = 1.0 / depth[line, column]
            x = eye[0] + w * (axes[0, 0] + left * axes[1, 0] + up * axes[2, 0])
            y = eye[1] + w * (axes[0, 1] + left * axes[1, 1] + up * axes[2, 1])
            z = eye[2] + w * (axes[0, 2] + left * axes[1, 2] + up * axes[2, 2])
            if z > caster[7]:
                continue
            direct, ambient = darken(caster, sun, x, y, z)
            shade[line, column, 0] = min(shade[line, column, 0], np.uint8(255.0 * direct))
            shade[line, column, 1] = min(shade[line, column, 1], np.uint8(255.0 * ambient))


@inner_kernel
def cast_shadows(
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    object_ids: NDArray[np.int32],
    sun: NDArray[np.float32],
    eye: NDArray[np.float64],
    axes: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    rows: NDArray[np.float64],
    planes: NDArray[np.float64],
    caster: NDArray[np.float64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    shade: NDArray[np.uint8],
) -> None:
    """Write what moving things take of the light of each sample into `shade`.

    Slots in a row with the same object id are one thing. See `Job` and `Scratch`.
    """
    shade[:] = 255
    fixtures = len(geometry.fixture_prototype)
    first = 0
    while first < len(parts):
        last = first + 1
        if parts[first] < 0:
            first = last
            continue
        while last < len(parts) and parts[last] >= 0 and object_ids[last] == object_ids[first]:
            last += 1
        set_caster(geometry, parts, poses, first, last, caster)
        if _may_show(caster, sun, planes, lens[3]):
            box = _screen_box(caster, sun, rows, lens)
            if box[3] >= top and box[1] <= top + depth.shape[0]:
                _cast_one(
                    caster, sun, fixtures, first, last, eye, axes, lens, top, box,
                    depth, owner, shade,
                )  # fmt: skip
        first = last
