"""Pictures: the loop over bands of views, and the steps of each."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.intrinsics import claim
from eyas.core.jit import inner_kernel
from eyas.core.parallel import Pointer, parallel_kernel
from eyas.render.kernels.bundles import Geometry, Scratch, Still, Task, View
from eyas.render.kernels.light.casters import cast_light
from eyas.render.kernels.light.view_light import view_light
from eyas.render.kernels.scalars import f4, i8
from eyas.render.kernels.sky.backdrop import draw_backdrop
from eyas.render.kernels.sky.flakes import FlakeView, let_flakes_fall
from eyas.render.kernels.surface.band import shade_band
from eyas.render.kernels.visibility.cull import set_planes
from eyas.render.kernels.visibility.passes import draw_moving, draw_static
from eyas.render.kernels.visibility.transform import set_world_rows
from eyas.state.draw import DrawStage
from eyas.state.scene import SKY_OBJECT

__all__ = ["draw_views"]

RASTERISING = int(DrawStage.RASTERISING)
MOVERS_LIGHT = int(DrawStage.MOVERS_LIGHT)


@parallel_kernel
def draw_views(
    parts: Pointer[tuple[Pointer[Still], Pointer[Scratch], Pointer[Task]]],
    worker: int,
    workers: int,
) -> None:
    """Draw all jobs. Each is drawn alone, so neither workers nor other jobs change its bytes."""
    still, scratch, task = parts[0]
    geometry, light = still[0]
    memory = scratch[0]
    samples, until, movers, job, output = task[0]
    lens = job.lens
    rows, planes = memory.rows[worker], memory.planes[worker]
    screen, polygon = memory.screen[worker], memory.polygon[worker]
    index = i8(worker)
    while index < len(job.band):
        view, top, bottom = job.band[index, 0], job.band[index, 1], job.band[index, 2]
        first, last = top * samples, bottom * samples
        eye, axes, world = job.eye[view], job.axes[view], job.world[view]
        part, pose, object_id = movers.part[world], movers.pose[world], movers.object_id[world]
        depth = memory.depth[worker, : last - first]
        owner = memory.owner[worker, : last - first]
        shade = memory.shade[worker, : last - first]
        depth[:], owner[:] = f4(0.0), -1
        set_world_rows(eye, axes, lens, rows[0])
        set_planes(rows[0], lens[1], lens[2], first, last, planes)
        draw_static(
            until, geometry, eye, lens, first, rows, planes, memory.order[worker], depth, owner,
            screen, polygon,
        )  # fmt: skip
        draw_moving(
            until, geometry, part, pose, object_id, -1, eye, lens, first, rows, planes, depth,
            owner, screen, polygon,
        )  # fmt: skip
        if len(output.depth) > 0:
            _write_depth(depth, output.depth[view, top:bottom])
        if len(output.object_id) > 0:
            _write_objects(geometry, object_id, owner, output.object_id[view, top:bottom])
        if len(output.rgb) > 0 and until > RASTERISING:
            band = View(eye, axes, lens, first, rows[0], planes, depth, owner)
            cast_light(
                geometry, part, pose, object_id, light.sun, light.air[5], band,
                memory.caster[worker], shade,
            )  # fmt: skip
        if len(output.rgb) > 0 and until > MOVERS_LIGHT:
            lit = view_light(light, job.light[view], memory.light[worker])
            pixels = output.rgb[view, top:bottom]
            draw_backdrop(samples, top, lit, axes, lens, owner, pixels)
            shade_band(
                samples, top, geometry, lit, pose, movers.colour[world], eye, axes, lens, depth,
                owner, shade, memory.frame[worker], pixels,
            )  # fmt: skip
            if len(job.instant) > 0 and light.air[8] > f4(0.0):
                falling = FlakeView(
                    samples, top, lit, job.instant[view], eye, axes, lens, depth, pixels
                )
                let_flakes_fall(falling)
        if len(output.subject) > 0:
            result = output.subject[index]
            result[:] = 0
            subject = job.subject[view]
            if subject >= 0:
                result[4] = _seen(geometry, object_id, owner, subject)
                depth[:], owner[:] = f4(0.0), -1
                draw_moving(
                    until, geometry, part, pose, object_id, subject, eye, lens, first, rows,
                    planes, depth, owner, screen, polygon,
                )  # fmt: skip
                _measure(owner, top, result)
        index = claim(job.begun)


@inner_kernel
def _write_depth(depth: NDArray[np.float32], output: NDArray[np.float32]) -> None:
    for row in range(depth.shape[0]):
        for column in range(depth.shape[1]):
            output[row, column] = f4(1.0) / depth[row, column]


@inner_kernel
def _object_of(geometry: Geometry, object_ids: NDArray[np.int32], owner: int) -> int:
    """Return the object id for an entry of `Scratch.owner`."""
    if owner < 0:
        return SKY_OBJECT
    instance = (owner >> 32) - 1
    if instance < 0:
        return i8(geometry.object_id[owner & 0xFFFFFFFF])
    if instance < len(geometry.fixture_object):
        return i8(geometry.fixture_object[instance])
    return i8(object_ids[instance - len(geometry.fixture_object)])


@inner_kernel
def _write_objects(
    geometry: Geometry,
    object_ids: NDArray[np.int32],
    owner: NDArray[np.int64],
    output: NDArray[np.int32],
) -> None:
    for row in range(owner.shape[0]):
        for column in range(owner.shape[1]):
            output[row, column] = _object_of(geometry, object_ids, owner[row, column])


@inner_kernel
def _seen(
    geometry: Geometry, object_ids: NDArray[np.int32], owner: NDArray[np.int64], subject: int
) -> int:
    """Return how many samples show the subject."""
    count = 0
    for row in range(owner.shape[0]):
        for column in range(owner.shape[1]):
            if _object_of(geometry, object_ids, owner[row, column]) == subject:
                count += 1
    return count


@inner_kernel
def _measure(owner: NDArray[np.int64], top: int, result: NDArray[np.int32]) -> None:
    """Write the box of what is drawn, and how many samples it covers."""
    for row in range(owner.shape[0]):
        for column in range(owner.shape[1]):
            if owner[row, column] < 0:
                continue
            if result[5] == 0:
                result[0], result[1] = column, top + row
            result[0] = min(result[0], column)
            result[2] = max(result[2], column + 1)
            result[3] = top + row + 1
            result[5] += 1
