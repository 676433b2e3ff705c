"""Shading of a band: from the key of each sample to the colours of the picture."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Canvas
from eyas.engine.render.kernels.colours import Colour
from eyas.engine.render.kernels.light.tone import tone_bytes
from eyas.engine.render.kernels.pixels import (
    ACROSS,
    keys_of,
    keys_of_tile,
    pack,
    write_colours,
    write_pixels,
    write_tile,
    written,
)
from eyas.engine.render.kernels.rays import Rays, place_in_face, place_in_tile, ray_of, rays_of
from eyas.engine.render.kernels.samples import own_rows, pixel_row
from eyas.engine.render.kernels.scalars import f4, i4, i8, u4
from eyas.engine.render.kernels.surface.shade import shade_point
from eyas.engine.render.kernels.visibility.key import (
    distance_inverse,
    drawn_of,
    tag_of,
    triangle_of,
)
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    agree,
    all_of,
    any_of,
    bits_of,
    first_bit,
    gather,
    greater,
    lane,
    lane_numbers,
    load_words,
    load_words_two,
    own,
    select,
    splat,
    to_f4,
    to_i4,
    to_u4,
)

Four = tuple[int, int, int, int]


@kernel(inline=False)
def _one_instance(
    band: Band,
    row: int,
    triangle: int,
    eye: Colour,
    ray: Colour,
    away: float,
    pixel: float,
    shade: int,
) -> Colour:
    """Return the radiance of eight points of one instance, a row of `Band.drawn`.

    A function of its own: inlined into the loops that call it, the hundred numbers that are the
    same for all points would be spread over lanes before each loop, kept in memory and read again.
    """
    first = i4(0)
    if row >= 0:
        first = band.drawn[row, 0]
    return shade_point(band, row, triangle + first, eye, ray, away, pixel, shade)


@kernel(inline=True)
def _own_colours(
    band: Band,
    rays: Rays,
    tag: int,
    wanted: bool,
    distance: float,
    line: float,
    column: float,
    wide: float,
    shade: int,
) -> Colour:
    """Return what `_colours_of` does; each thread computes its own sample."""
    red, green, blue = f4(0.0), f4(0.0), f4(0.0)
    if own(wanted):
        ray, eye = ray_of(rays, own(line), own(column)), (rays.eye.x, rays.eye.y, rays.eye.z)
        away = own(distance)
        if band.glass.on == 1:
            part = f4(1.0) / own(wide)
            ray, away = (ray[0] * part, ray[1] * part, ray[2] * part), away * own(wide)
        row, triangle = drawn_of(own(tag)), triangle_of(own(tag))
        red, green, blue = _one_instance(
            band, row, i4(triangle), eye, ray, away, rays.pixel, own(shade)
        )
    agree()
    return splat(red), splat(green), splat(blue)


@kernel(inline=True, threads=_own_colours)
def _colours_of(
    band: Band,
    rays: Rays,
    tag: int,
    wanted: bool,
    distance: float,
    line: float,
    column: float,
    wide: float,
    shade: int,
) -> Colour:
    """Return the radiance of eight samples; that of those not wanted is 0.

    All samples of one instance are computed together: its pose is the same number in all lanes.
    """
    ray, eye = ray_of(rays, line, column), (rays.eye.x, rays.eye.y, rays.eye.z)
    if band.glass.on == 1:
        # A pixel spans an angle times the distance along the axis: the longer that, the wider it.
        part = f4(1.0) / wide
        ray, distance = (ray[0] * part, ray[1] * part, ray[2] * part), distance * wide
    row, triangle = drawn_of(tag), triangle_of(tag)
    which = lane(row, 0)
    if all_of(wanted & (row == which)):  # as in nine of ten tiles
        return _one_instance(band, which, triangle, eye, ray, distance, rays.pixel, shade)
    red, green, blue, left = splat(f4(0.0)), splat(f4(0.0)), splat(f4(0.0)), bits_of(wanted)
    while left != 0:
        first = first_bit(left)
        which = lane(row, first)
        same = wanted & (row == which)
        left &= ~bits_of(same)
        # The other lanes repeat the first, and so take none of the ways that it does not.
        known = select(same, triangle, lane(triangle, first))
        away = select(same, distance, lane(distance, first))
        shown = _one_instance(band, which, known, eye, ray, away, rays.pixel, shade)
        red = select(same, shown[0], red)
        green = select(same, shown[1], green)
        blue = select(same, shown[2], blue)
    return red, green, blue


@kernel(inline=True)
def _keys_within(band: Band, line: int, sample: int, across: int) -> Four:
    """Return the keys of the samples of eight pixels, `across` in a row and two rows.

    Where there are only two, the others are 0, which is the sky.
    """
    key, none = band.key, splat(i8(0))
    if across == 1:
        return keys_of(key, line, sample, 1), keys_of(key, line + 1, sample, 1), none, none
    return (
        keys_of(key, line, sample, 2),
        keys_of(key, line, sample + 1, 2),
        keys_of(key, line + 1, sample, 2),
        keys_of(key, line + 1, sample + 1, 2),
    )


@kernel(inline=True)
def _places_within(
    band: Band, line: int, sample: int, across: int
) -> tuple[Colour, Colour, Colour, Colour]:
    """Return row, column and width in the face of those samples; without a lens nothing."""
    zero, glass = splat(f4(0.0)), band.glass
    none = zero, zero, zero
    if glass.on == 0:
        return none, none, none, none
    if across == 1:
        upper = place_in_face(glass, line, sample, 1)
        return upper, place_in_face(glass, line + 1, sample, 1), none, none
    return (
        place_in_face(glass, line, sample, 2),
        place_in_face(glass, line, sample + 1, 2),
        place_in_face(glass, line + 1, sample, 2),
        place_in_face(glass, line + 1, sample + 1, 2),
    )


@kernel(inline=True)
def _alike(
    bent: bool, four: Four, places: tuple[Colour, Colour, Colour, Colour], k: int, across: int
) -> tuple[int, bool, int, float, float, float, float]:
    """Compare sample `k` of eight pixels with the others.

    Args:
        bent: Whether there is a lens.
        four: Their keys. These and the places are read once, before anything is shaded: each time
            is a load for each pixel.
        places: See `_places_within`.
        k: The number.
        across: Samples in a row.

    Returns:
        Its tag, whether no sample before it shows the same, and of all that show the same: how
        many they are, and the means of 1/distance, row and column from the pixel's corner, and 1;
        through a lens, row, column and width in the face.
    """
    tag, zero = tag_of(four[k]), f4(0.0)
    count, total = splat(zero), splat(zero)
    down, right, wide = splat(zero), splat(zero), splat(f4(1.0))
    if bent:
        wide = splat(zero)
    is_first = splat(f4(1.0)) > zero
    for other in range(2 * across):
        keys = four[other]
        same = (tag_of(keys) == tag) & (keys != i8(0))
        if other < k:
            is_first &= ~same
        share = select(same, splat(f4(1.0)), zero)
        count += share
        total += share * distance_inverse(keys)
        if bent:
            below, aside, size = places[other]
            down, right, wide = down + share * below, right + share * aside, wide + share * size
        else:
            down += share * (f4(other // across) + f4(0.5))
            right += share * (f4(other % across) + f4(0.5))
    part = f4(1.0) / greater(count, f4(1.0))
    if bent:
        wide = greater(wide * part, f4(1e-6))
    return tag, is_first, to_u4(to_i4(count)), total * part, down * part, right * part, wide


@kernel(inline=True)
def _shade_tile(
    band: Band,
    rays: Rays,
    canvas: Canvas,  # Its colours
    size: tuple[int, int],  # Its rows and columns; what lies beyond is left out
    row: int,  # The first row
    first: int,  # The first column
) -> None:
    """Write four pixels of a row and four of the next, with one sample each."""
    key, lanes, half = band.key, lane_numbers(), splat(f4(0.5))
    down, right = to_f4(lanes >> i4(2)), to_f4(lanes & i4(ACROSS - 1))
    stride, below = 4 * key.shape[1], min(size[0] - 1 - row, 1)
    keys = keys_of_tile(key, row, first, below)
    seen = (right < f4(size[1] - first)) & (down < f4(size[0] - row)) & (keys > i8(0))
    if not any_of(seen):
        return
    words = load_words_two(band.shade, row * stride + 4 * first, below * stride)
    distance = f4(1.0) / select(seen, distance_inverse(keys), f4(1.0))
    line, column, wide = down + half + (rays.top + f4(row)), right + f4(first) + half, half
    if band.glass.on == 1:
        line, column, wide = place_in_tile(band.glass, row, first, below)
    colour = _colours_of(band, rays, tag_of(keys), seen, distance, line, column, wide, words)
    write_tile(canvas, band.light, band.lit.air.exposure, row, first, seen, colour)


@kernel(inline=True)
def _shade_several(
    band: Band, rays: Rays, pixels: NDArray[np.uint8], row: int, first: int, across: int
) -> None:
    """Write the bytes of eight pixels of a row, with two rows of samples each.

    Each triangle that a pixel shows is computed once, in the middle of the samples that show it,
    and counts as often as there are of them; 1/distance is linear on the screen, so the mean of
    theirs is the one in the middle.
    """
    numbers, line, sample = to_f4(lane_numbers()), 2 * row, across * first
    inside = numbers < f4(pixels.shape[1] - first)
    # Sums of red and blue in the halves of one number, and of green, of four samples.
    both, green, shown, each = splat(u4(0)), splat(u4(0)), i8(0), u4(2 // across)
    even, eight = u4(0x00FF00FF), u4(8)
    keys_all = _keys_within(band, line, sample, across)
    places, bent = _places_within(band, line, sample, across), band.glass.on == 1
    for k in range(2 * across):
        keys = keys_all[k]
        seen = inside & (keys > i8(0))
        shown |= bits_of(seen)
        sky = written(pixels, row, first, inside & (keys == i8(0)))
        both, green = both + each * (sky & even), green + each * ((sky >> eight) & even)
        tag, is_first, count, inverse, down, right, wide = _alike(bent, keys_all, places, k, across)
        seen &= is_first
        if not any_of(seen):
            continue
        words = _words_within(band, line + k // across, sample + k % across, across)
        distance = f4(1.0) / select(seen, inverse, f4(1.0))
        if band.glass.on == 0:
            down = down + (rays.top + f4(line))
            right = numbers * f4(across) + f4(sample) + right
        colour = _colours_of(band, rays, tag, seen, distance, down, right, wide, words)
        red_byte, green_byte, blue_byte = tone_bytes(band.light, band.lit.air.exposure, colour)
        packed, weight = select(seen, pack(red_byte, green_byte, blue_byte), u4(0)), each * count
        both, green = both + weight * (packed & even), green + weight * ((packed >> eight) & even)
    if shown != 0:
        two, halves = u4(2), u4(0x00020002)
        both, green = ((both + halves) >> two) & even, ((green + two) >> two) & u4(255)
        write_pixels(pixels, row, first, shown, to_u4(both | (green << eight)))


@kernel(inline=True)
def _mean_of_several(
    band: Band, rays: Rays, canvas: Canvas, row: int, first: int, across: int
) -> None:
    """Write the mean radiance of eight pixels of a row; see `_shade_several`.

    Light is added up, not bytes: a lamp in a quarter of a pixel keeps a quarter of its light.
    """
    numbers, line, sample = to_f4(lane_numbers()), 2 * row, across * first
    width = band.columns
    inside = numbers < f4(width - first)
    red, green, blue, shown = splat(f4(0.0)), splat(f4(0.0)), splat(f4(0.0)), i8(0)
    zero, one = f4(0.0), splat(f4(1.0))
    keys_all = _keys_within(band, line, sample, across)
    places, bent = _places_within(band, line, sample, across), band.glass.on == 1
    for k in range(2 * across):
        keys = keys_all[k]
        seen = inside & (keys > i8(0))
        shown |= bits_of(seen)
        sky = inside & (keys == i8(0))
        if any_of(sky):
            at = select(sky, lane_numbers() + i4(row * width + first), i4(0))
            red += select(sky, gather(canvas.red, at), zero)
            green += select(sky, gather(canvas.green, at), zero)
            blue += select(sky, gather(canvas.blue, at), zero)
        tag, is_first, count, inverse, down, right, wide = _alike(bent, keys_all, places, k, across)
        seen &= is_first
        if not any_of(seen):
            continue
        words = _words_within(band, line + k // across, sample + k % across, across)
        distance = f4(1.0) / select(seen, inverse, one)
        if band.glass.on == 0:
            down = down + (rays.top + f4(line))
            right = numbers * f4(across) + f4(sample) + right
        colour = _colours_of(band, rays, tag, seen, distance, down, right, wide, words)
        share = to_f4(to_i4(count))
        red += share * colour[0]
        green += share * colour[1]
        blue += share * colour[2]
    if shown != 0:
        part = f4(1.0) / f4(2 * across)
        colour = (part * red, part * green, part * blue)
        write_colours(canvas, band.light, band.lit.air.exposure, row, first, shown, colour)


@kernel
def shade_band(
    band: Band,
    canvas: Canvas,  # Its colours
) -> None:
    """Write the pixels of a band except the sky, which `draw_backdrop` has already written."""
    rays, view, width, rows = rays_of(band.camera), band.camera, band.columns, band.lines
    if view.down == 1:
        for row in range(2 * band.member, rows, 2 * band.members):
            for first in range(0, width, ACROSS):
                _shade_tile(band, rays, canvas, (rows, width), row, first)
        return
    for k in range(*own_rows(band, 0, rows)):
        _shade_row(band, rays, canvas, pixel_row(band, k))


@kernel(inline=True)
def _shade_row(band: Band, rays: Rays, canvas: Canvas, row: int) -> None:
    """Write the pixels of a row, with several samples each."""
    width, across = band.columns, band.camera.across
    if len(canvas.red) > 0:
        for first in range(0, width, WIDTH):
            if across == 1:
                _mean_of_several(band, rays, canvas, row, first, 1)
            else:
                _mean_of_several(band, rays, canvas, row, first, 2)
    elif across == 1:
        for first in range(0, width, WIDTH):
            _shade_several(band, rays, canvas.pixels, row, first, 1)
    else:
        for first in range(0, width, WIDTH):
            _shade_several(band, rays, canvas.pixels, row, first, 2)


@kernel(inline=True)
def _words_within(band: Band, line: int, sample: int, across: int) -> int:
    """Return the four bytes of eight samples, `across` apart, from one on."""
    shade, at = band.shade, line * band.key.shape[1] + sample
    if across == 1:
        return load_words(shade, 4 * at)
    first = (lane_numbers() * i4(2) + i4(at)) * i4(4)
    words = gather(shade, first)
    for k in range(1, 4):
        words |= gather(shade, first + i4(k)) << u4(8 * k)
    return words
