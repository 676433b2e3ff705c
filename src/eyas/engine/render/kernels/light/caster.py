"""The box around a moving thing, which casts a shadow and may have lamps."""

import math
from typing import NamedTuple

from eyas.engine.render.kernels.bundles import Band, Direction, View
from eyas.engine.render.kernels.light.shadow_boxes import Box, ShadowBoxes, shadow_boxes
from eyas.engine.render.kernels.samples import LocalCamera, local_camera
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel

_UPRIGHT = 4.0  # What is higher than so many times half its width stands on two feet

_ROUND = 0.96  # Length of the lower box, whose corners bodies do not fill, as a share

_HIPS, _LEGS, _TRUNK = 0.5, 0.6, 0.82
"""Of what stands on two feet: height of the hips, as a share of its own; width of the legs, and of
trunk and head, as shares of that of the trunk."""

CORNER = 1.75  # Root of 3, and a little for rounding


class Caster(NamedTuple):
    """A moving thing as a box, turned like its largest part; of float64 [m]."""

    x: float  # Its middle in the world
    y: float
    along_x: float  # Direction of its length, a unit vector
    along_y: float
    length: float  # Half its length
    width: float  # Half its width
    bottom: float  # z in the world
    top: float
    waist: float  # z where its upper box begins
    back: float  # Ends of its upper box from the middle
    front: float
    right: float
    left: float
    lower_right: float  # Ends of its lower box, which is as long as the thing
    lower_left: float
    beyond: float  # Distance from the thing up to which it blocks the sky's light on the ground


@kernel(inline=True)
def beyond(height: float) -> float:
    """Return the distance up to which a thing of a height blocks the sky's light [m]."""
    return 0.55 + 0.2 * height


@kernel
def reach_of(band: Band, first: int, last: int) -> float:
    """Return how far the parts in slots `first` to `last` are from the first's origin [m].

    In any direction; the corners of a `Caster` may be farther by a factor of `CORNER`.
    """
    geometry, movers, world = band.geometry, band.movers, band.world
    poses, parts = movers.pose[world], movers.part[world]
    reach = 0.0
    for slot in range(first, last):
        if parts[slot] < 0:
            continue
        pose, box = poses[slot], geometry.box[geometry.part_first + parts[slot]]
        square, scale, away = 0.0, 0.0, 0.0
        for axis in range(3):
            far = float(max(-box[axis], box[3 + axis]))
            square += far * far
            scale += float(pose[axis, 0]) ** 2
            away += float(pose[axis, 3] - poses[first, axis, 3]) ** 2
        reach = max(reach, math.sqrt(away) + math.sqrt(square * scale))
    return reach


@kernel(inline=True)
def _largest(band: Band, first: int, last: int) -> int:
    """Return the slot of the largest part that is not upright."""
    geometry, movers, world = band.geometry, band.movers, band.world
    poses, parts = movers.pose[world], movers.part[world]
    body, largest = first, f4(-1.0)
    for slot in range(first, last):
        if parts[slot] < 0:
            continue
        box = geometry.box[geometry.part_first + parts[slot]]
        size = (box[3] - box[0]) * (box[4] - box[1]) * (box[5] - box[2])
        if size > largest and poses[slot, 0, 0] ** 2 + poses[slot, 1, 0] ** 2 > f4(1e-12):
            body, largest = slot, size
    return body


@kernel(inline=True)
def has_lamps(band: Band, first: int, last: int) -> bool:
    """Return whether a thing has head and tail lamps."""
    body = _largest(band, first, last)
    geometry, part = band.geometry, band.movers.part[band.world, body]
    return bool(geometry.lamps[geometry.part_first + part])


@kernel
def caster_of(band: Band, first: int, last: int) -> Caster:
    """Return the box around slots `first` to `last`."""
    geometry, movers, world = band.geometry, band.movers, band.world
    poses, parts = movers.pose[world], movers.part[world]
    body = _largest(band, first, last)
    along_x, along_y = float(poses[body, 0, 0]), float(poses[body, 1, 0])
    flat = math.sqrt(along_x * along_x + along_y * along_y)
    along_x, along_y = (along_x / flat, along_y / flat) if flat > 1e-6 else (1.0, 0.0)
    origin_x, origin_y = float(poses[body, 0, 3]), float(poses[body, 1, 3])
    front, back, left, right, low, high = -1e9, 1e9, -1e9, 1e9, 1e9, -1e9
    for slot in range(first, last):
        if parts[slot] < 0:
            continue
        pose, box = poses[slot], geometry.box[geometry.part_first + parts[slot]]
        x, y, z = pose[0, 3] - origin_x, pose[1, 3] - origin_y, float(pose[2, 3])
        along, aside = x * along_x + y * along_y, y * along_x - x * along_y
        wide, deep, tall = 0.0, 0.0, 0.0
        for axis in range(3):
            middle, half = 0.5 * (box[3 + axis] + box[axis]), 0.5 * (box[3 + axis] - box[axis])
            x = pose[0, axis] * along_x + pose[1, axis] * along_y
            y = pose[1, axis] * along_x - pose[0, axis] * along_y
            along, aside, z = along + x * middle, aside + y * middle, z + pose[2, axis] * middle
            wide, deep = wide + abs(x) * half, deep + abs(y) * half
            tall += abs(pose[2, axis]) * half
        front, back = max(front, along + wide), min(back, along - wide)
        left, right = max(left, aside + deep), min(right, aside - deep)
        low, high = min(low, z - tall), max(high, z + tall)
    along, aside = 0.5 * (front + back), 0.5 * (left + right)
    ends = geometry.silhouette[geometry.part_first + parts[body]]
    return Caster(
        origin_x + along * along_x - aside * along_y,
        origin_y + along * along_y + aside * along_x,
        along_x,
        along_y,
        0.5 * (front - back),
        0.5 * (left - right),
        low,
        high,
        float(poses[body, 2, 3]) + ends[0],
        ends[1] - along,
        ends[2] - along,
        ends[3] - aside,
        ends[4] - aside,
        ends[5] - aside,
        ends[6] - aside,
        beyond(high - low),
    )


@kernel(inline=True)
def camera_of(caster: Caster, view: View) -> LocalCamera:
    """Return the camera in the thing's own frame: origin at the middle of its bottom."""
    origin = Direction(caster.x, caster.y, caster.bottom)
    return local_camera(view, origin, caster.along_x, caster.along_y)


@kernel(inline=True)
def boxes_of(caster: Caster, sun: Direction) -> ShadowBoxes:
    """Return what blocks the light from a direction."""
    height = caster.top - caster.bottom
    upright = height > _UPRIGHT * caster.width
    waist, top = f4(caster.waist - caster.bottom), f4(height)
    legs, trunk = 1.0, 1.0
    if upright:
        waist, legs, trunk = f4(_HIPS * height), _LEGS, _TRUNK
    long = f4(_ROUND * caster.length)
    lower = Box(
        -long, long, f4(legs * caster.lower_right),
        f4(legs * caster.lower_left), f4(0.0), waist,
    )  # fmt: skip
    upper = Box(
        f4(caster.back), f4(caster.front), f4(trunk * caster.right), f4(trunk * caster.left),
        waist, top,
    )  # fmt: skip
    turned = Direction(
        sun.x * caster.along_x + sun.y * caster.along_y,
        sun.y * caster.along_x - sun.x * caster.along_y,
        float(sun.z),
    )
    return shadow_boxes(lower, upper, turned, caster.width, caster.beyond, upright)
