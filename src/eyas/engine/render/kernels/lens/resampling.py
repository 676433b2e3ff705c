"""Views through a lens: its faces, and what the samples of the picture show of them.

The rasteriser needs straight lines, so it draws a picture of a pinhole, a face, in which each
sample of the real picture has its place; of that sample, what it shows is looked up, and then
shaded along its own ray. Nothing is shaded that is not seen, and nothing is blurred.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens, distorted
from eyas.engine.render.kernels.bundles import (
    ELSEWHERE,
    Band,
    Glass,
    Job,
    LensTables,
    Point,
    Task,
    View,
)
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.key import distance_inverse, key_of, tag_of
from eyas.engine.render.kernels.visibility.transform import view_along
from eyas.lanes import address_of, kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    gather,
    load,
    magnitude,
    select,
    splat,
    store,
    store_words,
    to_f4,
    to_i4,
)


@kernel
def shown_rows(tables: LensTables, slot: int, face: int, top: int, bottom: int) -> tuple[int, int]:
    """Return the first of some rows of the picture that shows a face, and the one after the last;
    the last is not after the first if none does.
    """
    rows, first, last = tables.row[slot, face], bottom, top
    for row in range(top, bottom):
        if rows[row, 0] < rows[row, 1]:
            first, last = min(first, row), row + 1
    return first, last


@kernel
def face_rows(tables: LensTables, slot: int, face: int, top: int, bottom: int) -> tuple[int, int]:
    """Return the first row of a face that rows of the picture need, and after the last [pixels]."""
    first, last = i8(tables.extent[slot, face, 1]), i8(0)
    for row in range(top, bottom):
        first = min(first, i8(tables.row[slot, face, row, 0]))
        last = max(last, i8(tables.row[slot, face, row, 1]))
    return first, last


@kernel(inline=True)
def _axis(job: Job, number: int, tables: LensTables, slot: int, face: int, axis: int) -> Point:
    """Return an axis of a face in the world."""
    axes, turn = job.axes[number], tables.turn[slot, face, axis]
    return Point(
        turn[0] * axes[0, 0] + turn[1] * axes[1, 0] + turn[2] * axes[2, 0],
        turn[0] * axes[0, 1] + turn[1] * axes[1, 1] + turn[2] * axes[2, 1],
        turn[0] * axes[0, 2] + turn[1] * axes[1, 2] + turn[2] * axes[2, 2],
    )


@kernel
def face_view(
    task: Task, tables: LensTables, number: int, face: int, first: int, last: int
) -> View:
    """Return rows of a face of a view as a view of its own."""
    job, slot = task.job, task.job.lens[number]
    eye = Point(job.eye[number, 0], job.eye[number, 1], job.eye[number, 2])
    axes = (
        _axis(job, number, tables, slot, face, 0),
        _axis(job, number, tables, slot, face, 1),
        _axis(job, number, tables, slot, face, 2),
    )
    focal = tables.focal[slot, face, 0], tables.focal[slot, face, 1]
    size = i8(tables.extent[slot, face, 0]), i8(tables.extent[slot, face, 1])
    return view_along(eye, axes, focal, size, (first, last), task)


@kernel
def glass_of(task: Task, tables: LensTables, number: int, face: int, top: int) -> Glass:
    """Return the lens of a band of a view that begins at a row of pixels."""
    slot, first = task.job.lens[number], top * task.down
    n, camera = tables.lens[slot], tables.camera[slot]
    lens = Lens(i8(n[0]), n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9])
    return Glass(
        1, tables.column[slot, first:], tables.line[slot, first:], tables.size[slot, first:],
        tables.face[slot, first:], face, tables.tile[slot, face], tables.turn[slot, face], top,
        lens, camera[0], camera[1], camera[2], camera[3] - top,
    )  # fmt: skip


@kernel(inline=True)
def _inverse_at(
    source: Band,  # The face
    keys: int,  # What the samples show
    at: int,  # Where they are
    aside: float,  # -0.5 to 0.5 [samples]
    below: float,  # The same
) -> float:
    """Return 1/distance of eight samples' triangles, aside and below of the samples' centres.

    It is linear on the screen, so neighbours that show the same triangle tell it.
    """
    key, tag, own = source.key, tag_of(keys), distance_inverse(keys)
    one, stride, zero = i4(1), i4(source.key.shape[1]), f4(0.0)
    beside = gather(key, select(aside < zero, at - one, at + one))
    under = gather(key, select(below < zero, at - stride, at + stride))
    inverse = own
    same = (tag_of(beside) == tag) & (beside != i8(0))
    inverse += select(same, magnitude(aside) * (distance_inverse(beside) - own), zero)
    same = (tag_of(under) == tag) & (under != i8(0))
    inverse += select(same, magnitude(below) * (distance_inverse(under) - own), zero)
    return select(inverse > zero, inverse, own)


@kernel
def look_through(
    source: Band,  # The face, drawn
    word: NDArray[np.uint32],  # See `Scratch`, shape (rows, columns)
    bent: Band,  # The picture; its `key` and `shade` are written
    words: bool,  # Whether `shade` is wanted
) -> None:
    """Write what the samples of a picture show of a face."""
    glass, key = bent.glass, source.key
    top = f4(bent.camera.top)
    columns, stride = glass.column.shape[1], bent.key.shape[1]
    face, half, wide = i4(glass.number), f4(0.5), i4(key.shape[1])
    for row in range(bent.lines * bent.camera.down):
        for first in range(0, columns, WIDTH):
            here = row * columns + first
            mine, to = load(glass.face, here) == face, row * stride + first
            if not any_of(mine):
                store(bent.key, to, splat(i8(ELSEWHERE)))
                continue
            column, line = load(glass.column, here), load(glass.line, here) - top
            column, line = select(mine, column, f4(1.5)), select(mine, line, f4(1.5))
            x, y = to_i4(column), to_i4(line)
            at = y * wide + x
            keys = gather(key, at)
            aside, below = column - to_f4(x) - half, line - to_f4(y) - half
            inverse = _inverse_at(source, keys, at, aside, below)
            shown = key_of(inverse, keys & i8(0xFFFFFFFF))
            shown = select(keys == i8(0), splat(i8(0)), shown)
            store(bent.key, to, select(mine, shown, splat(i8(ELSEWHERE))))
            if words:
                store_words(bent.shade, 4 * to, gather(word, at))


@kernel(inline=True)
def to_camera(glass: Glass, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return how far forward, left and up of the camera a direction in a face goes."""
    turn = glass.turn
    return (
        turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z,
        turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z,
        turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z,
    )


@kernel
def shown_at(glass: Glass, ahead: float, left: float, up: float) -> tuple[float, float]:
    """Return column, and row of the band, at which a direction in a face is seen [pixels].

    Those behind the camera are seen far away from the picture.
    """
    forward, aside, above = to_camera(glass, ahead, left, up)
    if forward <= 1e-9:
        return -1e6, -1e6
    x, y = distorted(address_of(glass.lens), -aside, -above, forward)
    return glass.middle + glass.focal_x * x, glass.centre + glass.focal_y * y
