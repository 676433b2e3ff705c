"""Boxes and pixels of moving things: what a thing alone would cover, and what of it is seen."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import address_of, kernel
from eyas.lanes.vector import (
    WIDTH,
    any_of,
    greater,
    lane,
    lane_numbers,
    lesser,
    load,
    select,
    splat,
    store,
    to_i4,
)
from eyas.render.kernels.bundles import Geometry, Movers, Scratch, View
from eyas.render.kernels.light.caster import Caster, caster_of
from eyas.render.kernels.samples import ScreenBox, around, nowhere
from eyas.render.kernels.scalars import i4, i8
from eyas.render.kernels.visibility.key import tag_of
from eyas.render.kernels.visibility.passes import draw_slots
from eyas.render.kernels.visibility.things import belongs_to, end_of_thing, next_thing
from eyas.state.scene import ACTOR_OBJECT

__all__ = ["measure_actors", "measure_subject"]

_MARGIN = 2
"""Width of the border around a thing's box that is searched, too: more than roundings [samples]."""

_FAR = 1 << 30


@kernel(inline=True)
def _sum(lanes: int) -> int:
    total = i8(0)
    for number in range(WIDTH):
        total += lane(lanes, number)
    return total


@kernel
def _screen_box(thing: Caster, view: View) -> ScreenBox:
    box = nowhere()
    for corner in range(8):
        along = thing.length if corner & 1 else -thing.length
        aside = thing.width if corner & 2 else -thing.width
        x = thing.x + along * thing.along_x - aside * thing.along_y
        y = thing.y + along * thing.along_y + aside * thing.along_x
        box = around(box, view, x, y, thing.top if corner & 4 else thing.bottom)
    return box


@kernel
def _count(
    box: ScreenBox,
    view: View,
    key: NDArray[np.int64],
    alone: NDArray[np.int64],
    drawn: NDArray[np.int32],
    first: int,
    last: int,
    result: NDArray[np.int32],
) -> None:
    """Write box and pixels of instances `first` to `last` from a buffer that holds them alone.

    The buffer is clear afterwards.
    """
    stride = key.shape[1]
    begin = max(int(box.left) - _MARGIN, 0)
    end = min(int(box.right) + 1 + _MARGIN, view.width)
    bottom = min(int(box.bottom) + 1 + _MARGIN - view.top, view.rows)
    left, right = splat(i4(_FAR)), splat(i4(-1))
    seen_count, covered_count = splat(i4(0)), splat(i4(0))
    highest, lowest = -1, -1
    for line in range(max(int(box.top) - _MARGIN - view.top, 0), bottom):
        for start in range(begin, end, WIDTH):
            place = min(start, stride - WIDTH)
            at = line * stride + place
            covered = load(alone, at) != i8(0)
            if not any_of(covered):
                continue
            store(alone, at, splat(i8(0)))
            highest, lowest = (line if highest < 0 else highest), line
            columns = lane_numbers() + i4(place)
            left = lesser(left, select(covered, columns, i4(_FAR)))
            right = greater(right, select(covered, columns, i4(-1)))
            covered_count += to_i4(covered)
            seen = belongs_to(tag_of(load(key, at)), drawn, first, last)
            seen_count += to_i4(covered & seen)
    if highest < 0:
        return
    column, column_end = lane(left, 0), lane(right, 0)
    for number in range(1, WIDTH):
        column = min(column, lane(left, number))
        column_end = max(column_end, lane(right, number))
    result[0], result[1] = column, view.top + highest
    result[2], result[3] = column_end + 1, view.top + lowest + 1
    result[4], result[5] = _sum(seen_count), _sum(covered_count)


@kernel
def _measure(
    geometry: Geometry,
    movers: Movers,
    world: int,
    first: int,
    last: int,
    view: View,
    scratch: Scratch,
    worker: int,
    key: NDArray[np.int64],
    count: int,
    result: NDArray[np.int32],
) -> None:
    """Measure slots `first` to `last`; see `measure_actors`."""
    alone = scratch.alone[worker, : view.rows]
    if draw_slots(
        geometry, movers, world, first, last, view, scratch, worker, alone, count
    ) == count:  # fmt: skip
        return
    thing = address_of(caster_of(geometry, movers, world, first, last))
    fixtures = len(geometry.fixture_prototype)
    _count(
        _screen_box(thing, view), view, key, alone, scratch.drawn[worker], fixtures + first,
        fixtures + last, result,
    )  # fmt: skip


@kernel
def measure_actors(
    geometry: Geometry,
    movers: Movers,
    world: int,
    view: View,
    scratch: Scratch,
    worker: int,
    key: NDArray[np.int64],
    count: int,
    output: NDArray[np.int32],
) -> None:
    """Measure all actors of a world in a band, each alone and as the band shows it.

    Args:
        geometry: Everything that can be drawn.
        movers: The draw lists.
        world: The one of the view.
        view: The band; one sample for each pixel.
        scratch: Working memory; `alone` must be clear, and is so again.
        worker: Row of it to use.
        key: What the band shows, shape (rows, columns).
        count: Rows of `drawn` that it uses.
        output: See `Output.actor`, shape (A, 6); rows of actors outside the band are not written.
    """
    slots = movers.part.shape[1]
    first = next_thing(movers, world, 0)
    while first < slots:
        last = end_of_thing(movers, world, first)
        actor = movers.object_id[world, first] - ACTOR_OBJECT
        if 0 <= actor < len(output):
            _measure(
                geometry, movers, world, first, last, view, scratch, worker, key, count,
                output[actor],
            )  # fmt: skip
        first = next_thing(movers, world, last)


@kernel
def measure_subject(
    geometry: Geometry,
    movers: Movers,
    world: int,
    subject: int,
    view: View,
    scratch: Scratch,
    worker: int,
    key: NDArray[np.int64],
    count: int,
    result: NDArray[np.int32],
) -> None:
    """Measure the object of an id, if it is one of the moving things; see `measure_actors`."""
    slots = movers.part.shape[1]
    first = next_thing(movers, world, 0)
    while first < slots and movers.object_id[world, first] != subject:
        first = next_thing(movers, world, end_of_thing(movers, world, first))
    if first < slots:
        last = end_of_thing(movers, world, first)
        _measure(geometry, movers, world, first, last, view, scratch, worker, key, count, result)
