"""Boxes and pixels of moving things: what a thing alone would cover, and what of it is seen."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, View
from eyas.engine.render.kernels.lens.measure import count_bent
from eyas.engine.render.kernels.light.caster import Caster, caster_of
from eyas.engine.render.kernels.samples import ScreenBox, around, empty_box
from eyas.engine.render.kernels.scalars import i4, i8
from eyas.engine.render.kernels.visibility.key import tag_of
from eyas.engine.render.kernels.visibility.passes import draw_slots
from eyas.engine.render.kernels.visibility.scene_iterator import (
    belongs_to,
    end_of_thing,
    next_thing,
)
from eyas.engine.state.scene import ACTOR_OBJECT
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

_MARGIN = 2
"""Width of the border around a thing's box that is searched, too: more than roundings [samples]."""

_FAR = 1 << 30


@kernel(inline=True)
def _sum(lanes: int) -> int:
    total = i8(0)
    for number in range(WIDTH):
        total += lane(lanes, number)
    return total


@kernel(inline=True)
def _least(lanes: int) -> int:
    least = lane(lanes, 0)
    for number in range(1, WIDTH):
        least = min(least, lane(lanes, number))
    return least


@kernel(inline=True)
def _most(lanes: int) -> int:
    most = lane(lanes, 0)
    for number in range(1, WIDTH):
        most = max(most, lane(lanes, number))
    return most


@kernel
def _screen_box(thing: Caster, view: View) -> ScreenBox:
    box = empty_box()
    for corner in range(8):
        along = thing.length if corner & 1 else -thing.length
        aside = thing.width if corner & 2 else -thing.width
        x = thing.x + along * thing.along_x - aside * thing.along_y
        y = thing.y + along * thing.along_y + aside * thing.along_x
        box = around(box, view, x, y, thing.top if corner & 4 else thing.bottom)
    return box


@kernel
def _count(band: Band, box: ScreenBox, first: int, last: int, result: NDArray[np.int32]) -> None:
    """Write boxes and pixels of instances `first` to `last` from `Band.alone`, clear afterwards."""
    view, key, alone, drawn = band.camera, band.key, band.alone, band.drawn
    stride = key.shape[1]
    begin = max(int(box.left) - _MARGIN, 0)
    end = min(int(box.right) + 1 + _MARGIN, view.width)
    bottom = min(int(box.bottom) + 1 + _MARGIN - view.top, view.rows)
    left, right = splat(i4(_FAR)), splat(i4(-1))
    seen_left, seen_right = splat(i4(_FAR)), splat(i4(-1))
    seen_count, covered_count = splat(i4(0)), splat(i4(0))
    highest, lowest, seen_highest, seen_lowest = -1, -1, -1, -1
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
            seen = covered & belongs_to(tag_of(load(key, at)), drawn, first, last)
            if not any_of(seen):
                continue
            seen_highest, seen_lowest = (line if seen_highest < 0 else seen_highest), line
            seen_left = lesser(seen_left, select(seen, columns, i4(_FAR)))
            seen_right = greater(seen_right, select(seen, columns, i4(-1)))
            seen_count += to_i4(seen)
    if highest < 0:
        return
    result[0], result[1] = _least(left), view.top + highest
    result[2], result[3] = _most(right) + 1, view.top + lowest + 1
    result[4], result[5] = _sum(seen_count), _sum(covered_count)
    if seen_highest >= 0:
        result[6], result[7] = _least(seen_left), view.top + seen_highest
        result[8], result[9] = _most(seen_right) + 1, view.top + seen_lowest + 1


@kernel
def _measure(
    band: Band, shown: Band, first: int, last: int, count: int, result: NDArray[np.int32]
) -> None:
    """Measure slots `first` to `last`; see `measure_actors`."""
    if draw_slots(band, first, last, count) == count:
        return
    box = _screen_box(address_of(caster_of(band, first, last)), band.camera)
    fixtures = len(band.geometry.fixture_prototype)
    if shown.glass.on == 1:
        things = fixtures + first, fixtures + last
        count_bent(band, shown, box, _MARGIN, things, result)
    else:
        _count(band, box, fixtures + first, fixtures + last, result)


@kernel
def measure_actors(band: Band, shown: Band, count: int, output: NDArray[np.int32]) -> None:
    """Measure all actors of a world in a band, each alone and as the band shows it.

    Args:
        band: One sample for each pixel; `alone` must be clear, and is so again.
        shown: What the picture shows: the same, or the picture of which it is a face.
        count: Rows of `Band.drawn` that it uses.
        output: See `Output.actor`, shape (A, 10); rows of actors outside the band are not written.
    """
    movers, world = band.movers, band.world
    slots = movers.part.shape[1]
    first = next_thing(band, 0)
    while first < slots:
        last = end_of_thing(band, first)
        actor = movers.object_id[world, first] - ACTOR_OBJECT
        if 0 <= actor < len(output):
            _measure(band, shown, first, last, count, output[actor])
        first = next_thing(band, last)


@kernel
def measure_subject(
    band: Band, shown: Band, subject: int, count: int, result: NDArray[np.int32]
) -> None:
    """Measure the object of an id, if it is one of the moving things; see `measure_actors`."""
    movers, world = band.movers, band.world
    slots = movers.part.shape[1]
    first = next_thing(band, 0)
    while first < slots and movers.object_id[world, first] != subject:
        first = next_thing(band, end_of_thing(band, first))
    if first < slots:
        _measure(band, shown, first, end_of_thing(band, first), count, result)
