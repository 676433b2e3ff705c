"""Listing of what a band shows: chunks of the static scene, fixtures, parts of moving things."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import GROUP, Band
from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.visibility.cull import (
    Sides,
    boxes_seen,
    sides_of,
    sphere_is_visible,
    spheres_seen,
)
from eyas.engine.render.kernels.visibility.meshes import level_of_detail
from eyas.engine.render.kernels.visibility.transform import scale_of
from eyas.engine.render.kernels.wind import leaned, sways
from eyas.lanes import kernel
from eyas.lanes.vector import (
    bits_of,
    first_bit,
    gather,
    gather_column,
    greater,
    lane_numbers,
    lesser,
    root,
    transposed,
)

SMALLEST = 0.4  # Things with a smaller radius are left out [pixels]

EIGHT = 8

_POSE = 12  # Numbers in a pose


@kernel(inline=True)
def _sort_key(distance: float, item: int) -> int:
    """Return an entry of `Scratch.order` for a thing at a distance [m]: in millimetres, in its
    upper half. Its lower half holds a chunk, or C + a row of `drawn`.
    """
    return (i8(1000.0 * distance) << i8(32)) | i8(item)


@kernel(inline=True)
def list_chunks(band: Band) -> int:
    """List the visible chunks; return how many there are."""
    geometry, view, order = band.geometry, band.camera, band.order
    boxes, eye, count, sides = geometry.chunk_box, view.eye, i8(0), sides_of(view.planes)
    for eight in range(0, geometry.chunk_group_box.shape[1], EIGHT):
        groups = boxes_seen(sides, geometry.chunk_group_box, eight)
        while groups != 0:
            group = eight + first_bit(groups)
            groups &= groups - 1
            for start in range(group * GROUP, (group + 1) * GROUP, EIGHT):
                seen = boxes_seen(sides, boxes, start)
                while seen != 0:
                    i = start + first_bit(seen)
                    seen &= seen - 1
                    x = max(boxes[0, i] - eye.x, eye.x - boxes[3, i], 0.0)
                    y = max(boxes[1, i] - eye.y, eye.y - boxes[4, i], 0.0)
                    z = max(boxes[2, i] - eye.z, eye.z - boxes[5, i], 0.0)
                    order[count] = _sort_key(math.sqrt(x * x + y * y + z * z), i)
                    count += 1
    return count


@kernel(inline=True)
def _list_instance(
    band: Band,
    prototype: int,
    poses: NDArray[np.float32],
    index: int,
    instance: int,
    chunks: int,
    count: int,
) -> int:
    """List prototype `prototype` at pose `index`, as instance `instance`, if it may be seen.

    Returns:
        How many instances are listed then; `chunks + count` are listed in `order` before.
    """
    geometry, view, drawn = band.geometry, band.camera, band.drawn
    pose, sphere, eye = poses[index], geometry.sphere[prototype], view.eye
    x = pose[0, 0] * sphere[0] + pose[0, 1] * sphere[1] + pose[0, 2] * sphere[2] + pose[0, 3]
    y = pose[1, 0] * sphere[0] + pose[1, 1] * sphere[1] + pose[1, 2] * sphere[2] + pose[1, 3]
    z = pose[2, 0] * sphere[0] + pose[2, 1] * sphere[1] + pose[2, 2] * sphere[2] + pose[2, 3]
    radius = sphere[3] * scale_of(poses, index)
    if not sphere_is_visible(view.planes, x, y, z, radius):
        return count
    distance = math.sqrt((x - eye.x) ** 2 + (y - eye.y) ** 2 + (z - eye.z) ** 2)
    if radius * view.focal < SMALLEST * distance or count >= len(drawn):
        return count
    mesh = level_of_detail(geometry, prototype, radius, distance, view.focal)
    if geometry.mesh_range[mesh, 0] == geometry.mesh_range[mesh, 1]:  # nothing is seen from here
        return count
    drawn[count, 0], drawn[count, 1] = geometry.mesh_range[mesh, 0], instance
    band.mesh[count] = mesh
    item = geometry.chunk_range.shape[0] + count
    band.order[chunks + count] = _sort_key(max(distance - radius, 0.0), item)
    return count + 1


@kernel(inline=True)
def list_fixtures(band: Band, chunks: int) -> int:
    """List the visible fixtures; return how many there are."""
    geometry, light, count = band.geometry, band.light, i8(0)
    sides = sides_of(band.camera.planes)
    for eight in range(0, geometry.fixture_group_box.shape[1], EIGHT):
        groups = boxes_seen(sides, geometry.fixture_group_box, eight)
        while groups != 0:
            group = eight + first_bit(groups)
            groups &= groups - 1
            for start in range(group * GROUP, (group + 1) * GROUP, EIGHT):
                seen = boxes_seen(sides, geometry.fixture_box, start)
                while seen != 0:
                    i = start + first_bit(seen)
                    seen &= seen - 1
                    prototype, poses = geometry.fixture_prototype[i], geometry.fixture_pose
                    if sways(light, i) and count < len(band.leaning):
                        leaned(light, band.lit.wind, i, poses[i], band.leaning[count])
                        count = _list_instance(
                            band, prototype, band.leaning, count, i, chunks, count
                        )
                    else:
                        count = _list_instance(band, prototype, poses, i, i, chunks, count)
    return count


@kernel(inline=True)
def _slots_seen(band: Band, sides: Sides, first: int, last: int) -> int:
    """Return which of eight slots may be seen, a bit each."""
    geometry, movers, world = band.geometry, band.movers, band.world
    slot = lane_numbers() + i4(first)
    inside = slot < i4(last)
    slot = lesser(slot, i4(last - 1))
    part = gather(movers.part[world], slot)
    wanted = inside & (part >= i4(0))
    prototype = greater(part, i4(0)) + i4(geometry.part_first)
    poses = movers.pose[world]
    xx, xy, xz, x, yx, yy, yz, y = transposed(poses, slot, 0, _POSE, slot)
    zx = gather_column(poses, slot, 8, _POSE)
    zy = gather_column(poses, slot, 9, _POSE)
    zz = gather_column(poses, slot, 10, _POSE)
    z = gather_column(poses, slot, 11, _POSE)
    a = gather_column(geometry.sphere, prototype, 0, 4)
    b = gather_column(geometry.sphere, prototype, 1, 4)
    c = gather_column(geometry.sphere, prototype, 2, 4)
    radius = gather_column(geometry.sphere, prototype, 3, 4) * root(xx * xx + yx * yx + zx * zx)
    x += xx * a + xy * b + xz * c
    y += yx * a + yy * b + yz * c
    z += zx * a + zy * b + zz * c
    return bits_of(wanted & spheres_seen(sides, x, y, z, radius))


@kernel(inline=True)
def list_slots(band: Band, first: int, last: int, chunks: int, count: int) -> int:
    """List the visible slots of a draw list; return how many instances are listed then."""
    geometry, movers, world = band.geometry, band.movers, band.world
    parts, poses = movers.part[world], movers.pose[world]
    fixtures = len(geometry.fixture_prototype)
    if len(geometry.sphere) == geometry.part_first:  # no part at all, so no row to gather
        return count
    sides = sides_of(band.camera.planes)
    for start in range(first, last, EIGHT):
        seen = _slots_seen(band, sides, start, last)
        while seen != 0:
            slot = start + first_bit(seen)
            seen &= seen - 1
            prototype = geometry.part_first + parts[slot]
            count = _list_instance(band, prototype, poses, slot, fixtures + slot, chunks, count)
    return count
