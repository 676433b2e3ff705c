"""Soft shadows of moving things, and the light of their lamps.

Each thing is represented by two upright boxes, like the body and cabin of a car; a point is in
shadow where its line to the sun passes through one of them.
"""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import Geometry, View
from eyas.render.kernels.light.beams import cast_beam
from eyas.render.kernels.light.shadow_boxes import darken
from eyas.render.kernels.samples import around, nowhere, point_of
from eyas.render.kernels.scalars import f4
from eyas.render.kernels.visibility.cull import sphere_is_visible

__all__ = ["cast_light"]

SMALLEST = 1.0
"""Things whose half diagonal is smaller cast no shadow [pixels]."""


@inner_kernel
def _set_caster(
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    first: int,
    last: int,
    caster: NDArray[np.float64],
) -> bool:
    """Compute the box around slots `first` to `last`, turned like the largest part.

    Returns whether the thing has head and tail lamps.

    `caster`: centre x, y; direction of its length x, y; half length, half width; bottom, top; of
    its upper box the bottom, and back, front, right and left end from the centre; right and left
    end of its lower box; reach beyond it to which it blocks the sky's light on the ground.
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
    boxes = geometry.silhouette[geometry.part_first + parts[body]]
    caster[8] = poses[body, 2, 3] + boxes[0]
    caster[9], caster[10] = boxes[1] - along, boxes[2] - along
    for k in range(4):
        caster[11 + k] = boxes[3 + k] - aside
    caster[15] = 0.55 + 0.2 * (high - low)
    return bool(geometry.lamps[geometry.part_first + parts[body]])


@inner_kernel
def _throw(caster: NDArray[np.float64], sun: NDArray[np.float32]) -> float:
    """Return the distance of the shadow's end, per unit of the sun's x and y.

    With the sun near the horizon a shadow would be endless: it is cut after four heights.
    """
    return float(min(1.0 / max(float(sun[2]), 1e-3), 4.0) * (caster[7] - caster[6]))


@inner_kernel
def _may_show(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    view: View,
) -> bool:
    """Return whether a shadow may be in the picture, and large enough to see."""
    half = 0.5 * _throw(caster, sun)
    x, y, z = caster[0] - half * sun[0], caster[1] - half * sun[1], 0.5 * (caster[6] + caster[7])
    length = math.sqrt(caster[4] ** 2 + caster[5] ** 2)
    near = view.planes[4]
    if view.lens[3] * length < SMALLEST * (near[0] * x + near[1] * y + near[2] * z + near[3]):
        return False
    reach = length + half + 0.5 * (caster[7] - caster[6]) + caster[15]
    return sphere_is_visible(view.planes, x, y, z, reach)


@inner_kernel
def _screen_box(
    caster: NDArray[np.float64], sun: NDArray[np.float32], view: View
) -> tuple[float, float, float, float]:
    """Return the box around a thing and its shadow on the ground, see `around`."""
    box = nowhere()
    throw = _throw(caster, sun)
    for corner in range(16):
        along = (caster[4] + caster[15]) * (1.0 if corner & 1 else -1.0)
        aside = (caster[5] + caster[15]) * (1.0 if corner & 2 else -1.0)
        x = caster[0] + along * caster[2] - aside * caster[3]
        y = caster[1] + along * caster[3] + aside * caster[2]
        z = caster[7] if corner & 4 else caster[6] - 0.3
        if corner & 8:
            x -= throw * sun[0]
            y -= throw * sun[1]
            z = caster[6] - 0.3
        box = around(box, view, x, y, z)
    return box


@inner_kernel
def _cast_shadow(
    caster: NDArray[np.float64],
    sun: NDArray[np.float32],
    first: int,
    last: int,
    view: View,
    shade: NDArray[np.uint8],
) -> None:
    """Darken the samples that instances `first` to `last` shade, but not these themselves."""
    box = _screen_box(caster, sun, view)
    rows, width = view.depth.shape
    for line in range(max(int(box[1]) - view.top, 0), min(int(box[3]) + 1 - view.top, rows)):
        for column in range(max(int(box[0]), 0), min(int(box[2]) + 1, width)):
            if view.depth[line, column] <= f4(0.0):
                continue
            instance = (view.owner[line, column] >> 32) - 1
            if first <= instance < last:
                continue
            x, y, z = point_of(view, line, column)
            if z > caster[7]:
                continue
            direct, ambient = darken(caster, sun, x, y, z)
            shade[line, column, 0] = min(shade[line, column, 0], np.uint8(255.0 * direct))
            shade[line, column, 1] = min(shade[line, column, 1], np.uint8(255.0 * ambient))


@inner_kernel
def cast_light(
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    object_ids: NDArray[np.int32],
    sun: NDArray[np.float32],
    lamps: float,
    view: View,
    caster: NDArray[np.float64],
    shade: NDArray[np.uint8],
) -> None:
    """Write the share of light that moving things let through to each sample, and their own light.

    Slots in a row with the same object id are one thing.

    Args:
        geometry: Everything that can be drawn.
        parts: See `DrawList`.
        poses: See `DrawList`.
        object_ids: See `DrawList`.
        sun: Unit vector towards it.
        lamps: Greater than 0: those of vehicles are on.
        view: The samples.
        caster: See `Scratch`.
        shade: See `Scratch`; its last two channels are not written while lamps are off.
    """
    shade[:, :, :2] = 255
    if lamps > f4(0.0):
        shade[:, :, 2:] = 0
    fixtures = len(geometry.fixture_prototype)
    first = 0
    while first < len(parts):
        last = first + 1
        if parts[first] < 0:
            first = last
            continue
        while last < len(parts) and parts[last] >= 0 and object_ids[last] == object_ids[first]:
            last += 1
        has_lamps = _set_caster(geometry, parts, poses, first, last, caster)
        if _may_show(caster, sun, view):
            _cast_shadow(caster, sun, fixtures + first, fixtures + last, view, shade)
        if has_lamps and lamps > f4(0.0):
            cast_beam(caster, view, shade)
        first = last
