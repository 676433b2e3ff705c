"""Pictures in stages, for devices: each is a kernel of its own over many views at once.

The stages call what `draw_views` calls for one band after another; here the whole view is a band,
and its working memory lasts until the last stage. Workers of a stage wait for no others: those that
share a view each draw their own share of what it shows, and then their own rows.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Geometry, Light, Movers, Output, Scratch, Task
from eyas.engine.render.kernels.draw import band_of, light_at, no_glass, write_colours, write_facts
from eyas.engine.render.kernels.light.casters import cast_light
from eyas.engine.render.kernels.pixels import pack, write_pixels
from eyas.engine.render.kernels.scalars import i4, i8, u4
from eyas.engine.render.kernels.tent import ROUNDING, SHIFT, weighted
from eyas.engine.render.kernels.visibility.items import draw_clusters, find_clusters, list_items
from eyas.engine.render.kernels.visibility.records import fill_recorded
from eyas.engine.render.kernels.visibility.transform import view_of
from eyas.lanes import ParallelCall, address_of, kernel, parallel, specialised
from eyas.lanes.vector import WIDTH, gather, lane_numbers, load_words, select, store_words, to_u4

__all__ = [
    "Shares",
    "cast_lights",
    "fill_triangles",
    "filter_columns",
    "filter_rows",
    "find_triangles",
    "list_views",
    "look_for_clusters",
    "shade",
    "tell_facts",
]


class Shares(NamedTuple):
    """How work is shared."""

    views: int  # Number of views
    members: int  # Workers that share a view
    listed: NDArray[np.int32]  # Rows of `Scratch.drawn` that each view uses, shape (V,).


@kernel
def _nothing(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Stand for a stage."""


_stage = _nothing


def _each_view(
    worker: int,
    workers: int,
    shares: Shares,
    geometry: Geometry,
    light: Light,
    scratch: Scratch,
    movers: Movers,
    output: Output,
    task: Task,
) -> None:
    """Do a stage of all views."""
    job, members = task.job, shares.members
    item = i8(worker)
    while item < shares.views * members:
        index = item // members
        number = job.band[index, 0]
        view = address_of(view_of(task, index))
        lit = address_of(light_at(light, job, number))
        glass = address_of(no_glass(scratch, index))
        band = address_of(
            band_of(
                geometry, light, lit, movers, i8(job.world[number]), view, glass, task.until,
                scratch, index, item - index * members, members,
            )
        )  # fmt: skip
        _stage(band, output, task, index, shares)
        item += workers


@kernel
def _list(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """List what a view shows."""
    shares.listed[index] = list_items(band)


@kernel
def _find(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Find the clusters that may be seen."""
    find_clusters(band)


@kernel
def _draw(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Find the triangles that are seen in them."""
    draw_clusters(band)


@kernel
def _fill(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Fill the triangles that were recorded."""
    fill_recorded(band)


@kernel
def _cast(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Write the share of light that moving things let through, and their own light."""
    cast_light(band)


@kernel
def _shade(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Write the colours."""
    write_colours(band, output, task, index)


@kernel
def _tell(band: Band, output: Output, task: Task, index: int, shares: Shares) -> None:
    """Write what is wanted but colours; one worker a view, if anything is measured."""
    write_facts(band, band, shares.listed[index], output, task, index)


def _over_views(stage: Callable[..., Any]) -> ParallelCall:
    return parallel(specialised(_each_view, _stage=stage))


list_views = _over_views(_list)
look_for_clusters = _over_views(_find)
find_triangles = _over_views(_draw)
fill_triangles = _over_views(_fill)
cast_lights = _over_views(_cast)
shade = _over_views(_shade)
tell_facts = _over_views(_tell)


# The tent filter, see `eyas.engine.render.kernels.tent`, of eight columns at once: sums along rows
# are kept in `Scratch.shade`, which shading has read, ten bits for each colour of a pixel.

ROWS = 32  # Rows of a picture that a worker does

_TEN = u4(0x3FF)
_ENDS = u4(0x3FF | 0x3FF << 20)  # Red and blue
_HALF = u4(ROUNDING)
_HALVES = u4(ROUNDING | ROUNDING << 20)


class _Piece(NamedTuple):
    """What a worker filters."""

    of: int  # The view
    column: int  # The first
    top: int  # The first row, and the row after the last
    bottom: int


@kernel(inline=True)
def _pieces(output: Output) -> int:
    """Return the number of pieces of all views."""
    views, height, width, _ = output.rgb.shape
    return int(views * ((height + ROWS - 1) // ROWS) * ((width + WIDTH - 1) // WIDTH))


@kernel(inline=True)
def _piece(item: int, output: Output) -> _Piece:
    """Return a piece."""
    height, groups = output.rgb.shape[1], (output.rgb.shape[2] + WIDTH - 1) // WIDTH
    number, pieces = item // groups, (height + ROWS - 1) // ROWS
    top = number % pieces * ROWS
    return _Piece(number // pieces, item % groups * WIDTH, top, min(top + ROWS, height))


@kernel(inline=True)
def _across(line: NDArray[np.uint8], left: int, own: int, right: int) -> int:
    """Return the sums of one colour of eight pixels and of those beside them."""
    return weighted(gather(line, left), gather(line, own), gather(line, right))


@parallel
def filter_rows(worker: int, workers: int, scratch: Scratch, output: Output) -> None:
    """Write the sums along rows of all views."""
    width = output.rgb.shape[2]
    for item in range(worker, _pieces(output), workers):
        piece = _piece(item, output)
        pixels, sums = output.rgb[piece.of], scratch.shade[piece.of]
        own, last = (lane_numbers() + i4(piece.column)) * i4(3), i4(3 * width - 3)
        own = select(own < last, own, last)
        left = select(own > i4(0), own - i4(3), own)
        right = select(own < last, own + i4(3), own)
        for row in range(piece.top, piece.bottom):
            red = _across(pixels[row], left, own, right)
            green = _across(pixels[row], left + i4(1), own + i4(1), right + i4(1))
            blue = _across(pixels[row], left + i4(2), own + i4(2), right + i4(2))
            packed = to_u4(red | (green << u4(10)) | (blue << u4(20)))
            store_words(sums[row], 4 * piece.column, packed)


@parallel
def filter_columns(worker: int, workers: int, scratch: Scratch, output: Output) -> None:
    """Write the bytes of all views, of the sums along rows."""
    height, width = output.rgb.shape[1], output.rgb.shape[2]
    for item in range(worker, _pieces(output), workers):
        piece = _piece(item, output)
        pixels, sums = output.rgb[piece.of], scratch.shade[piece.of]
        begin, chosen = 4 * piece.column, (1 << min(width - piece.column, WIDTH)) - 1
        above = load_words(sums[max(piece.top - 1, 0)], begin)
        own = load_words(sums[piece.top], begin)
        for row in range(piece.top, piece.bottom):
            below = load_words(sums[min(row + 1, height - 1)], begin)
            ends = weighted(above & _ENDS, own & _ENDS, below & _ENDS) + _HALVES
            ten = u4(10)
            middle = weighted((above >> ten) & _TEN, (own >> ten) & _TEN, (below >> ten) & _TEN)
            green = to_u4(middle + _HALF) >> u4(SHIFT)
            red, blue = (to_u4(ends) >> u4(SHIFT)) & u4(255), to_u4(ends) >> u4(20 + SHIFT)
            write_pixels(pixels, row, piece.column, chosen, pack(red, green, blue))
            above, own = own, below
