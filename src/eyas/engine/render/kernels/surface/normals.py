"""The surface normal of each pixel, in the frame of the camera."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Band, Direction
from eyas.engine.render.kernels.colours import Vector
from eyas.engine.render.kernels.pixels import keys_of, pack, write_pixels
from eyas.engine.render.kernels.rays import camera_axes, place_in_face, ray_of, rays_of
from eyas.engine.render.kernels.scalars import f4, i4, i8, u4
from eyas.engine.render.kernels.surface.attributes import attributes_of
from eyas.engine.render.kernels.visibility.key import (
    distance_inverse,
    drawn_of,
    tag_of,
    triangle_of,
)
from eyas.lanes import kernel
from eyas.lanes.vector import (
    WIDTH,
    bits_of,
    first_bit,
    greater,
    lane,
    lane_numbers,
    lesser,
    select,
    splat,
    to_f4,
    to_i4,
    to_u4,
)


@kernel(inline=True)
def _byte(axis: Direction, normal: Vector, sign: float) -> int:
    """Return a component of a normal, -1 to 1, as 0 to 255."""
    value = sign * (axis.x * normal[0] + axis.y * normal[1] + axis.z * normal[2])
    value = lesser(greater(value * f4(127.5) + f4(128.0), f4(0.0)), f4(255.0))
    return to_u4(to_i4(value))


@kernel(inline=False)
def _of_instance(band: Band, row: int, triangle: int, ray: Vector, distance: float) -> int:
    """Return the packed normals of eight points of one instance, a row of `Band.drawn`."""
    first, rays = i4(0), rays_of(band.camera)
    if row >= 0:
        first = band.drawn[row, 0]
    x, y, z = ray
    eye = rays.eye
    point = (eye.x + x * distance, eye.y + y * distance, eye.z + z * distance)
    at = attributes_of(band, row, triangle + first, point)
    # Leaves are seen from both sides, and smooth normals may turn away at outlines.
    away = at.normal[0] * x + at.normal[1] * y + at.normal[2] * z > f4(0.0)
    sign = select(away, f4(-1.0), f4(1.0))
    ahead, left, up = camera_axes(band)
    right, down = _byte(left, at.normal, -sign), _byte(up, at.normal, -sign)
    return pack(right, down, _byte(ahead, at.normal, sign))


@kernel
def write_normals(
    band: Band,  # One sample for each pixel
    pixels: NDArray[np.uint8],  # Shape (rows, columns, 3)
) -> None:
    """Write the unit normals of a band: right, down and ahead, each from -1 to 1 as 0 to 255.

    They face the camera; 0, 0, 0 is the sky.
    """
    rays, key, width, glass = rays_of(band.camera), band.key, pixels.shape[1], band.glass
    numbers, half = to_f4(lane_numbers()), splat(f4(0.5))
    for line in range(band.member, pixels.shape[0], band.members):
        for start in range(0, width, WIDTH):
            keys = keys_of(key, line, start, 1)
            inside = (numbers < f4(width - start)) & (keys >= i8(0))
            seen = inside & (keys != i8(0))
            distance = f4(1.0) / select(seen, distance_inverse(keys), f4(1.0))
            row, column = half + (rays.top + f4(line)), numbers + f4(start) + half
            if glass.on == 1:
                row, column, _ = place_in_face(glass, line, start, 1)
            ray = ray_of(rays, row, column)
            drawn, triangle = drawn_of(tag_of(keys)), triangle_of(tag_of(keys))
            packed, left = splat(u4(0)), bits_of(seen)
            while left != 0:
                which = lane(drawn, first_bit(left))
                same = seen & (drawn == which)
                left &= ~bits_of(same)
                known, away = select(same, triangle, i4(0)), select(same, distance, f4(1.0))
                packed = select(same, _of_instance(band, which, known, ray, away), packed)
            write_pixels(pixels, line, start, bits_of(inside), packed)
