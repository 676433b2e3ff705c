"""Visibility of a band: static chunks, fixtures, moving parts."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inner_kernel
from eyas.render.kernels.bundles import GROUP, Geometry
from eyas.render.kernels.scalars import i8
from eyas.render.kernels.visibility.cull import box_is_visible, sphere_is_visible, visible_chunks
from eyas.render.kernels.visibility.meshes import draw_mesh, level_of_detail
from eyas.render.kernels.visibility.transform import set_object_rows

__all__ = ["draw_moving", "draw_static"]

SMALLEST = 0.4
"""Things with a smaller radius are left out [pixels]."""

SMALLEST_DETAIL = 0.35
"""Details whose area has a smaller root are left out [pixels]."""


@inner_kernel
def draw_static(
    until: int,
    geometry: Geometry,
    eye: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    rows: NDArray[np.float64],
    planes: NDArray[np.float64],
    order: NDArray[np.int64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    screen: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw the static scene; see `Job` and `Scratch` for the arguments. `rows` is (2, 3, 4)."""
    count = visible_chunks(planes, eye, geometry.chunk_box, geometry.chunk_group_box, order)
    for k in range(count):
        chunk = order[k] & i8(0xFFFFFFFF)
        smallest = SMALLEST_DETAIL * 0.001 * (order[k] >> i8(32)) / lens[3]
        draw_mesh(
            until, geometry, rows[0], geometry.chunk_range, chunk, -1, lens[3], smallest, lens[1],
            lens[2], top, depth, owner, screen, polygon,
        )  # fmt: skip
    fixtures = len(geometry.fixture_prototype)
    for group in range(len(geometry.fixture_group_box)):
        if not box_is_visible(planes, geometry.fixture_group_box, group):
            continue
        for i in range(group * GROUP, min((group + 1) * GROUP, fixtures)):
            _draw_instance(
                until, geometry, geometry.fixture_prototype[i], geometry.fixture_pose, i, i, eye,
                lens, top, rows, planes, depth, owner, screen, polygon,
            )  # fmt: skip


@inner_kernel
def draw_moving(
    until: int,
    geometry: Geometry,
    parts: NDArray[np.int32],
    poses: NDArray[np.float32],
    object_ids: NDArray[np.int32],
    only: int,
    eye: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    rows: NDArray[np.float64],
    planes: NDArray[np.float64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    screen: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw the parts in one world's draw list, of object `only` alone if it is not negative."""
    fixtures = len(geometry.fixture_prototype)
    for slot in range(len(parts)):
        if parts[slot] < 0 or (only >= 0 and object_ids[slot] != only):
            continue
        _draw_instance(
            until, geometry, geometry.part_first + parts[slot], poses, slot, fixtures + slot, eye,
            lens, top, rows, planes, depth, owner, screen, polygon,
        )  # fmt: skip


@inner_kernel
def _draw_instance(
    until: int,
    geometry: Geometry,
    prototype: int,
    poses: NDArray[np.float32],
    index: int,
    instance: int,
    eye: NDArray[np.float64],
    lens: NDArray[np.float64],
    top: int,
    rows: NDArray[np.float64],
    planes: NDArray[np.float64],
    depth: NDArray[np.float32],
    owner: NDArray[np.int64],
    screen: NDArray[np.float64],
    polygon: NDArray[np.float64],
) -> None:
    """Draw prototype `prototype` at pose `index`, as instance `instance`."""
    x, y, z = (
        geometry.sphere[prototype, 0],
        geometry.sphere[prototype, 1],
        geometry.sphere[prototype, 2],
    )
    pose = poses[index]
    px = pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3]
    py = pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3]
    pz = pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3]
    scale = math.sqrt(float(pose[0, 0]) ** 2 + float(pose[1, 0]) ** 2 + float(pose[2, 0]) ** 2)
    radius = geometry.sphere[prototype, 3] * scale
    if not sphere_is_visible(planes, px, py, pz, radius):
        return
    distance = math.sqrt((px - eye[0]) ** 2 + (py - eye[1]) ** 2 + (pz - eye[2]) ** 2)
    if radius * lens[3] < SMALLEST * distance:
        return
    mesh = level_of_detail(geometry, prototype, radius, distance, lens[3])
    set_object_rows(rows[0], poses, index, rows[1])
    draw_mesh(
        until, geometry, rows[1], geometry.mesh_range, mesh, instance, lens[3] * scale, 0.0,
        lens[1], lens[2], top, depth, owner, screen, polygon,
    )  # fmt: skip
