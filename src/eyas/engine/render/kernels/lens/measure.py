"""Boxes and pixels of moving things in pictures through a lens."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import LENS_TILE, Band
from eyas.engine.render.kernels.samples import ScreenBox
from eyas.engine.render.kernels.scalars import f4, i4, i8
from eyas.engine.render.kernels.visibility.key import tag_of
from eyas.engine.render.kernels.visibility.scene_iterator import belongs_to
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    bits_of,
    first_bit,
    gather,
    lane_numbers,
    load,
    select,
    splat,
    store,
    to_i4,
)

_FAR = 1 << 30


@kernel
def _searched(bent: Band, box: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return the part of the picture in which samples of a face may be seen.

    Args:
        bent: The picture.
        box: First and last line and column of the samples, in the whole face.

    Returns:
        First and last line of the band and column, the last two exclusive.
    """
    tile, top = bent.glass.tile, bent.glass.top
    first, last, begin, end = i8(_FAR), i8(0), i8(_FAR), i8(0)
    for i in range(box[0] // LENS_TILE, box[1] // LENS_TILE + 1):
        for j in range(box[2] // LENS_TILE, box[3] // LENS_TILE + 1):
            begin, first = min(begin, i8(tile[i, j, 0])), min(first, i8(tile[i, j, 1]))
            end, last = max(end, i8(tile[i, j, 2])), max(last, i8(tile[i, j, 3]))
    return max(first - top, 0), min(last - top, bent.lines), begin, min(end, bent.columns)


@kernel
def _count_row(
    source: Band, bent: Band, line: int, place: int, things: tuple[int, int],
    result: NDArray[np.int32],
) -> None:  # fmt: skip
    """Add eight pixels of a row to the boxes and pixels of a thing."""
    glass, at = bent.glass, line * bent.glass.column.shape[1] + place
    mine = load(glass.face, at) == i4(glass.number)
    mine &= lane_numbers() < i4(bent.columns - place)
    if not any_of(mine):
        return
    column = select(mine, load(glass.column, at), f4(1.5))
    below = select(mine, load(glass.line, at) - f4(source.camera.top), f4(1.5))
    of = to_i4(below) * i4(source.alone.shape[1]) + to_i4(column)
    covered = mine & (gather(source.alone, of) != i8(0))
    if not any_of(covered):
        return
    tag = tag_of(select(covered, load(bent.key, line * bent.key.shape[1] + place), splat(i8(0))))
    row = bent.glass.top + line
    _add(result, 0, 5, row, place, bits_of(covered))
    _add(result, 6, 4, row, place, bits_of(covered & belongs_to(tag, bent.drawn, *things)))


@kernel(inline=True)
def _add(result: NDArray[np.int32], box: int, count: int, row: int, place: int, bits: int) -> None:
    """Extend the box at `result[box]`, and the number of its pixels at `result[count]`."""
    while bits != 0:
        column = place + first_bit(bits)
        bits &= bits - 1
        if result[count] == 0:
            result[box], result[box + 1] = column, row
            result[box + 2], result[box + 3] = column + 1, row + 1
        result[box], result[box + 1] = min(result[box], column), min(result[box + 1], row)
        result[box + 2] = max(result[box + 2], column + 1)
        result[box + 3] = max(result[box + 3], row + 1)
        result[count] += 1


@kernel
def count_bent(
    source: Band,  # The face, one sample for each pixel
    bent: Band,  # The picture
    box: ScreenBox,  # Where the thing is in the face
    margin: int,  # Width of the border around it that is searched, too
    things: tuple[int, int],  # First instance, and last + 1
    result: NDArray[np.int32],  # See `Output.actor`, with what other faces show of it; shape (10,)
) -> None:
    """Add boxes and pixels of instances from `Band.alone` of a face; clear it afterwards."""
    view, alone = source.camera, source.alone
    begin = max(int(box.left) - margin, 0)
    end = min(int(box.right) + 1 + margin, view.width)
    first = max(int(box.top) - margin, view.top)
    last = min(int(box.bottom) + 1 + margin, view.top + view.rows)
    if begin >= end or first >= last:
        return
    top, bottom, left, right = _searched(bent, (first, last - 1, begin, end - 1))
    for line in range(top, bottom):
        for place in range(left & -WIDTH, right, WIDTH):
            _count_row(source, bent, line, place, things, result)
    stride = alone.shape[1]
    for line in range(first - view.top, last - view.top):
        for place in range(begin & -WIDTH, end, WIDTH):
            store(alone, line * stride + place, splat(i8(0)))
