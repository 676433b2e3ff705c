"""Shading of a band: from the key of each sample to the bytes of the picture."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel, inner_kernel
from eyas.core.lanes import (
    WIDTH,
    all_of,
    any_of,
    bits_of,
    first_bit,
    gather,
    greater,
    lane,
    lane_numbers,
    load_words,
    select,
    splat,
    to_f4,
    to_i4,
    to_u4,
)
from eyas.render.kernels.bundles import Geometry, Illumination, Light, Movers, View
from eyas.render.kernels.light.tone import tone_bytes
from eyas.render.kernels.pixels import keys_of, pack, write_pixels
from eyas.render.kernels.rays import ray_of, rays_of
from eyas.render.kernels.scalars import f4, i4, i8, u4
from eyas.render.kernels.surface.attributes import Frame, frame_of, no_frame
from eyas.render.kernels.surface.shade import shade_point
from eyas.render.kernels.visibility.key import distance_inverse, drawn_of, tag_of, triangle_of

__all__ = ["instance_frame", "shade_band"]

Bytes = tuple[int, int, int]


@inlined_kernel
def instance_frame(
    geometry: Geometry, movers: Movers, world: int, drawn: NDArray[np.int32], row: int
) -> Frame:
    """Return pose and colour of an instance, a row of `Scratch.drawn`; fixtures have no colour."""
    instance, fixtures = drawn[row, 1], len(geometry.fixture_object)
    if instance >= fixtures:
        return frame_of(movers.pose[world], movers.colour[world], instance - fixtures)
    return frame_of(geometry.fixture_pose, movers.colour[world, :0], instance)


@inlined_kernel
def _colours(
    view: View,
    geometry: Geometry,
    light: Light,
    lit: Illumination,
    movers: Movers,
    world: int,
    drawn: NDArray[np.int32],
    tag: int,
    wanted: bool,
    distance: float,
    line: float,
    column: float,
    shade: int,
) -> Bytes:
    """Return the bytes of eight samples; those not wanted are 0.

    All samples of one instance are computed together: its pose is the same number in all lanes.
    """
    rays = rays_of(view)
    ray, eye = ray_of(rays, line, column), (rays.eye.x, rays.eye.y, rays.eye.z)
    row, triangle = drawn_of(tag), triangle_of(tag)
    red, green, blue = splat(u4(0)), splat(u4(0)), splat(u4(0))
    left = bits_of(wanted)
    while left != 0:
        which = lane(row, first_bit(left))
        same = wanted & (row == which)
        left &= ~bits_of(same)
        frame, first = no_frame(), i4(0)
        if which >= 0:
            frame, first = instance_frame(geometry, movers, world, drawn, which), drawn[which, 0]
        colour = shade_point(
            geometry, light, lit, select(same, triangle + first, i4(0)), which >= 0, frame, eye,
            ray, distance, rays.pixel, shade,
        )  # fmt: skip
        r, g, b = tone_bytes(light, lit.air.exposure, colour)
        red, green, blue = select(same, r, red), select(same, g, green), select(same, b, blue)
    return red, green, blue


@inlined_kernel
def _uniform(key: NDArray[np.int64], line: int, sample: int) -> tuple[bool, float]:
    """Return where the four samples of each pixel show one triangle, and their mean 1/distance."""
    first = keys_of(key, line, sample, 2)
    tag, total = tag_of(first), distance_inverse(first)
    same = first != i8(0)
    for k in range(1, 4):
        keys = keys_of(key, line + (k >> 1), sample + (k & 1), 2)
        same &= (tag_of(keys) == tag) & (keys != i8(0))
        total += distance_inverse(keys)
    return same, total * f4(0.25)


@inner_kernel
def shade_band(
    view: View,
    geometry: Geometry,
    light: Light,
    lit: Illumination,
    movers: Movers,
    world: int,
    drawn: NDArray[np.int32],
    key: NDArray[np.int64],
    shade: NDArray[np.uint8],
    pixels: NDArray[np.uint8],
) -> None:
    """Write the pixels of a band except the sky, which `draw_backdrop` has already written.

    A pixel whose four samples show one triangle is computed once, at its centre: 1/distance is
    linear on the screen, so its value there is the mean of the four.

    Args:
        view: The band.
        geometry: Everything that can be drawn.
        light: Maps of light and lamps.
        lit: Light and air of the view.
        movers: The draw lists.
        world: The one of this view.
        drawn: See `Scratch`.
        key: See `Scratch`, shape (rows, columns).
        shade: See `Scratch`, shape (rows, columns, 4).
        pixels: sRGB, shape (rows, columns, 3).
    """
    samples, width = view.samples, pixels.shape[1]
    numbers = to_f4(lane_numbers())
    for row in range(pixels.shape[0]):
        for first in range(0, width, WIDTH):
            line, sample = row * samples, first * samples
            whole, mean = splat(samples == 1), splat(f4(0.0))
            if samples == 2:
                whole, mean = _uniform(key, line, sample)
            centre = select(whole, f4(0.5) * f4(samples), f4(0.5))
            inside = numbers < f4(width - first)
            red, green, blue = splat(u4(0)), splat(u4(0)), splat(u4(0))
            shown = i8(0)
            for k in range(samples * samples):
                if k > 0 and all_of(whole | ~inside):
                    break
                down, right = k // samples, k % samples
                keys = keys_of(key, line + down, sample + right, samples)
                seen = inside & (keys != i8(0))
                shown |= bits_of(seen)
                wanted = seen if k == 0 else seen & ~whole
                if samples == 2:
                    back = inside & ~seen
                    if any_of(back):
                        r, g, b = _written(pixels, row, first, back)
                        red, green, blue = red + r, green + g, blue + b
                if not any_of(wanted):
                    continue
                inverse = distance_inverse(keys)
                if samples == 2:
                    inverse = select(whole, mean, inverse)
                distance = f4(1.0) / select(seen, inverse, f4(1.0))
                at = (line + down) * key.shape[1] + sample + right
                words = (
                    load_words(shade, 4 * at)
                    if samples == 1
                    else _spread_words(shade, at)
                )
                r, g, b = _colours(
                    view, geometry, light, lit, movers, world, drawn, tag_of(keys), wanted,
                    distance, centre + f4(line + down),
                    numbers * f4(samples) + f4(sample + right) + centre, words,
                )  # fmt: skip
                red, green, blue = red + r, green + g, blue + b
            if samples == 2:
                red = select(whole, red, (red + u4(2)) >> u4(2))
                green = select(whole, green, (green + u4(2)) >> u4(2))
                blue = select(whole, blue, (blue + u4(2)) >> u4(2))
            if shown != 0:
                write_pixels(pixels, row, first, shown, pack(red, green, blue))


@inlined_kernel
def _spread_words(shade: NDArray[np.uint8], at: int) -> int:
    """Return the four bytes of every second sample, from sample `at` on."""
    first = (lane_numbers() * i4(2) + i4(at)) * i4(4)
    words = gather(shade, first)
    for k in range(1, 4):
        words |= gather(shade, first + i4(k)) << u4(8 * k)
    return words


@inlined_kernel
def _written(pixels: NDArray[np.uint8], row: int, first: int, mask: bool) -> Bytes:
    """Return the bytes that eight pixels have already, 0 where the mask is not set."""
    at = (lane_numbers() + i4(row * pixels.shape[1] + first)) * i4(3)
    at = select(mask, at, i4(0))
    zero = u4(0)
    return (
        select(mask, gather(pixels, at), zero),
        select(mask, gather(pixels, at + i4(1)), zero),
        select(mask, gather(pixels, at + i4(2)), zero),
    )
