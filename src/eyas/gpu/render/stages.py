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
from eyas.engine.render.kernels.scalars import i8
from eyas.engine.render.kernels.tent import MIDDLE, ROUNDING, SHIFT, SIDE
from eyas.engine.render.kernels.visibility.items import draw_clusters, find_clusters, list_items
from eyas.engine.render.kernels.visibility.records import fill_recorded
from eyas.engine.render.kernels.visibility.transform import view_of
from eyas.lanes import ParallelCall, address_of, kernel, parallel, specialised

__all__ = [
    "Shares",
    "cast_lights",
    "copy_filtered",
    "fill_triangles",
    "filter_columns",
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


# The tent filter, see `eyas.engine.render.kernels.tent`: a worker is one thread, and does a column
# of bytes. It writes into `Scratch.shade`, which shading has read, as others need what it replaces.

ROWS = 16  # Rows of a picture that a worker does


@kernel(inline=True)
def _piece(item: int, output: Output) -> tuple[int, int, int, int]:
    """Return the view of an item, its column of bytes, its first row, and the row after these."""
    height, count = output.rgb.shape[1], 3 * output.rgb.shape[2]
    number, column = item // count, item % count
    pieces = (height + ROWS - 1) // ROWS
    first = number % pieces * ROWS
    return number // pieces, column, first, min(first + ROWS, height)


@kernel(inline=True)
def _pieces(output: Output) -> int:
    """Return how many columns of so many rows there are in all views."""
    views, height, width, channels = output.rgb.shape
    return int(views * ((height + ROWS - 1) // ROWS) * width * channels)


@kernel(inline=True)
def _across(pixels: NDArray[np.uint8], row: int, column: int) -> int:
    """Return the weighted sum of a byte of a row and of those of the pixels beside it."""
    last = 3 * pixels.shape[1] - 3
    left = column - 3 if column >= 3 else column
    right = column + 3 if column < last else column
    own = i8(pixels[row, column // 3, column % 3])
    beside = i8(pixels[row, left // 3, left % 3]) + i8(pixels[row, right // 3, right % 3])
    return SIDE * beside + MIDDLE * own


@parallel
def filter_columns(worker: int, workers: int, scratch: Scratch, output: Output) -> None:
    """Filter the bytes of all views, into `Scratch.shade`."""
    height = output.rgb.shape[1]
    for item in range(worker, _pieces(output), workers):
        view, column, first, last = _piece(item, output)
        pixels, filtered = output.rgb[view], scratch.shade[view]
        above = _across(pixels, max(first - 1, 0), column)
        own = _across(pixels, first, column)
        for row in range(first, last):
            below = _across(pixels, min(row + 1, height - 1), column)
            mean = (SIDE * (above + below) + MIDDLE * own + ROUNDING) >> SHIFT
            filtered[row, column // 4, column % 4] = mean
            above, own = own, below


@parallel
def copy_filtered(worker: int, workers: int, scratch: Scratch, output: Output) -> None:
    """Copy what `filter_columns` has written to where it belongs."""
    for item in range(worker, _pieces(output), workers):
        view, column, first, last = _piece(item, output)
        pixels, filtered = output.rgb[view], scratch.shade[view]
        for row in range(first, last):
            pixels[row, column // 3, column % 3] = filtered[row, column // 4, column % 4]
