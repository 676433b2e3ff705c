"""Outputs of pictures through a lens that differ from those of a pinhole."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import DARK, Band, LensTables, Output, Task
from eyas.engine.render.kernels.lens.resampling import to_camera
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.key import distance_inverse
from eyas.engine.state.scene import SKY_OBJECT, ObjectClass
from eyas.lanes import kernel
from eyas.lanes.vector import WIDTH, any_of, load

_SKY = int(ObjectClass.SKY)


@kernel
def write_bent_depth(
    band: Band,  # One sample for each pixel
    output: NDArray[np.float32],  # Shape (rows, columns)
) -> None:
    """Write the distance along the camera's optical axis of each pixel that the band shows [m].

    Keys have it along the axis of their face.
    """
    key, glass, view = band.key, band.glass, band.camera
    for row in range(band.lines):
        for column in range(band.columns):
            shown = key[row, column]
            if shown < i8(0):
                continue
            left = (0.5 * view.width - glass.column[row, column]) / view.focal_x
            up = (0.5 * view.height - glass.line[row, column]) / view.focal_y
            forward, _, _ = to_camera(glass, 1.0, left, up)
            output[row, column] = f4(forward) / distance_inverse(shown)


@kernel
def darken(task: Task, tables: LensTables, output: Output, index: int) -> None:
    """Write the pixels of a band to which no light comes: black, and the ids of the sky."""
    job = task.job
    number, top, bottom = job.band[index, 0], job.band[index, 1], job.band[index, 2]
    face, into = tables.face[job.lens[number]], job.picture[number]
    across, stride = task.across, face.shape[1]
    for row in range(top, bottom):
        for start in range(0, task.width * across, WIDTH):
            if not any_of(load(face, row * task.down * stride + start) == i4(DARK)):
                continue
            for column in range(start // across, min((start + WIDTH) // across, task.width)):
                if face[row * task.down, column * across] == DARK:
                    _write_dark(output, into, row, column)


@kernel(inline=True)
def _write_dark(output: Output, into: int, row: int, column: int) -> None:
    """Write a pixel to which no light comes."""
    if len(output.rgb) > 0:
        for channel in range(3):
            output.rgb[into, row, column, channel] = 0
    if len(output.radiance) > 0:
        for channel in range(3):
            output.radiance[into, channel, row, column] = 0.0
    if len(output.depth) > 0:
        output.depth[into, row, column] = np.inf
    if len(output.object_id) > 0:
        output.object_id[into, row, column] = SKY_OBJECT
    if len(output.class_id) > 0:
        output.class_id[into, row, column] = _SKY
    if len(output.normal) > 0:
        output.normal[into, row, column] = 0
