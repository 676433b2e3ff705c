"""The lossy part of JPEG (ITU-T T.81), without its files: what a coded picture looks like.

    RGB -> Y, Cb, Cr, colours at half the width and height -> 8x8 cosine transform -> rounded to
    multiples of a table -> and all of it back

Colours, tables and the smooth upsampling are those of libjpeg with 4:2:0.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.pixels import pack
from eyas.engine.render.kernels.scalars import f4, i4
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    gather,
    greater,
    lane_numbers,
    lesser,
    load,
    select,
    store,
    store_triples,
    to_f4,
    to_i4,
    to_u4,
    transposed,
    whole,
)

PADDING = 16
"""Planes are whole numbers of this in both directions: blocks of both are 8 pixels of colours."""

_LUMINANCE = (
    16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56,
    14, 17, 22, 29, 51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113,
    92, 49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99,
)  # fmt: skip
_CHROMINANCE = (
    17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99, 24, 26, 56, 99, 99, 99, 99, 99,
    47, 66, 99, 99, 99, 99, 99, 99, *(99,) * 32,
)  # fmt: skip
"""Tables K.1 and K.2 of T.81, row by row."""

_SQUARE_ROOT = 0.35355339059327373  # 1 / (2 sqrt 2)
_C1, _C2, _C3 = 0.49039264020161522, 0.46193976625564337, 0.41573480615127262
_C5, _C6, _C7 = 0.27778511650980114, 0.19134171618254492, 0.09754516100806417
"""Half the cosines of k pi / 16."""

Eight = tuple[float, float, float, float, float, float, float, float]


def quantisation(quality: float) -> NDArray[np.float32]:
    """Return the tables of luminance and colours for a quality, 1 to 100, as libjpeg scales them.

    Returns:
        Shape (2, 64); of each the coefficients column by column, as the transform leaves them.
    """
    scale = 5000.0 / quality if quality < 50 else 200.0 - 2.0 * quality
    tables = np.array([_LUMINANCE, _CHROMINANCE], np.float64).reshape(2, 8, 8)
    scaled = np.clip(np.floor((tables * np.floor(scale) + 50.0) / 100.0), 1.0, 255.0)
    return np.ascontiguousarray(scaled.transpose(0, 2, 1).reshape(2, 64), np.float32)


def planes_for(height: int, width: int) -> tuple[int, int]:
    """Return height and width of the planes of luminance for a picture."""
    return -(-height // PADDING) * PADDING, -(-width // PADDING) * PADDING


@kernel(inline=True)
def _cosines(x: Eight) -> Eight:
    """Return the cosine transform of eight numbers (T.81, A.3.3), along one direction."""
    s0, s1, s2, s3 = x[0] + x[7], x[1] + x[6], x[2] + x[5], x[3] + x[4]
    d0, d1, d2, d3 = x[0] - x[7], x[1] - x[6], x[2] - x[5], x[3] - x[4]
    outer, inner, first, second = s0 + s3, s1 + s2, s0 - s3, s1 - s2
    a, b, c, d = f4(_C1), f4(_C3), f4(_C5), f4(_C7)
    return (
        (outer + inner) * f4(_SQUARE_ROOT),
        a * d0 + b * d1 + c * d2 + d * d3,
        first * f4(_C2) + second * f4(_C6),
        b * d0 - d * d1 - a * d2 - c * d3,
        (outer - inner) * f4(_SQUARE_ROOT),
        c * d0 - a * d1 + d * d2 + b * d3,
        first * f4(_C6) - second * f4(_C2),
        d * d0 - c * d1 + b * d2 - a * d3,
    )


@kernel(inline=True)
def _from_cosines(x: Eight) -> Eight:
    """Return the inverse of `_cosines`."""
    plus, minus = (x[0] + x[4]) * f4(_SQUARE_ROOT), (x[0] - x[4]) * f4(_SQUARE_ROOT)
    first, second = x[2] * f4(_C2) + x[6] * f4(_C6), x[2] * f4(_C6) - x[6] * f4(_C2)
    a, b, c, d = f4(_C1), f4(_C3), f4(_C5), f4(_C7)
    e0, e1, e2, e3 = plus + first, minus + second, minus - second, plus - first
    o0 = a * x[1] + b * x[3] + c * x[5] + d * x[7]
    o1 = b * x[1] - d * x[3] - a * x[5] - c * x[7]
    o2 = c * x[1] - a * x[3] + d * x[5] + b * x[7]
    o3 = d * x[1] - c * x[3] + b * x[5] - a * x[7]
    return e0 + o0, e1 + o1, e2 + o2, e3 + o3, e3 - o3, e2 - o2, e1 - o1, e0 - o0


@kernel(inline=True)
def _turned(block: NDArray[np.float32], rows: Eight) -> Eight:
    """Return eight rows as columns, by way of some working memory."""
    for k in range(8):
        store(block, 8 * k, rows[k])
    turned: Eight = transposed(block, lane_numbers(), 0, 8, lane_numbers())
    return turned


@kernel(inline=True)
def _rounded(value: float, step: float) -> float:
    """Return a multiple of a step."""
    multiple: float = whole(value / step + f4(0.5)) * step
    return multiple


@kernel(inline=False)
def _code_block(
    plane: NDArray[np.float32], at: int, table: NDArray[np.float32], block: NDArray[np.float32]
) -> None:
    """Code the 8x8 values of a plane from index `at` on, in place."""
    line, middle = plane.shape[1], f4(128.0)
    rows = (
        load(plane, at) - middle,
        load(plane, at + line) - middle,
        load(plane, at + 2 * line) - middle,
        load(plane, at + 3 * line) - middle,
        load(plane, at + 4 * line) - middle,
        load(plane, at + 5 * line) - middle,
        load(plane, at + 6 * line) - middle,
        load(plane, at + 7 * line) - middle,
    )
    x = _cosines(_turned(block, _cosines(rows)))
    x = (
        _rounded(x[0], load(table, 0)),
        _rounded(x[1], load(table, 8)),
        _rounded(x[2], load(table, 16)),
        _rounded(x[3], load(table, 24)),
        _rounded(x[4], load(table, 32)),
        _rounded(x[5], load(table, 40)),
        _rounded(x[6], load(table, 48)),
        _rounded(x[7], load(table, 56)),
    )
    y = _from_cosines(_turned(block, _from_cosines(x)))
    for k in range(8):
        value = whole(y[k] + f4(128.5))
        store(plane, at + k * line, lesser(greater(value, f4(0.0)), f4(255.0)))


@kernel
def _split(
    rgb: NDArray[np.uint8],  # Shape (H, W, 3)
    luminance: NDArray[np.float32],  # Shape (H', W'), see `planes_for`
    blue: NDArray[np.float32],  # The same shape, as the next
    red: NDArray[np.float32],  # How much bluer and redder than grey
) -> None:
    """Write the planes of a picture (JFIF 1.02); beyond its edges their last pixels go on."""
    height, width = rgb.shape[:2]
    last = i4(width - 1)
    for row in range(luminance.shape[0]):
        start = min(row, height - 1) * width
        for first in range(0, luminance.shape[1], WIDTH):
            at = (lesser(lane_numbers() + i4(first), last) + i4(start)) * i4(3)
            r = to_f4(to_i4(gather(rgb, at)))
            g = to_f4(to_i4(gather(rgb, at + i4(1))))
            b = to_f4(to_i4(gather(rgb, at + i4(2))))
            to = row * luminance.shape[1] + first
            grey = f4(0.299) * r + f4(0.587) * g + f4(0.114) * b
            bluer = f4(-0.168736) * r - f4(0.331264) * g + f4(0.5) * b
            redder = f4(0.5) * r - f4(0.418688) * g - f4(0.081312) * b
            store(luminance, to, whole(grey + f4(0.5)))
            store(blue, to, whole(bluer + f4(128.5)))
            store(red, to, whole(redder + f4(128.5)))


@kernel
def _halved(plane: NDArray[np.float32], half: NDArray[np.float32]) -> None:
    """Write the means of 2x2 values."""
    line = plane.shape[1]
    for row in range(half.shape[0]):
        for first in range(0, half.shape[1], WIDTH):
            at = (lane_numbers() + i4(first)) * i4(2) + i4(2 * row * line)
            total = gather(plane, at) + gather(plane, at + i4(1))
            below = at + i4(line)
            total += gather(plane, below) + gather(plane, below + i4(1))
            store(half, row * half.shape[1] + first, whole(total * f4(0.25) + f4(0.5)))


@kernel(inline=True)
def _smooth(
    lines: NDArray[np.float32], half: NDArray[np.float32], row: int, height: int, width: int
) -> None:
    """Write a row of colours, halfway to the nearer of the rows beside it, into `lines`."""
    near, last = row >> 1, (height + 1) // 2 - 1
    other = min(near + 1, last) if row & 1 else max(near - 1, 0)
    line = half.shape[1]
    for first in range(0, line, WIDTH):
        value = f4(0.75) * load(half, near * line + first)
        store(lines, first, value + f4(0.25) * load(half, other * line + first))


@kernel(inline=True)
def _widened(lines: NDArray[np.float32], first: int, last: int) -> float:
    """Return eight pixels of a row of colours that is half as wide."""
    column = lane_numbers() + i4(first)
    near = column >> i4(1)
    odd = (column & i4(1)) == i4(1)
    other = lesser(greater(select(odd, near + i4(1), near - i4(1)), i4(0)), i4(last))
    between = f4(0.75) * gather(lines, near) + f4(0.25) * gather(lines, other)
    colour: float = between - f4(128.0)
    return colour


@kernel(inline=True)
def _as_byte(value: float) -> int:
    byte: int = to_u4(to_i4(lesser(greater(value + f4(0.5), f4(0.0)), f4(255.0))))
    return byte


@kernel
def _join(
    rgb: NDArray[np.uint8],  # Written, shape (H, W, 3)
    luminance: NDArray[np.float32],  # Shape (H', W')
    work: NDArray[np.float32],  # Colours, and two rows of working memory, see `code`
) -> None:
    """Write the picture of three planes, of which those of colours are half as wide and high."""
    height, width = rgb.shape[:2]
    rows = luminance.shape[0] // 2
    blue, red, lines = work[:rows], work[rows : 2 * rows], work[2 * rows :]
    last = (width + 1) // 2 - 1
    for row in range(height):
        _smooth(lines[0], blue, row, height, width)
        _smooth(lines[1], red, row, height, width)
        for start in range(0, width, WIDTH):
            first = min(start, width - WIDTH)
            grey = load(luminance, row * luminance.shape[1] + first)
            bluer, redder = _widened(lines[0], first, last), _widened(lines[1], first, last)
            green = grey - f4(0.344136) * bluer - f4(0.714136) * redder
            packed = pack(
                _as_byte(grey + f4(1.402) * redder),
                _as_byte(green),
                _as_byte(grey + f4(1.772) * bluer),
            )
            store_triples(rgb, 3 * (row * width + first), packed)


@kernel
def code(
    rgb: NDArray[np.uint8],  # Shape (H, W, 3)
    tables: NDArray[np.float32],  # See `quantisation`, shape (2, 64)
    planes: NDArray[np.float32],  # Working memory, shape (3, H', W'), see `planes_for`
    halves: NDArray[np.float32],  # Working memory, shape (H' + 3, W' / 2)
) -> None:
    """Code a picture and decode it, in place."""
    luminance, rows = planes[0], planes.shape[1] // 2
    _split(rgb, luminance, planes[1], planes[2])
    _halved(planes[1], halves[:rows])
    _halved(planes[2], halves[rows : 2 * rows])
    block = planes[1]  # free by now, and read as one long row
    for row in range(0, luminance.shape[0], 8):
        for column in range(0, luminance.shape[1], 8):
            _code_block(luminance, row * luminance.shape[1] + column, tables[0], block)
    for row in range(0, 2 * rows, 8):
        for column in range(0, halves.shape[1], 8):
            _code_block(halves, row * halves.shape[1] + column, tables[1], block)
    _join(rgb, luminance, halves)
