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
from eyas.engine.render.kernels.visibility.items import draw_clusters, find_clusters, list_items
from eyas.engine.render.kernels.visibility.records import fill_recorded
from eyas.engine.render.kernels.visibility.transform import view_of
from eyas.lanes import ParallelCall, address_of, kernel, parallel, specialised

__all__ = [
    "Shares",
    "cast_lights",
    "fill_triangles",
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
