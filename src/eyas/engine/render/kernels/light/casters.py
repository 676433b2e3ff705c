"""Soft shadows of moving things, and the light of their lamps.

Each thing is represented by two upright boxes, like the body and cabin of a car; a point is in
shadow where its line to the sun passes through one of them.
"""

import math

from eyas.engine.render.kernels.bundles import Band, Direction, View
from eyas.engine.render.kernels.light.beams import BEAM_REACH, cast_beam
from eyas.engine.render.kernels.light.caster import (
    CORNER,
    Caster,
    beyond,
    boxes_of,
    camera_of,
    caster_of,
    has_lamps,
    reach_of,
)
from eyas.engine.render.kernels.light.shadow_boxes import darken, may_darken
from eyas.engine.render.kernels.samples import (
    ScreenBox,
    around,
    empty_box,
    own_row,
    point_of,
    ray_of_row,
)
from eyas.engine.render.kernels.scalars import f4, i4, u4
from eyas.engine.render.kernels.surface.signalling import BRAKING
from eyas.engine.render.kernels.visibility.cull import sphere_is_visible
from eyas.engine.render.kernels.visibility.key import distance_inverse, tag_of
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
    lane_numbers,
    lesser,
    load,
    load_words,
    select,
    splat,
    store_words,
    to_u4,
)

SMALLEST = 1.0  # Things whose half diagonal is smaller cast no shadow [pixels]

_BELOW = 0.3  # Distance below the bottom of a thing down to which its shadow falls [m]


@kernel(inline=True)
def _throw(sun: Direction, longest: float) -> float:
    """Return the distance of a shadow's end, per metre of height and unit of the sun's x and y.

    `longest` is `Air.longest_shadow`.
    """
    return min(1.0 / max(float(sun.z), 1e-3), float(longest))


@kernel
def influence(
    reach: float,  # How far the corners of its parts are from any point of it, at most [m]
    sun: Direction,  # Unit vector to the sun
    longest: float,  # Longest shadow, in heights
    lamps_on: bool,  # Whether the lamps of vehicles are on
) -> float:
    """Return the distance up to which a thing, its shadow and its light may be in a picture [m]."""
    height = 2.0 * reach
    length = _throw(sun, longest) * height * math.sqrt(sun.x * sun.x + sun.y * sun.y)
    most = CORNER * (reach + beyond(height)) + _BELOW + length
    return max(most, CORNER * reach + BEAM_REACH) if lamps_on else most


@kernel(inline=True)
def _may_reach(band: Band, first: int, last: int, lamps_on: bool) -> bool:
    """Return whether a thing, its shadow or its light may be in the picture.

    This is tested first because it needs no box around the thing.
    """
    lit = band.lit
    most = influence(reach_of(band, first, last), lit.sun, lit.air.longest_shadow, lamps_on)
    origin = band.movers.pose[band.world, first]
    return sphere_is_visible(
        band.camera.planes, float(origin[0, 3]), float(origin[1, 3]), float(origin[2, 3]), most
    )


@kernel
def _may_show(caster: Caster, sun: Direction, longest: float, view: View) -> bool:
    """Return whether a shadow may be in the picture, and large enough to see."""
    height = caster.top - caster.bottom
    half = 0.5 * _throw(sun, longest) * height
    x, y, z = caster.x - half * sun.x, caster.y - half * sun.y, 0.5 * (caster.top + caster.bottom)
    length = math.sqrt(caster.length**2 + caster.width**2)
    ahead = view.screen.distance
    if view.focal * length < SMALLEST * (ahead.x * x + ahead.y * y + ahead.z * z + ahead.w):
        return False
    reach = length + 1.5 * caster.beyond + half + 0.5 * height + _BELOW
    return sphere_is_visible(view.planes, x, y, z, reach)


@kernel
def _screen_box(caster: Caster, sun: Direction, longest: float, view: View) -> ScreenBox:
    """Return the box around a thing and its shadow on the ground, see `around`."""
    box = empty_box()
    throw = _throw(sun, longest) * (caster.top - caster.bottom)
    for corner in range(16):
        along = (caster.length + caster.beyond) * (1.0 if corner & 1 else -1.0)
        aside = (caster.width + caster.beyond) * (1.0 if corner & 2 else -1.0)
        x = caster.x + along * caster.along_x - aside * caster.along_y
        y = caster.y + along * caster.along_y + aside * caster.along_x
        z = caster.top if corner & 4 else caster.bottom - _BELOW
        if corner & 8:
            x -= throw * sun.x
            y -= throw * sun.y
            z = caster.bottom - _BELOW
        box = around(box, view, x, y, z)
    return box


@kernel
def _cast_shadow(caster: Caster, band: Band, first: int, last: int) -> None:
    """Darken the samples that instances `first` to `last` shade, but not these themselves."""
    sun, view, key, drawn, shade = band.lit.sun, band.camera, band.key, band.drawn, band.shade
    box = _screen_box(caster, sun, band.lit.air.longest_shadow, view)
    camera, boxes = camera_of(caster, view), boxes_of(caster, sun)
    stride = key.shape[1]
    begin, end = max(int(box.left), 0), min(int(box.right) + 1, view.width)
    bottom = min(int(box.bottom) + 1 - view.top, view.rows)
    for line in range(own_row(band, max(int(box.top) - view.top, 0)), bottom, band.members):
        ray = ray_of_row(camera, view, line)
        for start in range(begin, end, WIDTH):
            left = min(start, stride - WIDTH)
            at = line * stride + left
            columns, keys = lane_numbers() + i4(left), load(key, at)
            inverse = distance_inverse(keys)
            seen = (inverse > f4(0.0)) & (columns >= i4(begin)) & (columns < i4(end))
            x, y, z = point_of(camera, view, ray, columns, select(seen, inverse, f4(1.0)))
            seen &= may_darken(boxes, x, y, z)
            if any_of(seen):
                seen &= ~belongs_to(tag_of(keys), drawn, first, last)
            if not any_of(seen):
                continue
            direct, open_share = darken(boxes, x, y, z)
            words = load_words(shade, 4 * at)
            sunny = lesser(words & u4(255), to_u4(direct * f4(255.0)))
            open_sky = lesser((words >> u4(8)) & u4(255), to_u4(open_share * f4(255.0)))
            dark = (words & u4(0xFFFF0000)) | sunny | (open_sky << u4(8))
            store_words(shade, 4 * at, select(seen, dark, words))


@kernel(inline=True)
def _end_of_body(band: Band, first: int, last: int) -> int:
    """Return the slot after those of a body: that of the trailer of what begins at `first`."""
    geometry, parts = band.geometry, band.movers.part[band.world]
    if not geometry.lamps[geometry.part_first + parts[first]]:
        return last
    end = first + 1
    while end < last and (parts[end] < 0 or geometry.lamps[geometry.part_first + parts[end]]):
        end += 1
    return end


@kernel(inline=True)
def _stretch(truck: Caster, trailer: Caster) -> float:
    """Return how much farther back a trailer ends, if it is straight behind its truck [m]."""
    apart = math.sqrt((truck.x - trailer.x) ** 2 + (truck.y - trailer.y) ** 2)
    return max(apart + trailer.length - truck.length, 0.0)


@kernel(inline=True)
def _longer(caster: Caster, more: float) -> Caster:
    """Return a caster that ends farther back [m]."""
    half = 0.5 * more
    return Caster(
        caster.x - half * caster.along_x, caster.y - half * caster.along_y,
        caster.along_x, caster.along_y, caster.length + half, caster.width,
        caster.bottom, caster.top, caster.waist, caster.back + half, caster.front + half,
        caster.right, caster.left, caster.lower_right, caster.lower_left, caster.beyond,
    )  # fmt: skip


@kernel(inline=True)
def _brakes(band: Band, slot: int) -> bool:
    """Return whether the thing in a slot has brake lamps on."""
    lamps = band.movers.lamps
    return lamps.shape[1] > 0 and (lamps[band.world, slot] & BRAKING) == BRAKING


@kernel
def cast_light(band: Band) -> None:
    """Write the share of light that moving things let through to each sample, and their own light.

    Slots in a row with the same object id are one thing. Those of objects of the scene, such as the
    lenses of signals, cast nothing.
    """
    movers, world, shade = band.movers, band.world, band.shade
    rows, stride = band.key.shape
    for line in range(band.member, rows, band.members):
        for at in range(line * stride, (line + 1) * stride, WIDTH):
            store_words(shade, 4 * at, splat(u4(0xFFFF)))
    lamps_on = band.lit.air.lamps > f4(0.0)
    fixtures, slots = len(band.geometry.fixture_prototype), movers.part.shape[1]
    first = next_thing(band, 0)
    while first < slots:
        last = end_of_thing(band, first)
        mover = movers.object_id[world, first] >= ACTOR_OBJECT
        if mover and _may_reach(band, first, last, lamps_on):
            begin = first
            while begin < last:
                end = _end_of_body(band, begin, last)
                caster = address_of(caster_of(band, begin, end))
                longest = band.lit.air.longest_shadow
                if _may_show(caster, band.lit.sun, longest, band.camera):
                    _cast_shadow(caster, band, fixtures + first, fixtures + last)
                if lamps_on and has_lamps(band, begin, end):
                    reach = 0.0
                    if end < last:
                        reach = _stretch(caster, caster_of(band, end, last))
                    cast_beam(address_of(_longer(caster, reach)), band, _brakes(band, first))
                begin = end
        first = next_thing(band, last)
