"""Triangles that are filled later: all workers of a view then share its rows evenly.

A device draws a view with many threads. If those that find a triangle filled it too, a few of them
would fill what covers the picture while the others wait.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    claim_some,
    gather,
    lane_numbers,
    scatter,
    select,
    splat,
    store_where,
)
from eyas.render.kernels.bundles import Band
from eyas.render.kernels.scalars import i4, i8
from eyas.render.kernels.visibility.fill import fill, fill_rows, slopes_of
from eyas.render.kernels.visibility.holes import Holes, holes_of, no_holes
from eyas.render.kernels.visibility.triangles import FIRST_ROW, LAST_ROW, TRIANGLE_ROWS

__all__ = ["MOST_PASSES", "fill_or_record", "fill_recorded"]

MOST_PASSES = 64
"""Eight rows of a triangle are a unit; so many of them may be told apart."""


@kernel(inline=True)
def fill_or_record(
    band: Band, key: NDArray[np.int64], column: int, tag: int, layer: int, holes: Holes
) -> None:
    """Fill a triangle, or record it, if workers share the band and there is room for it.

    Args:
        band: The band.
        key: What to fill it into; if it is recorded, `Band.key`.
        column: Its column of `Band.triangle`.
        tag: See `fill`.
        layer: Texture of its holes.
        holes: Its holes.
    """
    view, triangle = band.camera, band.triangle
    recorded = False
    if band.members > 1:
        recorded = _record(band, column, tag, layer, holes)
    if not recorded:
        fill(triangle, column, view.top, view.width, key, tag, holes, band.span)


@kernel(inline=True)
def _record(band: Band, column: int, tag: int, layer: int, holes: Holes) -> bool:
    """Record a triangle; return whether there is room for it."""
    triangle, record, unit, shown = band.triangle, band.record, band.unit, band.record_shown
    first = i8(gather(triangle, FIRST_ROW * WIDTH + column))
    last = i8(gather(triangle, LAST_ROW * WIDTH + column))
    passes = (last - first + WIDTH - 1) // WIDTH
    if len(record) == 0 or passes > MOST_PASSES:
        return False
    claimed = claim_some(band.recorded, (passes << i8(32)) | i8(1))
    number, begin = claimed & i8(0xFFFFFFFF), claimed >> i8(32)
    room = number < len(shown) and begin + passes <= len(unit)
    numbers = lane_numbers()
    for at in range(begin, min(begin + passes, len(unit)), WIDTH):
        kept = splat(i4(-1))
        if room:
            kept = numbers + i4(number * MOST_PASSES + at - begin)
        store_where(unit, at, numbers < i4(min(begin + passes, len(unit)) - at), kept)
    if not room:
        return False
    into, place = record[number // WIDTH], number % WIDTH
    for row in range(0, TRIANGLE_ROWS, WIDTH):
        rows = numbers + i4(row)
        wanted = rows < i4(TRIANGLE_ROWS)
        at = select(wanted, rows, i4(0)) * i4(WIDTH)
        scatter(into, at + i4(place), wanted, gather(triangle, at + i4(column)))
    shown[number, 0] = tag
    shown[number, 1] = layer * 16 + holes.level if holes.level >= 0 else i8(-1)
    return True


@kernel(inline=True)
def fill_recorded(band: Band) -> None:
    """Fill a worker's share of the recorded triangles."""
    view, geometry, unit = band.camera, band.geometry, band.unit
    count = min(band.recorded[0] >> i8(32), len(unit))
    for at in range(band.member, count, band.members):
        which = i8(unit[at])
        if which < 0:
            continue
        number, part = which // MOST_PASSES, which % MOST_PASSES
        triangle, column = band.record[number // WIDTH], number % WIDTH
        tag, leaves = band.record_shown[number, 0], band.record_shown[number, 1]
        holes = no_holes(geometry.texture)
        if leaves >= 0:
            holes = holes_of(geometry.texture, leaves // 16, leaves % 16)
        row = i8(gather(triangle, FIRST_ROW * WIDTH + column)) + part * WIDTH
        last = i8(gather(triangle, LAST_ROW * WIDTH + column))
        slopes = slopes_of(triangle, column, holes)
        fill_rows(
            triangle, column, slopes, row, last, view.top, view.width, band.key, tag, holes,
            band.span,
        )  # fmt: skip
