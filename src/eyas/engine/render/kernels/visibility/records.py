"""Triangles that are filled later: all workers of a view then share its rows evenly.

A device draws a view with many threads. If those that find a triangle filled it too, a few of them
would fill what covers the picture while the others wait.
"""

from eyas.engine.render.kernels.bundles import Band
from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.visibility.clusters import CLUSTER
from eyas.engine.render.kernels.visibility.fill import fill_row, fill_rows, slopes_of
from eyas.engine.render.kernels.visibility.holes import holes_of
from eyas.engine.render.kernels.visibility.leaves import leaves_of
from eyas.engine.render.kernels.visibility.triangles import FIRST_ROW, LAST_ROW, TRIANGLE_ROWS
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    claim_some,
    count_bits,
    first_bit,
    gather,
    lane,
    lane_numbers,
    load,
    own,
    scatter,
    select,
    to_i4,
)

MOST_ROWS = 1024
"""So many rows of samples of a triangle may be told apart; taller ones are not recorded."""


@kernel(inline=True)
def _record_own_triangle(
    band: Band, drawn: int, cluster: int, number: int, focal: float, tag: int
) -> int:
    """Do what `record_triangles` does; each thread records the triangle of its own column."""
    triangle, record, unit, shown = band.triangle, band.record, band.unit, band.record_shown
    numbers, left = lane_numbers(), i8(0)
    column = i8(own(numbers))
    wanted = (drawn >> column) & 1 != 0
    rows = to_i4(load(triangle, LAST_ROW * WIDTH)) - to_i4(load(triangle, FIRST_ROW * WIDTH))
    rows = select(wanted, rows, i4(0))
    before, total, tallest = i4(0), i4(0), i4(0)
    for k in range(WIDTH):
        here = lane(rows, k)
        if k < column:
            before += here
        total += here
        tallest = max(tallest, here)
    if len(record) == 0 or tallest > MOST_ROWS:
        return drawn
    claimed = claim_some(band.recorded, (i8(total) << i8(32)) | count_bits(drawn))
    first, begin = claimed & i8(0xFFFFFFFF), claimed >> i8(32)
    room = first + count_bits(drawn) <= len(shown) and begin + total <= len(unit)
    if not room:
        left = drawn
    if wanted:
        into = first + count_bits(drawn & ((1 << column) - 1))
        at = i4(begin + before)
        end, value = i4(min(begin + before + own(rows), len(unit))), i4(into * MOST_ROWS)
        while at < end:  # numbers of 32 bits: those of 64 take a card twice the time
            scatter(unit, at, room, value)
            scatter(unit, at, not room, i4(-1))
            at, value = i4(at + i4(1)), i4(value + i4(1))
        if room:
            block, place = record[into // WIDTH], into % WIDTH
            for row in range(0, TRIANGLE_ROWS * WIDTH, WIDTH):
                scatter(block, row + place, wanted, gather(triangle, row + column))
            _show(band, into, column, cluster, number, focal, tag)
    agree()
    return left


@kernel(inline=True)
def _show(
    band: Band, into: int, column: int, cluster: int, number: int, focal: float, tag: int
) -> None:
    """Record what a triangle shows: its tag, and its leaves."""
    at = CLUSTER * cluster + (column if number < 0 else number)
    band.record_shown[into, 0] = tag + at
    band.record_shown[into, 1] = leaves_of(band.geometry, at, band.triangle, column, focal)


@kernel(threads=_record_own_triangle)
def record_triangles(
    band: Band,  # The band; the triangles are in its `triangle`
    drawn: int,  # Their columns there, a bit each
    cluster: int,  # Row of `Geometry.cluster`
    number: int,  # Which triangle of the cluster they are parts of; -1: each is that of its column
    focal: float,  # See `draw_mesh`
    tag: int,
) -> int:
    """Record triangles to be filled later; return those for which there is no room, a bit each."""
    triangle, record, unit, shown = band.triangle, band.record, band.unit, band.record_shown
    left = i8(0)
    while drawn != 0:
        column = first_bit(drawn)
        drawn &= drawn - 1
        rows = i8(gather(triangle, LAST_ROW * WIDTH + column))
        rows -= i8(gather(triangle, FIRST_ROW * WIDTH + column))
        room = len(record) > 0 and rows <= MOST_ROWS
        if room:
            claimed = claim_some(band.recorded, (rows << i8(32)) | i8(1))
            into, begin = claimed & i8(0xFFFFFFFF), claimed >> i8(32)
            room = into < len(shown) and begin + rows <= len(unit)
            for k in range(begin, min(begin + rows, len(unit))):
                unit[k] = i4(into * MOST_ROWS + k - begin) if room else i4(-1)
        if not room:
            left |= 1 << column
            continue
        block, place = record[into // WIDTH], into % WIDTH
        for row in range(TRIANGLE_ROWS):
            block[row, place] = triangle[row, column]
        _show(band, into, column, cluster, number, focal, tag)
    return left


@kernel(inline=True)
def _fill_own_rows(band: Band) -> None:
    """Do what `fill_recorded` does; each thread fills rows of its own."""
    view, geometry, unit = band.camera, band.geometry, band.unit
    count = min(band.recorded[0] >> i8(32), len(unit))
    thread = band.member * WIDTH + i8(own(lane_numbers()))
    for at in range(thread, count, band.members * WIDTH):
        which = i8(unit[at])
        if which >= 0:
            number, part = which // MOST_ROWS, which % MOST_ROWS
            triangle, column = band.record[number // WIDTH], number % WIDTH
            holes = holes_of(geometry.texture, band.record_shown[number, 1])
            row = i8(gather(triangle, FIRST_ROW * WIDTH + column)) + part
            slopes, tag = slopes_of(triangle, column, holes), band.record_shown[number, 0]
            fill_row(triangle, column, slopes, row, view.top, view.width, band.key, tag, holes)
    agree()


@kernel(inline=True, threads=_fill_own_rows)
def fill_recorded(band: Band) -> None:
    """Fill a worker's share of the rows of the recorded triangles."""
    view, geometry, unit = band.camera, band.geometry, band.unit
    count = min(band.recorded[0] >> i8(32), len(unit))
    for at in range(band.member, count, band.members):
        which = i8(unit[at])
        if which < 0:
            continue
        number, part = which // MOST_ROWS, which % MOST_ROWS
        triangle, column = band.record[number // WIDTH], number % WIDTH
        holes = holes_of(geometry.texture, band.record_shown[number, 1])
        row = i8(gather(triangle, FIRST_ROW * WIDTH + column)) + part
        fill_rows(
            triangle, column, slopes_of(triangle, column, holes), row, row + 1, view.top,
            view.width, band.key, band.record_shown[number, 0], holes, band.span,
        )  # fmt: skip
