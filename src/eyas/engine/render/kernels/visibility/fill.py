"""Filling of triangles: eight rows at once for where they begin and end, then eight samples."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.scalars import f4, i4, i8, u4
from eyas.engine.render.kernels.visibility.holes import Holes, has_leaf
from eyas.engine.render.kernels.visibility.key import key_of
from eyas.engine.render.kernels.visibility.triangles import (
    ACROSS,
    DOWN,
    FALL,
    FIRST_ROW,
    LAST_ROW,
    LEAST,
    LONG,
    LOWER,
    MOST,
    RUN,
    SIXTEENTHS,
    START,
    UPPER,
    U,
    V,
    X,
    Y,
)
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    any_of,
    bits_of,
    ceiling,
    first_bit,
    from_bits,
    gather,
    greater,
    lane_numbers,
    lesser,
    load,
    own,
    select,
    store,
    store_greater,
    store_largest,
    to_f4,
    to_f8,
    to_i4,
    to_u4,
)

SPAN_ROWS = 7  # Rows of `Scratch.span`: a column for each of eight rows of samples.

AT, END = 0, 1
"""Index of the first eight samples of the span in the array of keys, and of its last sample + 1."""

OFFSET, LENGTH = 2, 3
"""Column of the former less that of the span's first sample, and number of samples."""

VALUE, U_VALUE, V_VALUE = 4, 5, 6
"""Bits of 1/distance, u/distance and v/distance at the span's first sample, of float32."""


@kernel(inline=True)
def _entry(triangle: NDArray[np.float64], row: int, number: int) -> float:
    return gather(triangle, row * WIDTH + number)


@kernel(inline=True)
def _crossing(triangle: NDArray[np.float64], number: int, edge: int, y: float) -> float:
    """Return the first columns at or after an edge, in rows with their centres at `y`.

    A sample's centre lies at the edge or right of it if it does so of a place half a step of the
    (whole) product to the left, and never exactly at that place: so the rounding of the division
    changes nothing. Both triangles at an edge compute this from the same numbers, so no sample is
    left out or drawn twice even where corners lie millions of samples outside and products are
    rounded.
    """
    down = (y - _entry(triangle, edge + Y, number)) * _entry(triangle, edge + RUN, number)
    return (down - 0.5) * _entry(triangle, edge + FALL, number) + _entry(triangle, edge + X, number)


@kernel(inline=True)
def _ends(triangle: NDArray[np.float64], number: int, rows: float, width: float) -> tuple[int, int]:
    """Return the first and the last column + 1 of a triangle in eight rows."""
    y = rows * SIXTEENTHS + 0.5 * SIXTEENTHS
    long = _crossing(triangle, number, LONG, y)
    short = select(
        y < _entry(triangle, LOWER + Y, number),
        _crossing(triangle, number, UPPER, y),
        _crossing(triangle, number, LOWER, y),
    )
    # Clamped before the conversion: larger values would overflow an integer.
    first = lesser(greater(lesser(long, short), 0.0), width)
    last = lesser(greater(greater(long, short), 0.0), width)
    return to_i4(ceiling(first)), to_i4(ceiling(last))


@kernel(inline=True)
def _values(
    triangle: NDArray[np.float64], number: int, plane: int, scale: float, rows: float, columns: int
) -> float:
    """Return a quantity in eight rows, at a column of each, times a scale."""
    value = _entry(triangle, plane, number) + rows * _entry(triangle, plane + DOWN - START, number)
    value += to_f8(columns) * _entry(triangle, plane + ACROSS - START, number)
    return to_f4(value * scale)


@kernel(inline=True)
def _find_spans(
    triangle: NDArray[np.float64],
    number: int,
    row: int,
    top: int,
    width: int,
    stride: int,
    holes: Holes,
    span: NDArray[np.int32],
) -> int:
    """Write the spans of a triangle in eight rows, from `row` on; return which hold samples."""
    numbers = lane_numbers()
    rows = to_f8(numbers + i4(row))
    first, last = _ends(triangle, number, rows, float(width))
    start, line = first & i4(-WIDTH), (numbers + i4(row - top)) * i4(stride)
    store(span, AT * WIDTH, line + start)
    store(span, END * WIDTH, line + last)
    store(span, OFFSET * WIDTH, start - first)
    store(span, LENGTH * WIDTH, last - first)
    store(span, VALUE * WIDTH, _values(triangle, number, START, 1.0, rows, first))
    if holes.level >= 0:
        store(span, U_VALUE * WIDTH, _values(triangle, number, U, holes.size, rows, first))
        store(span, V_VALUE * WIDTH, _values(triangle, number, V, holes.size, rows, first))
    return bits_of(first < last)


@kernel(inline=True)
def _show(
    key: NDArray[np.int64], at: int, wanted: bool, inverse: float, tag: int, old: int
) -> None:
    """Write eight keys where they are wanted and larger than the old ones."""
    # A key below 0 is smaller than all others.
    store_greater(key, at, key_of(select(wanted, inverse, f4(-1.0)), tag), old)


class Slopes(NamedTuple):
    """What is the same in all rows of a triangle, of float32: how 1/distance changes from column to
    column, its limits, and how u/distance and v/distance change.
    """

    step: float
    least: float
    most: float
    u_step: float
    v_step: float


@kernel(inline=True)
def slopes_of(triangle: NDArray[np.float64], number: int, holes: Holes) -> Slopes:
    """Return the slopes of a triangle, see `fill`."""
    return Slopes(
        f4(_entry(triangle, ACROSS, number)),
        f4(_entry(triangle, LEAST, number)),
        f4(_entry(triangle, MOST, number)),
        f4(_entry(triangle, U + ACROSS - START, number) * holes.size),
        f4(_entry(triangle, V + ACROSS - START, number) * holes.size),
    )


@kernel(inline=True)
def fill_row(
    triangle: NDArray[np.float64],
    number: int,
    slopes: Slopes,
    row: int,
    top: int,
    width: int,
    key: NDArray[np.int64],
    tag: int,
    holes: Holes,
) -> None:
    """Draw a row of a triangle, sample by sample; for kernels of threads. See `fill_rows`."""
    line, u, v = float(row), f4(0.0), f4(0.0)
    first, last = _ends(triangle, number, line, float(width))
    value = _values(triangle, number, START, 1.0, line, first)
    if holes.level >= 0:
        u = _values(triangle, number, U, holes.size, line, first)
        v = _values(triangle, number, V, holes.size, line, first)
    at, left, steps = (row - top) * key.shape[1] + i8(first), i4(last - first), f4(0.0)
    while left > i4(0):  # numbers of 32 bits: those of 64 take a card twice the time
        inverse = lesser(greater(value + slopes.step * steps, slopes.least), slopes.most)
        new = key_of(inverse, tag)
        if holes.level < 0:
            store_largest(key, at, new)
        elif new > gather(key, at):
            w = f4(1.0) / inverse
            if has_leaf(holes, (u + slopes.u_step * steps) * w, (v + slopes.v_step * steps) * w):
                store_largest(key, at, new)
        at += 1
        steps += f4(1.0)
        left = i4(left - i4(1))


@kernel(inline=True)
def _fill_own_row(
    triangle: NDArray[np.float64],
    number: int,
    slopes: Slopes,
    row: int,
    last_row: int,
    top: int,
    width: int,
    key: NDArray[np.int64],
    tag: int,
    holes: Holes,
    span: NDArray[np.int32],
) -> None:
    """Draw what `fill_rows` does; each thread draws a row of its own."""
    line = i8(own(lane_numbers())) + row
    if line < last_row:
        fill_row(triangle, number, slopes, line, top, width, key, tag, holes)
    agree()


@kernel(inline=True, threads=_fill_own_row)
def fill_rows(
    triangle: NDArray[np.float64],
    number: int,
    slopes: Slopes,  # Those of the triangle
    row: int,  # The first row
    last_row: int,  # `LAST_ROW` of the triangle
    top: int,
    width: int,
    key: NDArray[np.int64],
    tag: int,
    holes: Holes,
    span: NDArray[np.int32],
) -> None:
    """Draw eight rows of a triangle, see `fill`."""
    numbers = lane_numbers()
    live = _find_spans(triangle, number, row, top, width, key.shape[1], holes, span)
    if last_row - row < WIDTH:
        live &= (1 << (last_row - row)) - 1
    while live != 0:
        which = first_bit(live)
        live &= live - 1
        at, end = i8(gather(span, AT * WIDTH + which)), i8(gather(span, END * WIDTH + which))
        columns = numbers + gather(span, OFFSET * WIDTH + which)
        length = u4(gather(span, LENGTH * WIDTH + which))
        value = from_bits(gather(span, VALUE * WIDTH + which))
        while True:
            steps = to_f4(columns)
            inverse = lesser(greater(value + slopes.step * steps, slopes.least), slopes.most)
            wanted, old = to_u4(columns) < length, load(key, at)
            if holes.level < 0:
                _show(key, at, wanted, inverse, tag, old)
            else:
                wanted &= key_of(inverse, tag) > old
                if any_of(wanted):
                    w = f4(1.0) / inverse
                    u = from_bits(gather(span, U_VALUE * WIDTH + which)) + slopes.u_step * steps
                    v = from_bits(gather(span, V_VALUE * WIDTH + which)) + slopes.v_step * steps
                    _show(key, at, wanted & has_leaf(holes, u * w, v * w), inverse, tag, old)
            at += WIDTH
            if at >= end:
                break
            columns += i4(WIDTH)


@kernel(inline=True, apart=True)
def fill(
    triangle: NDArray[np.float64],  # From `set_up`
    number: int,  # Its column
    top: int,  # Row of the picture that is row 0 of `key`
    width: int,  # Width of the picture [samples]
    key: NDArray[np.int64],  # See `Scratch`, shape (rows, columns)
    tag: int,  # Lower half of the key, see `eyas.engine.render.kernels.visibility.key`
    holes: Holes,  # The texture whose alpha cuts holes
    span: NDArray[np.int32],  # Working memory, see `Scratch`, shape (SPAN_ROWS, 8)
) -> None:
    """Draw a triangle wherever it is nearer than what was drawn before.

    A sample belongs to a triangle if its centre does, by the top-left rule.
    """
    row, last_row = i8(_entry(triangle, FIRST_ROW, number)), i8(_entry(triangle, LAST_ROW, number))
    slopes = slopes_of(triangle, number, holes)
    while row < last_row:
        fill_rows(triangle, number, slopes, row, last_row, top, width, key, tag, holes, span)
        row += WIDTH
