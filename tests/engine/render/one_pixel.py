"""One pixel at a time: what a thread of a graphics processor runs, from the same functions."""

from eyas.engine.render.kernels.bundles import Band
from eyas.engine.render.kernels.light.tone import tone_bytes
from eyas.engine.render.kernels.pixels import pack
from eyas.engine.render.kernels.rays import ray_of, rays_of
from eyas.engine.render.kernels.scalars import f4, i4, i8, u4
from eyas.engine.render.kernels.sky.radiance import sky_colour
from eyas.engine.render.kernels.surface.shade import shade_point
from eyas.engine.render.kernels.visibility.key import (
    distance_inverse,
    drawn_of,
    tag_of,
    triangle_of,
)
from eyas.lanes import kernel

__all__ = ["shade_pixel"]


@kernel(inline=True)
def shade_pixel(band: Band, key: int, shade: int, row: int, column: int) -> int:
    """Return the packed bytes of a pixel with one sample, sky included.

    Args:
        band: The band.
        key: What the pixel shows.
        shade: Its four bytes of `Scratch.shade`.
        row: Row in the band.
        column: Column of the picture.
    """
    light, lit, rays = band.light, band.lit, rays_of(band.camera)
    line, across = rays.top + f4(row) + f4(0.5), f4(column) + f4(0.5)
    if key == i8(0):
        colour = sky_colour(light, lit, rays, line, across)
        red, green, blue = tone_bytes(light, lit.air.exposure, colour)
        return pack(red, green, blue)
    tag = tag_of(key)
    which, first = drawn_of(tag), i4(0)
    if which >= 0:
        first = band.drawn[which, 0]
    colour = shade_point(
        band, which, i4(triangle_of(tag) + first),
        (rays.eye.x, rays.eye.y, rays.eye.z), ray_of(rays, line, across),
        f4(1.0) / distance_inverse(key), rays.pixel, u4(shade),
    )  # fmt: skip
    red, green, blue = tone_bytes(light, lit.air.exposure, colour)
    return pack(red, green, blue)
